// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/motion/gap_bridge.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

// Standard deviation of where an unobserved robot gets to, per second and at most.
constexpr double kDrift_mps = 0.3;
constexpr double kMostDrift_m = 3.0;
constexpr double kTurn_radps = 0.3;
constexpr double kMostTurn_rad = 1.0;

// Of a motion that other odometry tells: at rest, per metre, per radian.
constexpr double kTold_m = 0.02;
constexpr double kToldPerM = 0.05;
constexpr double kTold_rad = 0.01;
constexpr double kToldPerRad = 0.05;
constexpr std::int64_t kLateNs = 1'000'000'000;

/// Standing still, with the uncertainty of not knowing so.
PoseWithCovariance2 unobserved(double duration_s) {
  const double drift_m = std::min(kMostDrift_m, kDrift_mps * duration_s);
  const double turn_rad = std::min(kMostTurn_rad, kTurn_radps * duration_s);
  PoseWithCovariance2 motion;
  motion.covariance.diagonal() << drift_m * drift_m, drift_m * drift_m, turn_rad * turn_rad;
  return motion;
}

PoseWithCovariance2 told(const Pose2& moved) {
  const double deviation_m = kTold_m + kToldPerM * moved.translation().norm();
  const double deviation_rad = kTold_rad + kToldPerRad * std::abs(moved.yaw_rad);
  PoseWithCovariance2 motion;
  motion.pose = moved;
  motion.covariance.diagonal() << deviation_m * deviation_m, deviation_m * deviation_m,
      deviation_rad * deviation_rad;
  return motion;
}

}  // namespace

void GapBridge::interruptedUntil(std::int64_t stamp_ns, const std::optional<Pose2>& moved) {
  if (moved_ && !moved && stamp_ns < resume_ns_ + kLateNs) return;
  resume_ns_ = stamp_ns;
  moved_ = moved;
}

void GapBridge::forget() {
  resume_ns_ = 0;
  moved_.reset();
}

PoseWithCovariance2 GapBridge::bridge(std::int64_t from_ns) const {
  return moved_ ? told(*moved_) : unobserved(static_cast<double>(resume_ns_ - from_ns) * 1e-9);
}

PoseWithCovariance2 GapBridge::motion(std::int64_t from_ns, std::int64_t to_ns) const {
  try {
    return model_.motion(from_ns, to_ns);
  } catch (const std::out_of_range&) {
    if (resume_ns_ <= from_ns || resume_ns_ >= to_ns) throw;
    return bridge(from_ns) * model_.motion(resume_ns_, to_ns);
  }
}

std::vector<Pose2> GapBridge::sample(const std::vector<Pose2>& map_from_base,
                                     std::int64_t from_ns,
                                     std::int64_t to_ns,
                                     std::uint64_t seed) const {
  try {
    return model_.sample(map_from_base, from_ns, to_ns, seed);
  } catch (const std::out_of_range&) {
    if (resume_ns_ <= from_ns || resume_ns_ >= to_ns) throw;
    const PoseWithCovariance2 gap = bridge(from_ns);
    std::vector<Pose2> poses = map_from_base;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const Eigen::Vector3d noise = Random(seed, i).gaussian(gap.covariance);
      poses[i] = poses[i] * gap.pose * Pose2{noise.x(), noise.y(), noise.z()};
    }
    return model_.sample(poses, resume_ns_, to_ns, seed);
  }
}

}  // namespace ram_slam
