// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "ram_slam/fast_slam/association.hpp"
#include "ram_slam/fast_slam/parameters.hpp"
#include "ram_slam/geometry/random.hpp"
#include "ram_slam/landmarks/assignment.hpp"
#include "ram_slam/landmarks/landmark.hpp"

namespace ram_slam {

/// The association of one reading with one belief about pose and landmarks, while it is being
/// worked out. A Belief has
///
///   const Eigen::Vector2d* find(LandmarkId) const;  // in the map; null if it does not hold it
///   Innovation innovation(LandmarkId, const PointMeasurement&) const;
///   void correct(const Innovation&, LandmarkId, const PointMeasurement&);
///   PoseWithCovariance2 pose() const;               // map_from_base
template <typename Belief>
class Associator {
public:
  /// Observations and parameters outlive this.
  Associator(const std::vector<Observation>& observations,
             Belief belief,
             const FastSlamParameters& parameters)
      : observations_(observations),
        parameters_(parameters),
        log_unknown_density_(std::log(parameters.unknown_feature_density)),
        belief_(std::move(belief)) {
    evidence_.associations.resize(observations.size());
  }

  /// Pairs what can be paired; false if nothing was left to pair.
  bool pass() {
    findPairs();
    for (const Choice& choice : bestAssignment(pairs_)) {
      if (choice.margin >= parameters_.ambiguity_margin) use(pairs_[choice.candidate]);
    }
    return !pairs_.empty();
  }

  /// Pairs what can be paired, several times, each from the pose corrected before; false if nothing
  /// was left to pair.
  bool passes() {
    bool left = true;
    for (int i = 0; i < parameters_.association_passes && left; ++i) left = pass();
    return left;
  }

  /// Samples one of the ways to pair the features left over, in proportion to their
  /// likelihood: of each feature for itself, or of several together.
  void sample(Random& random) {
    std::vector<std::size_t> open;
    std::size_t count = 1;
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      if (evidence_.associations[i].outcome == AssociationOutcome::kMatched) continue;
      const std::size_t alternatives = 1 + pairsOf(i).size();
      const bool full =
          !parameters_.draw_jointly ||
          count * alternatives > static_cast<std::size_t>(parameters_.maximum_hypotheses);
      if (full && !open.empty()) {
        sampleOne(open, random);
        open.clear();
        count = 1;
      }
      open.push_back(i);
      count *= alternatives;
    }
    if (!open.empty()) sampleOne(open, random);
  }

  Evidence finish() {
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      if (evidence_.associations[i].outcome != AssociationOutcome::kMatched && standsAlone(i)) {
        evidence_.associations[i].outcome = AssociationOutcome::kNew;
      }
    }
    evidence_.map_from_base = belief_.pose();
    return std::move(evidence_);
  }

