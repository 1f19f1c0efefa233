// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ram_slam/fast_slam/landmark_filter.hpp"
#include "ram_slam/fast_slam/landmark_records.hpp"
#include "ram_slam/fast_slam/parameters.hpp"
#include "ram_slam/fast_slam/shared_error.hpp"

namespace ram_slam {

/// Settings of UkfLocaliser: config/ukf_localiser.yaml.
struct UkfLocaliserParameters {
  FastSlamParameters common;  ///< of which FastSlamParameters::landmarkTable() counts

  static const ram_parameters::ParameterTable<UkfLocaliserParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// Estimates the pose alone, in a map of landmarks that is given, by an unscented Kalman filter:
/// the motion model moves each sigma point. The map stays as it is. docs/ukf_localiser.md
class UkfLocaliser : public LandmarkFilter {
public:
  /// \throws std::invalid_argument as UkfLocaliserParameters::validate()
  explicit UkfLocaliser(const UkfLocaliserParameters& parameters, FeatureMatchers matchers = {});
  std::unique_ptr<LandmarkFilter> clone() const override {
    return std::make_unique<UkfLocaliser>(*this);
  }

  /// \throws also std::invalid_argument if there is no map
  void update(const FeatureList& list,
              const MotionStep& step,
              const FieldOfView* view = nullptr) override;
  void check(const FeatureList& list) const override { requireGood(list, stamp_ns_); }

  std::int64_t stamp_ns() const override { return stamp_ns_; }
  const PoseWithCovariance2& estimate() const override { return estimate_; }
  Trajectory trajectory() const override { return best().path.poses(); }
  LandmarkMap landmarks() const override;
  const Particle& best() const override { return hypotheses_.front(); }
  const LandmarkRegistry& registry() const override { return registry_; }
  const std::vector<Association>& associations() const override { return associations_; }
  double confirm_log_odds() const override { return parameters_.common.confirm_log_odds; }
  /// The sigma points of the pose.
  std::vector<Pose2> hypotheses() const override;
  std::vector<std::pair<std::string, double>> health() const override;

  void setPose(const PoseWithCovariance2& map_from_base) override;
  void setPose(const PoseWithCovariance2& map_from_base, std::int64_t stamp_ns) override;
  void movePose(const Pose2& new_from_old) override;
  void setMap(const LandmarkMap& map, const Trajectory& path) override;
  void fixMap() override {}
  bool isMapFixed() const override { return true; }
  /// \throws std::invalid_argument always: the map is given
  Pose2 followTrajectory(const Trajectory& corrected) override;

private:
  Particle& hypothesis() { return hypotheses_.front(); }
  /// The pose at the step's end, before the features are used.
  PoseWithCovariance2 predicted(const MotionStep& step) const;
  /// The pose after the matched features.
  PoseWithCovariance2 corrected(const std::vector<Observation>& observations,
                                const std::vector<Association>& associations) const;

  UkfLocaliserParameters parameters_;
  FeatureMatchers matchers_;
  LandmarkMap map_;
  std::map<std::pair<LandmarkId, LandmarkId>, Eigen::Matrix2d> between_m2_;  ///< first < second
  LandmarkRegistry registry_;
  /// One: the pose, and the map, for what works with particles.
  std::vector<Particle> hypotheses_ = std::vector<Particle>(1);
  PoseWithCovariance2 pose_;  ///< with the features up to the last update
  PoseWithCovariance2 estimate_;
  SharedError shared_error_;
  MatchQuality quality_;
  std::vector<Association> associations_;
  std::int64_t stamp_ns_ = 0;
  std::int64_t updated_ns_ = 0;  ///< when the features corrected pose_ last
  Pose2 since_update_;           ///< the motion since then
};

/// For the registry of estimators.
FilterEntry ukfLocaliserEntry();

}  // namespace ram_slam
