// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/estimator_stage.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/stages/clock_guard.hpp"

namespace ram_slam {

using ram_parameters::atLeast;
using ram_parameters::positive;

const ram_parameters::ParameterTable<EstimatorStageParameters>& EstimatorStageParameters::table() {
  using P = EstimatorStageParameters;
  static const auto table =
      ram_parameters::ParameterTable<P>()
          .expert(
              "Which readings the estimator takes in: all by default; run_bag leaves out those "
              "between which the robot hardly moves")
          .add("minimum_distance_m", &P::minimum_distance_m, "m", atLeast(0.0),
               "A reading is taken in after so much motion,")
          .add("minimum_angle_rad", &P::minimum_angle_rad, "rad", atLeast(0.0),
               "or so much turning,")
          .add("longest_pause_s", &P::longest_pause_s, "s", positive(),
               "or so much time since the one before.")
          .expert("Poses that map_smoother measured in its map: the estimator is moved there")
          .include(&P::map_pose,
                   motionGateTable("One that is farther from the estimator's is not believed."),
                   "map_pose_")
          .expert("Motion while the odometry is interrupted")
          .add("lost_after_s", &P::lost_after_s, "s", positive(),
               "A robot is lost when readings come for so long without a known motion; pauses of "
               "the readings themselves, beyond longest_pause_s, do not count.")
          .section("gap_bridge", &P::gap_bridge, GapBridgeParameters::table());
  return table;
}

EstimatorStage::EstimatorStage(EstimatorFactory make,
                               const MotionModel& model,
                               const EstimatorStageParameters& parameters)
    : make_(std::move(make)),
      model_(model),
      parameters_((parameters.validate(), parameters)),
      motion_(model, parameters_.gap_bridge),
      estimator_(make_()) {}

void EstimatorStage::reset() {
  estimator_ = make_();
  motion_.forget();
  bridges_ = false;
  bridged_ns_ = 0;
  without_motion_s_ = 0.0;
  correction_.reset();
  map_poses_.clear();
  map_from_smoothed_.reset();
  followed_ns_ = 0;
  reached_ns_ = 0;
  ++reset_count_;
  stated_lost_.reset();
}

std::optional<Tracking> EstimatorStage::takeTrackingChange() {
  const bool is_lost = estimator_->isLost();
  if (stated_lost_ == is_lost) return std::nullopt;
  stated_lost_ = is_lost;
  const StampedPose2 certain = estimator_->certainPose();
  return Tracking{is_lost, estimator_->stamp_ns(), certain.stamp_ns, certain.pose};
}

std::optional<MotionStep> EstimatorStage::motionUntil(std::int64_t stamp_ns) {
  if (ClockGuard::isSetBack(estimator_->stamp_ns(), stamp_ns)) reset();
  try {
    // The first reading does not need a motion, but the second one needs it from here on.
    if (!estimator_->started()) model_.motion(stamp_ns, stamp_ns);
    const bool is_later = estimator_->started() && stamp_ns > estimator_->stamp_ns();
    const MotionStep step =
        motionStep(motion_, is_later ? estimator_->stamp_ns() : stamp_ns, stamp_ns);
    reached_ns_ = stamp_ns;
    return step;
  } catch (const std::out_of_range& error) {
    missing_motion_ = error.what();
    return std::nullopt;
  }
}

void EstimatorStage::bridgeGap(std::int64_t stamp_ns, const std::optional<Pose2>& moved) {
  drops_.add(DropReason::kNoMotion, stamp_ns, missing_motion_);
  motion_.interruptedUntil(stamp_ns, moved);
  bridges_ = true;
  const std::int64_t before_ns = std::max(bridged_ns_, estimator_->stamp_ns());
  const double since_s = 1e-9 * static_cast<double>(stamp_ns - before_ns);
  bridged_ns_ = stamp_ns;
  if (moved || !estimator_->started()) return;
  if (since_s <= parameters_.longest_pause_s) without_motion_s_ += since_s;
  if (without_motion_s_ > parameters_.lost_after_s && !estimator_->isLost())
    estimator_->forgetPose();
}

bool EstimatorStage::isDue(const MotionStep& step) const {
  if (!estimator_->started() || bridges_) return true;
  const double pause_s = 1e-9 * static_cast<double>(step.to_ns - estimator_->stamp_ns());
  return pause_s >= parameters_.longest_pause_s ||
         MotionGate{parameters_.minimum_distance_m, parameters_.minimum_angle_rad}.isReachedBy(
             step.motion.pose);
}

bool EstimatorStage::update(const FeatureList& features,
                            const MotionStep& step,
                            std::shared_ptr<const FieldOfView> view) {
  try {
    estimator_->update(features, step, std::move(view));
  } catch (const std::out_of_range& error) {
    drops_.add(DropReason::kNoMotion, step.to_ns, error.what());
    return false;
  } catch (const std::exception& error) {
    const bool is_late = step.to_ns < estimator_->stamp_ns();
    drops_.add(is_late ? DropReason::kNotLater : DropReason::kInvalidFeatures, step.to_ns,
               error.what());
    return false;
  }
  motion_.forget();
  bridges_ = false;
  without_motion_s_ = 0.0;
  return true;
}

Pose2 EstimatorStage::poseAt(const MotionStep& step) const {
  const Pose2 pose = estimator_->estimate().pose;
  return step.to_ns <= estimator_->stamp_ns() ? pose : pose * step.motion.pose;
}

std::optional<Trajectory> EstimatorStage::followCorrection() {
  if (!correction_ || !estimator_->started() || estimator_->isLost()) return std::nullopt;
  if (!correction_->empty() && correction_->back().stamp_ns > reached_ns_) return std::nullopt;
  Trajectory smoothed = std::move(*correction_);
  correction_.reset();
  const std::int64_t stamp_ns = smoothed.empty() ? reached_ns_ : smoothed.back().stamp_ns;
  try {
    return follow(std::move(smoothed));
  } catch (const std::exception& error) {
    drops_.add(DropReason::kInvalidTrajectory, stamp_ns, error.what());
    return std::nullopt;
  }
}

Trajectory EstimatorStage::follow(Trajectory smoothed) {
  map_from_smoothed_ = estimator_->followTrajectory(smoothed);
  followed_ns_ = smoothed.back().stamp_ns;
  for (StampedPose2& stamped : smoothed) stamped.pose = *map_from_smoothed_ * stamped.pose;
  return smoothed;
}

void EstimatorStage::addMapPose(const StampedPose2& smoothed_from_base) {
  constexpr std::size_t kMost = 100;  // more than come while one reading waits for its motion
  if (map_poses_.size() == kMost) {
    drops_.add(DropReason::kQueueFull, map_poses_.front().stamp_ns, "map poses");
    map_poses_.pop_front();
  }
  map_poses_.push_back(smoothed_from_base);
}

void EstimatorStage::followMapPoses() {
  const std::deque<StampedPose2> kept = std::exchange(map_poses_, {});
  for (const StampedPose2& pose : kept) {
    if (pose.stamp_ns <= followed_ns_) continue;  // measured in the map before that
    if (pose.stamp_ns > reached_ns_) {
      map_poses_.push_back(pose);
    } else if (estimator_->started() && !estimator_->isLost()) {
      followMapPose(pose);
    }
  }
}

void EstimatorStage::followMapPose(const StampedPose2& smoothed_from_base) {
  const std::int64_t stamp_ns = smoothed_from_base.stamp_ns;
  const Pose2 now = estimator_->estimate().pose;
  try {
    const std::int64_t now_ns = estimator_->stamp_ns();
    const Pose2 moved = stamp_ns <= now_ns ? model_.motion(stamp_ns, now_ns).pose
                                           : model_.motion(now_ns, stamp_ns).pose.inverse();
    const Pose2 smoothed = smoothed_from_base.pose * moved;
    if (!map_from_smoothed_) map_from_smoothed_ = now * smoothed.inverse();
    const Pose2 measured = *map_from_smoothed_ * smoothed;
    if (parameters_.map_pose.isExceededBy(now.inverse() * measured)) {
      drops_.add(DropReason::kMapPoseAway, stamp_ns);
    } else {
      estimator_->movePose(measured * now.inverse());
    }
  } catch (const std::exception& error) {
    drops_.add(DropReason::kNoMotion, stamp_ns, error.what());
  }
}

}  // namespace ram_slam
