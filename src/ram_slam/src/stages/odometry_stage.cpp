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
      scans_.setStampOffset(0);
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
    step.estimate = odometry_.update(ready.scan, ready.base_from_laser, ready.odom_from_base);
  } else {
    step.estimate.stamp_ns = ready.scan.stamp_ns;
    step.estimate.odom_from_base.pose = ready.odom_from_base.value_or(Pose2{});
  }
  step.scan = {std::move(ready.scan), ready.base_from_laser};
  if (!refines_) return step;
  stamp_offset_.addScan({step.estimate.stamp_ns, step.estimate.odom_from_base.pose});
  scans_.setStampOffset(stamp_offset_.offset_ns());
  slip_count_ += step.estimate.wheels_slipped ? 1 : 0;
  return step;
}

}  // namespace ram_slam
