// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/landmarks/feature.hpp"

#include <cmath>

namespace ram_slam {

double orientationLogRatio(double difference_rad, double variance_rad2, double wrong_share) {
  if (!(variance_rad2 <= kUnobservedOrientation_rad2)) return 0.0;
  const double away_rad = wrapAngle(difference_rad);
  const double density =
      std::exp(-0.5 * away_rad * away_rad / variance_rad2) / std::sqrt(2.0 * M_PI * variance_rad2);
  return std::log((1.0 - wrong_share) * 2.0 * M_PI * density + wrong_share);
}

FeatureList deskew(FeatureList list, const Pose2& motion, std::int64_t interval_ns) {
  for (Feature& feature : list.features) {
    const Pose2 base_from_then = continued(motion, interval_ns, feature.delay_ns);
    const Eigen::Matrix2d rotation = base_from_then.rotation();
    feature.position_m = base_from_then * feature.position_m;
    feature.covariance_m2 = rotation * feature.covariance_m2 * rotation.transpose();
    feature.orientation_rad = wrapAngle(feature.orientation_rad + base_from_then.yaw_rad);
    feature.delay_ns = 0;
  }
  return list;
}

}  // namespace ram_slam
