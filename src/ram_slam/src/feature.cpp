// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/feature.hpp"

namespace ram_slam {
namespace {

constexpr std::int64_t kLongestIntervalNs = 1'000'000'000;

}  // namespace

FeatureList seenAtOnce(FeatureList list, const Pose2& motion, std::int64_t interval_ns) {
  if (interval_ns <= 0 || interval_ns > kLongestIntervalNs) return list;
  for (Feature& feature : list.features) {
    if (feature.delay_ns == 0) continue;
    const double share = static_cast<double>(feature.delay_ns) / static_cast<double>(interval_ns);
    const Pose2 base_from_then = exponential(share * logarithm(motion));
    const Eigen::Matrix2d rotation = base_from_then.rotation();
    feature.position_m = base_from_then * feature.position_m;
    feature.covariance_m2 = rotation * feature.covariance_m2 * rotation.transpose();
    feature.orientation_rad = wrapAngle(feature.orientation_rad + base_from_then.yaw_rad);
    feature.delay_ns = 0;
  }
  return list;
}

}  // namespace ram_slam
