// SPDX-License-Identifier: BSD-3-Clause
#include "filter_score.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include <Eigen/LU>
#include <ram_slam/estimation/tracked_estimator.hpp>
#include <ram_slam/geometry/median.hpp>
#include <ram_slam/stages/smoothing_stage.hpp>
#include <ramscout_kinematics/kinematics.hpp>

#include "ramscout_bringup/evaluation.hpp"

namespace ramscout_bringup {
namespace {

using ram_slam::Pose2;
using ram_slam::Trajectory;

constexpr double kSamePlace_m = 0.2;  // a match farther from its landmark's place is false
// 2.5 and 97.5 percentiles of chi2 with 3 degrees of freedom.
constexpr double kLowestNees = 0.216;
constexpr double kHighestNees = 9.348;

struct Sighting {
  std::int64_t stamp_ns = 0;
  Eigen::Vector2d place_m;  ///< in the true frame of the start
};

Eigen::Vector2d medianPlace(const std::vector<Sighting>& sightings) {
  std::vector<double> xs, ys;
  for (const Sighting& sighting : sightings) {
    xs.push_back(sighting.place_m.x());
    ys.push_back(sighting.place_m.y());
  }
  return {ram_slam::median(std::move(xs)), ram_slam::median(std::move(ys))};
}

ram_slam::EstimatorFactory estimatorFactory(const SlamParameters& parameters, Judged judged) {
  ram_slam::RecoveryParameters recovery = parameters.recovery;
  if (judged == Judged::kFilter) recovery.enabled = false;
  return [=, filter = parameters.filter] {
    return std::make_unique<ram_slam::TrackedEstimator>(filter, recovery, featureMatchers());
  };
}

/// A run of the estimator over prepared steps, judged by the truth.
class Run {
public:
  Run(const SlamParameters& parameters,
      Judged judged,
      const std::vector<FilterStep>& steps,
      const Trajectory& truth)
      : parameters_(parameters),
        steps_(steps),
        truth_(truth),
        kinematics_(parameters.kinematics),
        stage_(estimatorFactory(parameters, judged), kinematics_, parameters.estimator_stage) {
    if (judged == Judged::kDeployed) smoothing_.emplace(parameters.map_smoother, featureMatchers());
  }

  FilterScore score() {
    for (const FilterStep& step : steps_) {
      take(step);
      if (&step == &steps_[steps_.size() / 2]) rememberLandmarks();
    }
    if (smoothing_ && !slam().lost()) stage_.follow(smoothing_->optimize());
    FilterScore score;
    const TruthComparison comparison = compareWithTruth(slam().filter().trajectory(), truth_);
    score.ate_m = comparison.position_m.rms;
    score.online_ate_m = compareWithTruth(online_, truth_).position_m.rms;
    score.times_lost = times_lost_;
    Trajectory odometry;
    for (const FilterStep& step : steps_)
      odometry.push_back({step.scan.scan.stamp_ns, step.odom_from_base});
    score.odometry_m = compareWithTruth(odometry, truth_).position_m.rms;
    score.yaw_rad = comparison.yaw_rad.rms;
    const double count = static_cast<double>(nees_.size());
    for (const double nees : nees_) {
      score.nees += nees / count;
      score.nees_in_band += (kLowestNees <= nees && nees <= kHighestNees ? 1.0 : 0.0) / count;
      score.nees_above_band += (nees > kHighestNees ? 1.0 : 0.0) / count;
    }
    score.online_m = std::sqrt(squares_m2_ / count);
    judgeLandmarks(score);
    return score;
  }

private:
  void take(const FilterStep& step) {
    const std::int64_t stamp_ns = step.scan.scan.stamp_ns;
    kinematics_.add({stamp_ns, step.odom_from_base});
    if (smoothing_) smooth(step);
    const bool was_lost = slam().lost();
    const auto motion = stage_.motionUntil(stamp_ns);
    if (!motion) throw std::out_of_range(stage_.missingMotion());
    stage_.update(
        step.features, *motion,
        std::make_shared<const ram_slam::LaserView>(step.scan.scan, step.scan.base_from_laser));
    times_lost_ += slam().lost() && !was_lost ? 1 : 0;
    stage_.followCorrection();
    const auto truth = ram_slam::poseAt(truth_, stamp_ns);
    if (!truth) return;
    if (!start_) start_ = *truth;
    const Pose2 wanted = start_->inverse() * *truth;
    const ram_slam::PoseWithCovariance2 estimate = slam().estimate();
    online_.push_back({stamp_ns, estimate.pose});
    const Eigen::Vector3d error(estimate.pose.x_m - wanted.x_m, estimate.pose.y_m - wanted.y_m,
                                ram_slam::wrapAngle(estimate.pose.yaw_rad - wanted.yaw_rad));
    squares_m2_ += error.head<2>().squaredNorm();
    const Eigen::Matrix3d covariance = estimate.covariance + 1e-10 * Eigen::Matrix3d::Identity();
    nees_.push_back(error.dot(covariance.inverse() * error));
    if (slam().lost()) return;
    for (std::size_t i = 0; i < step.features.features.size(); ++i) {
      const ram_slam::Association& association = slam().filter().associations()[i];
      if (association.outcome != ram_slam::AssociationOutcome::kMatched) continue;
      sightings_[association.id].push_back(
          {stamp_ns, wanted * step.features.features[i].position_m});
    }
  }

