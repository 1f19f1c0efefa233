// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/smoothing_stage.hpp"

#include <exception>
#include <utility>

namespace ram_slam {
namespace {

ScanSynchroniserParameters synchroniserParameters() {
  ScanSynchroniserParameters parameters;
  parameters.odometry = ScanSynchroniserParameters::Odometry::kRequired;
  return parameters;
}

}  // namespace

SmoothingStage::SmoothingStage(const MapSmootherParameters& parameters,
                               const FeatureMatchers& matchers,
                               std::vector<PlacedScan> loaded)
    : parameters_(parameters),
      matchers_(matchers),
      scans_(synchroniserParameters()),
      loaded_(std::move(loaded)),
      smoother_(parameters, matchers) {
  restart();
}

void SmoothingStage::restart() {
  smoother_ = MapSmoother(parameters_, matchers_);
  smoother_.load(loaded_);
  gate_ = TrackingGate(!loaded_.empty());
  found_.reset();
  smoothed_from_odom_ = {};
}

void SmoothingStage::set(const Tracking& tracking) {
  if (tracking.is_lost) {
    smoother_.addPossibleJump(tracking.certain_until_ns, tracking.stamp_ns);
    return;
  }
  found_ = tracking;
  starts_session_ = gate_.isLost();
  gate_.set(tracking);
}

Pose2 SmoothingStage::aligned(const Pose2& odom_from_base) {
  if (found_) {
    const std::optional<Pose2> odom_from_found = scans_.odometryOf(found_->certain_until_ns);
    const Pose2 map_from_odom =
        found_->map_from_base * odom_from_found.value_or(odom_from_base).inverse();
    if (starts_session_) {
      smoothed_from_odom_ = map_from_odom;
      smoother_.startSession();
    } else {
      smoother_.addFoundPlace(found_->certain_until_ns,
                              map_from_odom * smoothed_from_odom_.inverse());
    }
    found_.reset();
  }
  return smoothed_from_odom_ * odom_from_base;
}

std::optional<SmoothingStep> SmoothingStage::next() {
  while (const auto ready = scans_.next()) {
    if (reset_count_ != scans_.resetCount()) {
      reset_count_ = scans_.resetCount();
      restart();
    }
    if (!gate_.admits(ready->scan.stamp_ns)) {
      drops().add(DropReason::kLost, ready->scan.stamp_ns, "scan");
      continue;
    }
    SmoothingStep step{ready->scan.stamp_ns};
    try {
      const bool is_key_scan =
          smoother_.addScan(ready->scan, ready->base_from_laser, aligned(*ready->odom_from_base));
      smoother_.optimizeIfDue();
      if (is_key_scan) step.map_from_base = smoother_.keyScans().back().map_from_base();
    } catch (const std::exception& error) {
      drops().add(DropReason::kInvalidScan, ready->scan.stamp_ns, error.what());
      continue;
    }
    if (smoother_.hasCorrection()) step.correction = smoother_.takeCorrection();
    return step;
  }
  return std::nullopt;
}

Trajectory SmoothingStage::optimize() {
  smoother_.optimize();
  return smoother_.takeCorrection();
}

std::optional<std::size_t> SmoothingStage::undoClosure() {
  for (std::size_t i = smoother_.closures().size(); i-- > 0;) {
    if (smoother_.closures()[i].state != ClosureState::kAccepted) continue;
    smoother_.refuseClosure(i);
    return i;
  }
  return std::nullopt;
}

}  // namespace ram_slam
