// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/motion/gap_bridge.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {

const ram_parameters::ParameterTable<GapBridgeParameters>& GapBridgeParameters::table() {
  using namespace ram_parameters;
  using P = GapBridgeParameters;
  static const auto table =
      ParameterTable<P>()
          .add("drift_mps", &P::drift_mps, "m/s", atLeast(0.0),
               "Standard deviation per axis of where an unobserved robot gets to, per second.")
          .add("maximum_drift_m", &P::maximum_drift_m, "m", atLeast(0.0), "The same at most.")
          .add("turn_radps", &P::turn_radps, "rad/s", atLeast(0.0),
               "Standard deviation of the yaw of an unobserved robot, per second.")
          .add("maximum_turn_rad", &P::maximum_turn_rad, "rad", atLeast(0.0), "The same at most.")
          .add("rest_sigma_m", &P::rest_sigma_m, "m", atLeast(0.0),
               "Standard deviation per axis of a motion that another source states, at rest.")
          .add("sigma_m_per_m", &P::sigma_m_per_m, "m/m", atLeast(0.0), "And for each metre.")
          .add("rest_sigma_rad", &P::rest_sigma_rad, "rad", atLeast(0.0),
               "Standard deviation of the yaw of such a motion, at rest.")
          .add("sigma_rad_per_rad", &P::sigma_rad_per_rad, "rad/rad", atLeast(0.0),
               "And for each radian.")
          .add("late_s", &P::late_s, "s", within(0.0, 1000.0),
               "So long a source that stated a motion is waited for before the motion counts as "
               "unobserved again.");
  return table;
}

PoseWithCovariance2 GapBridge::unobserved(double duration_s) const {
  const double drift_m = std::min(parameters_.maximum_drift_m, parameters_.drift_mps * duration_s);
  const double turn_rad =
      std::min(parameters_.maximum_turn_rad, parameters_.turn_radps * duration_s);
  PoseWithCovariance2 motion;
  motion.covariance.diagonal() << drift_m * drift_m, drift_m * drift_m, turn_rad * turn_rad;
  return motion;
}

PoseWithCovariance2 GapBridge::withNoise(const Pose2& moved) const {
  const double deviation_m =
      parameters_.rest_sigma_m + parameters_.sigma_m_per_m * moved.translation().norm();
  const double deviation_rad =
      parameters_.rest_sigma_rad + parameters_.sigma_rad_per_rad * std::abs(moved.yaw_rad);
  PoseWithCovariance2 motion;
  motion.pose = moved;
  motion.covariance.diagonal() << deviation_m * deviation_m, deviation_m * deviation_m,
      deviation_rad * deviation_rad;
  return motion;
}

void GapBridge::interruptedUntil(std::int64_t stamp_ns, const std::optional<Pose2>& moved) {
  const auto late_ns = static_cast<std::int64_t>(parameters_.late_s * 1e9);
  if (moved_ && !moved && stamp_ns < resume_ns_ + late_ns) return;
  resume_ns_ = stamp_ns;
  moved_ = moved;
}

void GapBridge::forget() {
  resume_ns_ = 0;
  moved_.reset();
}

PoseWithCovariance2 GapBridge::bridge(std::int64_t from_ns) const {
  return moved_ ? withNoise(*moved_) : unobserved(static_cast<double>(resume_ns_ - from_ns) * 1e-9);
}

PoseWithCovariance2 GapBridge::motion(std::int64_t from_ns, std::int64_t to_ns) const {
  try {
    return model_.motion(from_ns, to_ns);
  } catch (const std::out_of_range&) {
    if (resume_ns_ <= from_ns || resume_ns_ >= to_ns) throw;
    return bridge(from_ns) * model_.motion(resume_ns_, to_ns);
  }
}

std::vector<Pose2> GapBridge::predictEach(const std::vector<Pose2>& map_from_base,
                                          std::int64_t from_ns,
                                          std::int64_t to_ns) const {
  try {
    return model_.predictEach(map_from_base, from_ns, to_ns);
  } catch (const std::out_of_range&) {
    return MotionModel::predictEach(map_from_base, from_ns, to_ns);
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
