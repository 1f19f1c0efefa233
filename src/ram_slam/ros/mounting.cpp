// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ros/mounting.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

namespace ram_slam_ros {

Mounting toMounting(const geometry_msgs::Transform& base_from_sensor) {
  constexpr double kMaxTiltRad = 10.0 * M_PI / 180.0;
  const auto& q = base_from_sensor.rotation;
  const Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
  if (!(std::abs(rotation.norm() - 1.0) < 1e-3)) {
    throw std::invalid_argument("the sensor's mounting is not a rotation");
  }
  const Eigen::Vector3d up = rotation.normalized() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d ahead = rotation.normalized() * Eigen::Vector3d::UnitX();
  const double tilt_rad = std::acos(std::min(1.0, std::abs(up.z())));
  if (!(tilt_rad <= kMaxTiltRad)) {
    throw std::invalid_argument("the sensor is tilted by " + std::to_string(tilt_rad) +
                                " rad; at most " + std::to_string(kMaxTiltRad) +
                                " is taken as planar");
  }
  const auto& t = base_from_sensor.translation;
  if (!std::isfinite(t.x) || !std::isfinite(t.y))
    throw std::invalid_argument("the sensor's mounting is not finite");
  return {{t.x, t.y, std::atan2(ahead.y(), ahead.x())}, up.z() < 0.0};
}

}  // namespace ram_slam_ros
