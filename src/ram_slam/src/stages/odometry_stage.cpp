// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/odometry_stage.hpp"

#include <exception>
#include <utility>

namespace ram_slam {
namespace {

ScanSynchroniserParameters synchroniserParameters(const LaserOdometryParameters& parameters) {
  ScanSynchroniserParameters result;
  result.odometry = parameters.use_wheels ? ScanSynchroniserParameters::Odometry::kOptional
                                          : ScanSynchroniserParameters::Odometry::kNone;
  return result;
}

}  // namespace

OdometryStage::OdometryStage(const LaserOdometryParameters& parameters, bool refines)
    : parameters_(parameters),
      refines_(refines),
      scans_(synchroniserParameters(parameters)),
      odometry_(parameters),
      stamp_offset_(parameters.max_stamp_offset_s, parameters.stamp_offset) {}

bool OdometryStage::addWheels(const StampedPose2& odom_from_base) {
  if (!scans_.add(odom_from_base)) return false;
  stamp_offset_.addWheels(odom_from_base);
  scans_.setStampOffset(stamp_offset_.offset_ns());
  return true;
}

std::optional<OdometryStep> OdometryStage::next() {
  while (auto ready = scans_.next()) {
    const std::int64_t stamp_ns = ready->scan.stamp_ns;
    if (reset_count_ != scans_.resetCount()) {
      reset_count_ = scans_.resetCount();
      odometry_ = LaserOdometry(parameters_);
      stamp_offset_ = StampOffset(parameters_.max_stamp_offset_s, parameters_.stamp_offset);
      mirror_check_ = {};
      scans_.setStampOffset(0);
      last_offset_ns_ = 0;
      last_ = {};
    }
    try {
      return refine(std::move(*ready));
    } catch (const std::exception& error) {
      drops().add(DropReason::kInvalidScan, stamp_ns, error.what());
    }
  }
  return std::nullopt;
}

OdometryStep OdometryStage::refine(SynchronisedScan ready) {
  OdometryStep step;
  if (refines_) {
    followStampOffset();
    ready.scan = corrected(std::move(ready.scan), odometry_.lidarCalibration().addedMirrorTurn_s());
    if (ready.odom_from_base) mirror_check_.add(ready.scan, ready.odom_from_base->yaw_rad);
    step.estimate = odometry_.update(ready.scan, ready.base_from_laser, ready.odom_from_base);
    step.between = posesBetween(step.estimate, ready.odom_from_base);
  } else {
    step.estimate.stamp_ns = ready.scan.stamp_ns;
    step.estimate.odom_from_base.pose = ready.odom_from_base.value_or(Pose2{});
  }
  step.scan = {std::move(ready.scan), ready.base_from_laser};
  if (!refines_) return step;
  last_ = {step.estimate.stamp_ns, step.estimate.odom_from_base.pose};
  learnStampOffset(step.estimate);
  slip_count_ += step.estimate.wheels_slipped ? 1 : 0;
  return step;
}

void OdometryStage::followStampOffset() {
  if (scans_.stampOffset_ns() == last_offset_ns_) return;
  last_offset_ns_ = scans_.stampOffset_ns();
  odometry_.replaceWheels(scans_.odometryOf(last_.stamp_ns));
}

Trajectory OdometryStage::posesBetween(const LaserOdometryEstimate& estimate,
                                       const std::optional<Pose2>& odom_from_base) const {
  const auto step_ns = static_cast<std::int64_t>(1e9 * parameters_.between_scans_s);
  const std::int64_t interval_ns = estimate.stamp_ns - last_.stamp_ns;
  if (last_.stamp_ns == 0 || interval_ns <= 2 * step_ns || !odom_from_base) return {};
  const std::optional<Pose2> wheels_before = scans_.odometryOf(last_.stamp_ns);
  if (!wheels_before) return {};
  const Pose2 by_wheels = last_.pose * wheels_before->inverse() * *odom_from_base;
  const Pose2 correction = by_wheels.inverse() * estimate.odom_from_base.pose;
  Trajectory poses;
  for (const StampedPose2& wheels : scans_.odometryBetween(last_.stamp_ns, estimate.stamp_ns)) {
    const std::int64_t before_ns = poses.empty() ? last_.stamp_ns : poses.back().stamp_ns;
    if (wheels.stamp_ns < before_ns + step_ns) continue;
    const auto since_ns = static_cast<double>(wheels.stamp_ns - last_.stamp_ns);
    const Pose2 share = interpolate({}, correction, since_ns / static_cast<double>(interval_ns));
    poses.push_back({wheels.stamp_ns, last_.pose * wheels_before->inverse() * wheels.pose * share});
  }
  return poses;
}

void OdometryStage::learnStampOffset(const LaserOdometryEstimate& estimate) {
  if (estimate.jumped || estimate.searched ||
      estimate.scan_deviation_rad > parameters_.stamp_offset.max_scan_deviation_rad) {
    stamp_offset_.interrupt();
  } else {
    stamp_offset_.addScan({estimate.stamp_ns, estimate.odom_from_base.pose});
  }
  scans_.setStampOffset(stamp_offset_.offset_ns());
}

}  // namespace ram_slam