private:
  /// One way to pair the features left over.
  struct Hypothesis {
    double score = 0.0;
    bool confirmed = true;  ///< pairs confirmed landmarks only
    Evidence evidence;
    Belief belief;
  };

  /// Samples one of the ways to pair these features.
  void sampleOne(const std::vector<std::size_t>& open, Random& random) {
    const double before = evidence_.log_likelihood_ratio;
    std::vector<Hypothesis> hypotheses;
    branch(open, 0, 0.0, true, hypotheses);
    double best = 0.0;
    for (const Hypothesis& hypothesis : hypotheses) best = std::max(best, hypothesis.score);
    double sum = 0.0;
    double confirmed_sum = 0.0;
    for (const Hypothesis& hypothesis : hypotheses) {
      const double likelihood = std::exp(hypothesis.score - best);
      sum += likelihood;
      if (hypothesis.confirmed) confirmed_sum += likelihood;
    }
    double place = random.uniform() * sum;
    std::size_t sampled = 0;
    for (; sampled + 1 < hypotheses.size(); ++sampled) {
      place -= std::exp(hypotheses[sampled].score - best);
      if (place < 0.0) break;
    }
    evidence_ = std::move(hypotheses[sampled].evidence);
    belief_ = std::move(hypotheses[sampled].belief);
    // What was sampled has happened with its probability already: the weight is what all have.
    // Alternatives with landmarks that are not confirmed weigh nothing.
    if (parameters_.draw_jointly)
      evidence_.log_likelihood_ratio = before + best + std::log(confirmed_sum);
  }

  /// All ways to pair open[depth] and those after it, each seen from the pose that the pairs before
  /// it have corrected.
  void branch(const std::vector<std::size_t>& open,
              std::size_t depth,
              double score,
              bool confirmed,
              std::vector<Hypothesis>& hypotheses) {
    if (depth == open.size()) {
      hypotheses.push_back({score, confirmed, evidence_, belief_});
      return;
    }
    for (const Candidate& pair : pairsOf(open[depth])) {
      const Evidence before = evidence_;
      const Belief belief_before = belief_;
      use(pair);
      branch(open, depth + 1, score + pair.score, confirmed && candidateOf(pair).confirmed,
             hypotheses);
      evidence_ = before;
      belief_ = belief_before;
    }
    branch(open, depth + 1, score, confirmed, hypotheses);
  }

  /// Pairs within the gate, of features and landmarks that are still free. The column is the
  /// landmark's identifier.
  void findPairs() {
    pairs_.clear();
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      if (evidence_.associations[i].outcome == AssociationOutcome::kMatched) continue;
      findPairs(i, pairs_);
    }
  }

  std::vector<Candidate> pairsOf(std::size_t i) const {
    std::vector<Candidate> pairs;
    findPairs(i, pairs);
    return pairs;
  }

  void findPairs(std::size_t i, std::vector<Candidate>& pairs) const {
    for (const AssociationCandidate& candidate : observations_[i].candidates) {
      if (belief_.find(candidate.id) == nullptr || evidence_.hasMatched(candidate.id)) continue;
      const Innovation found = belief_.innovation(candidate.id, observations_[i].measured);
      if (!(found.squaredMahalanobis() < parameters_.association_gate)) continue;
      pairs.push_back({i, candidate.id, score(found, candidate)});
    }
  }

  double score(const Innovation& found, const AssociationCandidate& candidate) const {
    return found.logLikelihood() + candidate.log_likelihood_ratio - log_unknown_density_;
  }

  const AssociationCandidate& candidateOf(const Candidate& pair) const {
    const std::vector<AssociationCandidate>& candidates = observations_[pair.row].candidates;
    return *std::find_if(candidates.begin(), candidates.end(),
                         [&pair](const AssociationCandidate& other) {
                           return other.id == static_cast<LandmarkId>(pair.column);
                         });
  }

  /// Matches the pair unless the corrections before it have moved it out of the gate.
  void use(const Candidate& pair) {
    const LandmarkId id = static_cast<LandmarkId>(pair.column);
    const AssociationCandidate& candidate = candidateOf(pair);
    const PointMeasurement& measured = observations_[pair.row].measured;
    const Innovation found = belief_.innovation(id, measured);
    const double squared_mahalanobis = found.squaredMahalanobis();
    if (!(squared_mahalanobis < parameters_.association_gate)) return;
    evidence_.associations[pair.row] = {AssociationOutcome::kMatched, id};
    if (!candidate.confirmed) return;
    evidence_.log_likelihood_ratio += score(found, candidate);
    evidence_.squared_mahalanobis += squared_mahalanobis;
    ++evidence_.correction_count;
    belief_.correct(found, id, measured);
  }

  /// Whether a feature is far enough from every landmark to be another thing. Near a landmark that
  /// is matched by another feature of the same reading, "far enough" means that the two can be
  /// distinguished.
  bool standsAlone(std::size_t i) const {
    const PointMeasurement& measured = observations_[i].measured;
    const Eigen::Vector2d place_m = belief_.pose().pose * measured.position_m;
    for (const AssociationCandidate& candidate : observations_[i].candidates) {
      const Eigen::Vector2d* landmark_m = belief_.find(candidate.id);
      if (landmark_m == nullptr) continue;
      const auto match =
          std::find_if(evidence_.associations.begin(), evidence_.associations.end(),
                       [&candidate](const Association& association) {
                         return association.outcome == AssociationOutcome::kMatched &&
                                association.id == candidate.id;
                       });
      if (match == evidence_.associations.end()) {
        if ((*landmark_m - place_m).norm() < parameters_.minimum_feature_separation) return false;
        const Innovation apart = belief_.innovation(candidate.id, measured);
        if (apart.squaredMahalanobis() < parameters_.creation_gate) return false;
        continue;
      }
      const auto j = static_cast<std::size_t>(match - evidence_.associations.begin());
      if (maybeSame(i, j)) return false;
    }
    return !isDuplicate(i);
  }

  /// Whether an earlier new feature of the same reading may be the same thing.
  bool isDuplicate(std::size_t i) const {
    for (std::size_t j = 0; j < i; ++j) {
      if (evidence_.associations[j].outcome != AssociationOutcome::kNew) continue;
      if (observations_[j].type == observations_[i].type && maybeSame(i, j)) return true;
    }
    return false;
  }

  /// Whether two features of one reading may show the same thing; the pose does not matter.
  bool maybeSame(std::size_t i, std::size_t j) const {
    const PointMeasurement& other = observations_[j].measured;
    const Landmark there{other.position_m, other.covariance_m2};
    return ram_slam::innovation(Pose2{}, there, observations_[i].measured).squaredMahalanobis() <
           parameters_.duplicate_gate;
  }

  const std::vector<Observation>& observations_;
  const FastSlamParameters& parameters_;
  double log_unknown_density_;
  Belief belief_;
  std::vector<Candidate> pairs_;
  Evidence evidence_;
};

}  // namespace ram_slam
