// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/feature_pairing.hpp"

#include <algorithm>
#include <cstddef>

#include "ram_slam/landmarks/assignment.hpp"
#include "ram_slam/landmarks/landmark.hpp"

namespace ram_slam {

double FeaturePairing::score(const LandmarkProblem& problem,
                             const FeatureReading& reading,
                             const Eigen::Vector2d& landmark_m) const {
  const Pose2 map_from_base = problem.poseOf(reading);
  const double noise_m2 =
      reading.measured.covariance_m2.trace() + 2.0 * deviation_m_ * deviation_m_;
  const double distance_m2 =
      (map_from_base * reading.measured.position_m - landmark_m).squaredNorm();
  if (distance_m2 > parameters_.association_gate * noise_m2) return 0.0;
  const Landmark there{landmark_m, deviation_m_ * deviation_m_ * Eigen::Matrix2d::Identity()};
  const double chi2 = innovation(map_from_base, there, reading.measured).squaredMahalanobis();
  return 0.5 * std::max(0.0, parameters_.association_gate - chi2);
}

void FeaturePairing::pair(LandmarkProblem& problem) const {
  const std::vector<FeatureReading>& readings = problem.readings;
  for (std::size_t first = 0; first < readings.size();) {
    std::size_t end = first;
    while (end < readings.size() && readings[end].pose == readings[first].pose) ++end;
    pairList(problem, first, end);
    first = end;
  }
}

void FeaturePairing::pairList(LandmarkProblem& problem, std::size_t first, std::size_t end) const {
  std::vector<FeatureReading>& readings = problem.readings;
  const std::vector<LandmarkEstimate>& landmarks = problem.landmarks;
  std::vector<Candidate> candidates;
  for (std::size_t i = first; i < end; ++i) {
    FeatureReading& reading = readings[i];
    reading.landmark = FeatureReading::kNone;
    reading.score = reading.second = 0.0;
    for (std::size_t j = 0; j < landmarks.size(); ++j) {
      if (landmarks[j].type != reading.feature->type) continue;
      const double score = this->score(problem, reading, landmarks[j].mean_m);
      if (score > 0.0) candidates.push_back({i, j, score});
    }
  }
  std::vector<std::size_t> used;
  for (const Choice& choice : bestAssignment(candidates)) {
    const Candidate& pair = candidates[choice.candidate];
    readings[pair.row].landmark = pair.column;
    readings[pair.row].score = pair.score;
    used.push_back(pair.column);
  }
  for (const Candidate& other : candidates) {
    if (std::find(used.begin(), used.end(), other.column) != used.end()) continue;
    readings[other.row].second = std::max(readings[other.row].second, other.score);
  }
}

std::vector<double> FeaturePairing::evidence(const LandmarkProblem& problem) const {
  std::vector<double> sums(problem.landmarks.size(), 0.0);
  for (const FeatureReading& reading : problem.readings) {
    if (!reading.isPaired()) continue;
    sums[reading.landmark] +=
        parameters_.reading_share * std::max(0.0, reading.score - reading.second);
  }
  return sums;
}

void FeaturePairing::revise(LandmarkProblem& problem) const {
  pair(problem);
  removeUnexplained(problem);
  addUnpaired(problem);
}

void FeaturePairing::removeUnexplained(LandmarkProblem& problem) const {
  while (!problem.landmarks.empty()) {
    const std::vector<double> evidence = this->evidence(problem);
    const auto least = std::min_element(evidence.begin(), evidence.end());
    if (*least >= parameters_.least_evidence) return;
    problem.landmarks.erase(problem.landmarks.begin() + (least - evidence.begin()));
    pair(problem);
  }
}

void FeaturePairing::addUnpaired(LandmarkProblem& problem) const {
  while (true) {
    std::vector<const FeatureReading*> unpaired;
    for (const FeatureReading& reading : problem.readings) {
      if (!reading.isPaired()) unpaired.push_back(&reading);
    }
    const FeatureReading* best = nullptr;
    double most = parameters_.least_evidence;
    for (const FeatureReading* reading : unpaired) {
      const double evidence = evidenceAt(problem, *reading, unpaired);
      if (evidence <= most) continue;
      most = evidence;
      best = reading;
    }
    if (best == nullptr) return;
    LandmarkEstimate landmark;
    landmark.id = problem.next_id++;
    landmark.type = best->feature->type;
    landmark.classifier = best->feature->classifier;
    landmark.mean_m = problem.poseOf(*best) * best->measured.position_m;
    landmark.placed_ns = problem.stamps_ns[best->pose];
    problem.landmarks.push_back(landmark);
    pair(problem);
  }
}

double FeaturePairing::evidenceAt(const LandmarkProblem& problem,
                                  const FeatureReading& reading,
                                  const std::vector<const FeatureReading*>& unpaired) const {
  const Eigen::Vector2d place_m = problem.poseOf(reading) * reading.measured.position_m;
  double sum = 0.0;
  for (const FeatureReading* other : unpaired) {
    if (other->feature->type == reading.feature->type)
      sum += parameters_.reading_share * score(problem, *other, place_m);
  }
  return sum;
}

}  // namespace ram_slam