  void smooth(const FilterStep& step) {
    smoothing_->add(step.scan);
    smoothing_->addOdometry({step.scan.scan.stamp_ns, step.odom_from_base});
    while (auto smoothed = smoothing_->next())
      if (smoothed->correction) stage_.addCorrection(std::move(*smoothed->correction));
  }

  const ram_slam::Tracker& slam() const {
    return static_cast<const ram_slam::TrackedEstimator&>(stage_.estimator()).slam();
  }

  void rememberLandmarks() {
    for (const ram_slam::LandmarkEstimate& landmark : slam().filter().landmarks().landmarks) {
      if (landmark.existence_log_odds >= slam().filter().confirm_log_odds())
        known_at_half_.push_back(landmark.id);
    }
  }

  void judgeLandmarks(FilterScore& score) const {
    const std::int64_t half_ns = steps_[steps_.size() / 2].scan.scan.stamp_ns;
    std::size_t matches = 0;
    std::size_t wrong = 0;
    std::map<ram_slam::LandmarkId, Eigen::Vector2d> places;
    for (const auto& [id, sightings] : sightings_) {
      places[id] = medianPlace(sightings);
      for (const Sighting& sighting : sightings) {
        ++matches;
        wrong += (sighting.place_m - places[id]).norm() > kSamePlace_m ? 1 : 0;
      }
    }
    score.false_matches =
        static_cast<double>(wrong) / static_cast<double>(std::max<std::size_t>(matches, 1));
    for (const ram_slam::LandmarkEstimate& landmark : slam().filter().landmarks().landmarks) {
      if (landmark.existence_log_odds < slam().filter().confirm_log_odds()) continue;
      ++score.landmarks;
      const auto found = places.find(landmark.id);
      if (found != places.end() && isInFreeSpace(found->second)) ++score.in_free_space;
    }
    // Landmarks that were known at half time, and at whose place something was found later.
    for (const ram_slam::LandmarkId id : known_at_half_) {
      const auto known = sightings_.find(id);
      if (known == sightings_.end()) continue;
      const Eigen::Vector2d place_m = places[id];
      bool seen_later = false;
      for (const auto& [other, others] : sightings_) {
        for (const Sighting& sighting : others) {
          seen_later = seen_later || (sighting.stamp_ns > half_ns &&
                                      (sighting.place_m - place_m).norm() < 0.5 * kSamePlace_m);
        }
      }
      if (!seen_later) continue;
      ++score.due_again;
      if (known->second.back().stamp_ns > half_ns) ++score.found_again;
    }
  }

  /// Whether more beams from true poses go through the place than end there.
  bool isInFreeSpace(const Eigen::Vector2d& place_m) const {
    int empty = 0;
    int visible = 0;
    for (std::size_t i = 0; i < steps_.size(); i += 20) {
      const auto truth = ram_slam::poseAt(truth_, steps_[i].scan.scan.stamp_ns);
      if (!truth) continue;
      const ram_slam::LaserView view(steps_[i].scan.scan, steps_[i].scan.base_from_laser);
      const ram_slam::Sight sight = view.look((start_->inverse() * *truth).inverse() * place_m);
      empty += sight == ram_slam::Sight::kEmpty ? 1 : 0;
      visible += sight == ram_slam::Sight::kVisible ? 1 : 0;
    }
    return empty > visible;
  }

  const SlamParameters& parameters_;
  const std::vector<FilterStep>& steps_;
  const Trajectory& truth_;
  ramscout_kinematics::Kinematics kinematics_;
  ram_slam::EstimatorStage stage_;
  std::optional<ram_slam::SmoothingStage> smoothing_;
  int times_lost_ = 0;
  std::optional<Pose2> start_;
  Trajectory online_;
  double squares_m2_ = 0.0;
  std::vector<double> nees_;
  std::map<ram_slam::LandmarkId, std::vector<Sighting>> sightings_;
  std::vector<ram_slam::LandmarkId> known_at_half_;
};

}  // namespace

FilterScore scoreFilter(const SlamParameters& parameters,
                        Judged judged,
                        const std::vector<FilterStep>& steps,
                        const Trajectory& truth) {
  return Run(parameters, judged, steps, truth).score();
}

void print(const std::string& name, const FilterScore& s) {
  std::printf(
      "%-32s ATE %.4f m (odometry %.4f) yaw %.3f deg online %.4f m, not aligned %.4f m | NEES mean "
      "%.1f in band %.1f %% above %.1f %% | false %.2f %% | landmarks %zu found again %zu of %zu "
      "in "
      "free space %zu | lost %d\n",
      name.c_str(), s.ate_m, s.odometry_m, s.yaw_rad * 180.0 / M_PI, s.online_ate_m, s.online_m,
      s.nees, 100.0 * s.nees_in_band, 100.0 * s.nees_above_band, 100.0 * s.false_matches,
      s.landmarks, s.found_again, s.due_again, s.in_free_space, s.times_lost);
  std::fflush(stdout);
}

}  // namespace ramscout_bringup
