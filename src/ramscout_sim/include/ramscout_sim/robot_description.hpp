// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// Mass properties of a rigid body, in the axes of the robot's base frame.
struct MassProperties {
  double mass_kg = 0.0;
  Eigen::Vector3d center_in_base_m = Eigen::Vector3d::Zero();
  /// About the centre of mass.
  Eigen::Matrix3d inertia_kgm2 = Eigen::Matrix3d::Zero();
};

constexpr std::size_t kMaxWheels = 4;

/// One number per wheel, in the order of RobotDescription::wheels.
using WheelValues = std::array<double, kMaxWheels>;

/// A wheel that can be turned about the vertical through its centre.
struct Steering {
  std::string joint;
  double max_angle_rad = 0.0;  ///< to either side
  double max_speed_radps = 0.0;
};

/// A wheel; what it stands on is below its centre.
struct Wheel {
  std::string joint;
  Eigen::Vector3d center_in_base_m = Eigen::Vector3d::Zero();
  /// Horizontal, length 1; a wheel that turns forward about it rolls along axle x up.
  Eigen::Vector3d axle_in_base = Eigen::Vector3d::UnitY();
  double radius_m = 0.0;
  MassProperties mass;
  double max_torque_nm = 0.0;  ///< 0: no motor, it rolls freely
  bool omni = false;           ///< has rollers on its rim, so that it slides along its axle
  std::optional<Steering> steering;
};

/// A sphere that slides on the floor without friction.
struct Caster {
  Eigen::Vector3d center_in_base_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
};

/// Two driven wheels on one axle; a car: two wheels on one axle and others that are steered; or
/// three or four omni wheels with axles in several directions.
enum class BaseKind { kDifferential, kAckermann, kOmnidirectional };

/// A robot on wheels, as far as the simulator needs it.
///
/// The base frame lies on the floor, x forward, z up (REP 105): midway between the two wheels that
/// are not steered, or anywhere for omni wheels.
struct RobotDescription {
  std::string name;
  std::string base_frame;
  std::string laser_frame;
  Eigen::Isometry3d base_from_laser = Eigen::Isometry3d::Identity();
  BaseKind kind = BaseKind::kDifferential;
  /// Everything that is not a wheel.
  MassProperties chassis;
  /// Collision shapes of the chassis; their `world_from_solid` is base_from_solid here.
  std::vector<Solid> chassis_shapes;
  /// At most kMaxWheels. Unless there are omni wheels, the first is the left and the second the
  /// right one of the axle that is not steered.
  std::vector<Wheel> wheels;
  std::vector<Caster> casters;

  /// Distance between the contact points of the first two wheels.
  double trackWidth_m() const {
    return (wheels.at(0).center_in_base_m - wheels.at(1).center_in_base_m).head<2>().norm();
  }
};

/// What a URDF may hold: numbers beyond these are a sign of wrong units.
struct RobotLimits {
  double min_mass_kg = 1e-3;  ///< of a link
  double max_mass_kg = 1e3;
  double min_shape_m = 1e-3;      ///< of a collision element
  double min_size_m = 0.05;       ///< of the chassis, of a track and of a wheelbase
  double max_size_m = 5.0;        ///< of a collision element and of the chassis
  double touches_floor_m = 2e-3;  ///< what is no farther from the floor touches it

  static const ram_parameters::ParameterTable<RobotLimits>& table();
};

/// Two bodies as one (parallel axis theorem).
MassProperties combined(const MassProperties& a, const MassProperties& b);

/// Chassis and wheels as one.
MassProperties combined(const RobotDescription& robot);

/// Reads a URDF: the links that hang together by fixed joints form the chassis, continuous joints
/// with a horizontal axis are the wheels, and a fixed link whose collision is a sphere that touches
/// the floor is a caster. A wheel has a motor if its joint has <limit effort>; it is steered if it
/// hangs on a revolute joint with axis `0 0 1`; and it is an omni wheel if not all axles of the
/// wheels are parallel without any being steered.
///
/// \param urdf  the XML text
/// \param laser_frame  the link that is the lidar; must be fixed to the base
/// \throws std::invalid_argument naming the element that is missing, impossible or out of
/// proportion (beyond `limits`), or with the
/// parser's own words if the XML is not a URDF
RobotDescription parseRobot(const std::string& urdf,
                            const std::string& laser_frame = "laser",
                            const RobotLimits& limits = {});

/// The same from a file, which errors name. \throws std::runtime_error if it cannot be read
RobotDescription readRobot(const std::string& path,
                           const std::string& laser_frame = "laser",
                           const RobotLimits& limits = {});

}  // namespace ramscout_sim
