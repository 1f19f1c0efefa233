// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ram_slam/estimation/estimator.hpp"
#include "ram_slam/tracking/tracker.hpp"

namespace ram_slam {

/// A filter with recovery (Tracker) as an Estimator.
class TrackedEstimator : public Estimator {
public:
  /// \throws std::invalid_argument as Tracker
  TrackedEstimator(LandmarkFilterFactory make,
                   const RecoveryParameters& recovery,
                   FeatureMatchers matchers)
      : slam_(std::move(make), recovery, std::move(matchers)) {}

  void update(const FeatureList& features,
              const MotionStep& step,
              std::shared_ptr<const FieldOfView> view) override {
    slam_.update(features, step, std::move(view));
  }
  std::int64_t stamp_ns() const override { return slam_.stamp_ns(); }
  PoseWithCovariance2 estimate() const override { return slam_.estimate(); }
  std::vector<Pose2> hypotheses() const override;
  Trajectory trajectory() const override { return slam_.filter().trajectory(); }
  LandmarkMap landmarks() const override { return slam_.filter().landmarks(); }
  bool isLost() const override { return slam_.lost(); }
  StampedPose2 certainPose() const override { return slam_.certainPose(); }
  std::string state() const override;
  std::vector<std::pair<std::string, double>> health() const override;
  void setPose(const PoseWithCovariance2& map_from_base) override { slam_.setPose(map_from_base); }
  void movePose(const Pose2& new_from_old) override { slam_.movePose(new_from_old); }
  Pose2 followTrajectory(const Trajectory& corrected) override {
    return slam_.followTrajectory(corrected);
  }
  void forgetPose() override { slam_.forgetPose(); }
  void setMap(const LandmarkMap& map, const std::vector<PlacedView>& views) override {
    slam_.setMap(map, views);
  }
  void fixMap() override { slam_.fixMap(); }
  Checkpoint checkpoint() const override { return slam_.checkpoint(); }
  void restore(const Checkpoint& checkpoint) override { slam_.restore(checkpoint); }

  /// For tools that look into the filter.
  const Tracker& slam() const { return slam_; }

private:
  Tracker slam_;
};

}  // namespace ram_slam
