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
                               const FeatureMatchers& matchers)
    : parameters_(parameters),
      matchers_(matchers),
      scans_(synchroniserParameters()),
      smoother_(parameters, matchers) {}

std::optional<SmoothingStep> SmoothingStage::next() {
  while (const auto ready = scans_.next()) {
    if (reset_count_ != scans_.resetCount()) {
      reset_count_ = scans_.resetCount();
      smoother_ = MapSmoother(parameters_, matchers_);
    }
    try {
      smoother_.addScan(ready->scan, ready->base_from_laser, *ready->odom_from_base);
      smoother_.optimizeIfDue();
    } catch (const std::exception& error) {
      drops().add(DropReason::kInvalidScan, ready->scan.stamp_ns, error.what());
      continue;
    }
    SmoothingStep step{ready->scan.stamp_ns, std::nullopt};
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
