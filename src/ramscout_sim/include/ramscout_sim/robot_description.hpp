// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// Mass properties of a rigid body, in the axes of the robot's base frame.
struct MassProperties {
  double mass_kg = 0.0;
  Eigen::Vector3d center_in_base_m = Eigen::Vector3d::Zero();
  /// About the centre of mass.
  Eigen::Matrix3d inertia_kgm2 = Eigen::Matrix3d::Zero();
};

/// A driven wheel; its axle is parallel to the base's y axis.
struct Wheel {
  std::string joint;
  Eigen::Vector3d center_in_base_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
  MassProperties mass;
  double max_torque_nm = 0.0;
};

/// A sphere that slides on the floor without friction.
struct Caster {
  Eigen::Vector3d center_in_base_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
};

/// A robot with two driven wheels on one axle and casters, as far as the simulator needs it.
///
/// The base frame lies on the floor midway between the wheels, x forward, z up (REP 105).
struct RobotDescription {
  std::string name;
  std::string base_frame;
  std::string laser_frame;
  Eigen::Isometry3d base_from_laser = Eigen::Isometry3d::Identity();
  /// Everything that is not a driven wheel.
  MassProperties chassis;
  /// Collision shapes of the chassis; their `world_from_solid` is base_from_solid here.
  std::vector<Solid> chassis_shapes;
  Wheel left;
  Wheel right;
  std::vector<Caster> casters;

  /// Distance between the wheels' contact points.
  double trackWidth_m() const { return left.center_in_base_m.y() - right.center_in_base_m.y(); }
};

/// Reads a URDF: the links that hang together by fixed joints form the chassis, the two continuous
/// joints with axis `0 1 0` are the wheels, and a fixed link whose collision is a sphere that
/// touches the floor is a caster.
///
/// \param urdf  the XML text
/// \param laser_frame  the link that is the lidar; must be fixed to the base
/// \throws std::invalid_argument naming the element that is missing, impossible or out of
/// proportion (the chassis 0.05 to 5 m, its parts 1 mm to 5 m, masses 1 g to 1 t), or with the
/// parser's own words if the XML is not a URDF
RobotDescription parseRobot(const std::string& urdf, const std::string& laser_frame = "laser");

/// The same from a file. \throws std::runtime_error if it cannot be read
RobotDescription readRobot(const std::string& path, const std::string& laser_frame = "laser");

}  // namespace ramscout_sim
