// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/map_smoother.hpp"

#include "ram_slam/geometry/motion_gate.hpp"

namespace ram_slam {
namespace {

MapSmootherParameters validated(const MapSmootherParameters& parameters) {
  parameters.validate();
  return parameters;
}

}  // namespace

MapSmoother::MapSmoother(const MapSmootherParameters& parameters, const FeatureMatchers& matchers)
    : parameters_(validated(parameters)),
      key_scans_(parameters.key_scans,
                 parameters.surfaces,
                 parameters.matcher,
                 parameters.refinement.min_inlier_ratio,
                 parameters.refinement.near_views),
      loops_(parameters.loops, parameters.matcher, matchers),
      optimizer_(parameters.graph, parameters.refinement, parameters.matcher) {}

bool MapSmoother::addScan(const LaserScan& scan,
                          const Pose2& base_from_laser,
                          const Pose2& odom_from_base) {
  if (!key_scans_.add(scan, base_from_laser, odom_from_base)) return false;
  loops_.useFeatures(key_scans_.keys());
  loops_.searchIfDue(key_scans_.keys(), closureHandler());
  return true;
}

void MapSmoother::addFeatures(const FeatureList& list) {
  loops_.addFeatures(list);
  loops_.useFeatures(key_scans_.keys());
}

LoopCloser::ClosureHandler MapSmoother::closureHandler() {
  return [this](std::size_t key, const Pose2& correction) { onClosure(key, correction); };
}

void MapSmoother::onClosure(std::size_t key, const Pose2& correction) {
  if (const std::optional<std::size_t>& jump = loops_.closures().back().jump) {
    key_scans_.setJump(*jump, key, key_scans_.keys()[key].map_from_laser * correction);
    has_correction_ = true;
  }
  const MotionGate solve_beyond{parameters_.solve_distance_m, parameters_.solve_angle_rad};
  if (!solve_beyond.isExceededBy(correction)) return;
  const Pose2 before = key_scans_.keys()[key].map_from_laser;
  optimizer_.solve(key_scans_, loops_);
  const Pose2 moved = before.inverse() * key_scans_.keys()[key].map_from_laser;
  const MotionGate negligible{parameters_.correction_distance_m, parameters_.correction_angle_rad};
  if (negligible.isExceededBy(moved)) has_correction_ = true;
}

void MapSmoother::optimize() {
  if (key_scans_.empty()) return;
  optimizer_.solve(key_scans_, loops_);
  sweepLoops();
  optimizer_.refine(key_scans_);
  has_correction_ = true;
  optimized_closures_ = closures().size();
  optimized_ns_ = key_scans_.newestStampNs();
}

void MapSmoother::sweepLoops() {
  for (int sweep = 0; sweep < parameters_.max_sweeps; ++sweep) {
    if (!loops_.sweep(key_scans_.keys(), closureHandler())) return;
    optimizer_.solve(key_scans_, loops_);
  }
}

void MapSmoother::optimizeIfDue() {
  if (parameters_.optimize_period_s == 0.0) return;
  const auto period_ns = static_cast<std::int64_t>(parameters_.optimize_period_s * 1e9);
  if (key_scans_.empty() || key_scans_.newestStampNs() < optimized_ns_ + period_ns) return;
  // Not at the first closure of a place: those that follow it make the solution better.
  optimized_ns_ = key_scans_.newestStampNs();
  if (closures().size() != optimized_closures_) optimize();
}

std::vector<StampedPose2> MapSmoother::takeCorrection() {
  has_correction_ = false;
  return trajectory();
}

}  // namespace ram_slam
