// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

#include "ram_slam/estimation/estimator.hpp"

namespace ram_slam {

/// The least that an estimator can be: it integrates the motion and ignores features. Tests add it
/// to the registry as another package would add its own.
class DummyEstimator : public Estimator {
public:
  void update(const FeatureList& features,
              const MotionStep& step,
              std::shared_ptr<const FieldOfView> /*view*/) override {
    if (features.stamp_ns < stamp_ns_) throw std::invalid_argument("features are too old");
    if (started()) pose_ = pose_ * step.motion;
    stamp_ns_ = features.stamp_ns;
    path_.push_back({stamp_ns_, pose_.pose});
  }
  std::int64_t stamp_ns() const override { return stamp_ns_; }
  PoseWithCovariance2 estimate() const override { return pose_; }
  Trajectory trajectory() const override { return path_; }
  LandmarkMap landmarks() const override { return {}; }
  bool isLost() const override { return is_lost_; }
  void setPose(const PoseWithCovariance2& map_from_base) override {
    pose_ = map_from_base;
    is_lost_ = false;
  }
  Pose2 followTrajectory(const Trajectory& corrected) override {
    if (corrected.empty()) throw std::invalid_argument("an empty trajectory");
    pose_.pose = corrected.back().pose;
    return {};
  }
  void forgetPose() override { is_lost_ = true; }
  void setMap(const LandmarkMap& /*map*/, const std::vector<PlacedView>& /*views*/) override {
    is_lost_ = true;
  }
  Checkpoint checkpoint() const override { return {{}, path_}; }
  void restore(const Checkpoint& checkpoint) override { path_ = checkpoint.path; }

private:
  std::int64_t stamp_ns_ = 0;
  PoseWithCovariance2 pose_;
  Trajectory path_;
  bool is_lost_ = false;
};

}  // namespace ram_slam
