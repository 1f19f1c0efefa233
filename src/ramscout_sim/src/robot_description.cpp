// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/robot_description.hpp"

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include "parser_log.hpp"

namespace ramscout_sim {
namespace {

constexpr double kSmallestMass_kg = 1e-3;
constexpr double kLargestMass_kg = 1e3;
constexpr double kSmallestSize_m = 0.05;
constexpr double kSmallestShape_m = 1e-3;
constexpr double kLargestSize_m = 5.0;
constexpr double kTouchesFloor_m = 2e-3;

[[noreturn]] void refuse(const std::string& element, const std::string& reason) {
  throw std::invalid_argument("robot description: " + element + ": " + reason);
}

Eigen::Isometry3d toIsometry(const urdf::Pose& pose) {
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.translate(Eigen::Vector3d(pose.position.x, pose.position.y, pose.position.z));
  const urdf::Rotation& q = pose.rotation;
  isometry.rotate(Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized());
  return isometry;
}

/// Mass properties of one link in base axes. \throws std::invalid_argument if no body can have them
MassProperties readMass(const urdf::Link& link, const Eigen::Isometry3d& base_from_link) {
  const std::string element = "link '" + link.name + "': inertial";
  const urdf::Inertial& inertial = *link.inertial;
  if (!(inertial.mass >= kSmallestMass_kg && inertial.mass <= kLargestMass_kg)) {
    refuse(element, "mass must be 0.001 to 1000 kg, got " + std::to_string(inertial.mass));
  }
  Eigen::Matrix3d own;
  own << inertial.ixx, inertial.ixy, inertial.ixz,  //
      inertial.ixy, inertial.iyy, inertial.iyz,     //
      inertial.ixz, inertial.iyz, inertial.izz;
  if (!own.allFinite()) refuse(element, "inertia must be finite");
  const Eigen::Vector3d principal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(own).eigenvalues();
  if (!(principal[0] > 0.0) || principal[0] + principal[1] < principal[2] * (1.0 - 1e-6)) {
    refuse(element,
           "inertia must be positive definite, its largest principal moment at most the sum of the "
           "others");
  }
  const double radius_of_gyration_m = std::sqrt(principal[2] / inertial.mass);
  if (radius_of_gyration_m > kLargestSize_m || radius_of_gyration_m < 1e-4) {
    refuse(element, "inertia and mass belong to a body of " + std::to_string(radius_of_gyration_m) +
                        " m radius of gyration; are the units kg and m?");
  }
  const Eigen::Isometry3d base_from_inertial = base_from_link * toIsometry(inertial.origin);
  const Eigen::Matrix3d rotation = base_from_inertial.linear();
  return {inertial.mass, base_from_inertial.translation(), rotation * own * rotation.transpose()};
}

/// Two bodies as one (parallel axis theorem).
MassProperties merge(const MassProperties& a, const MassProperties& b) {
  MassProperties sum;
  sum.mass_kg = a.mass_kg + b.mass_kg;
  if (sum.mass_kg <= 0.0) return sum;
  sum.center_in_base_m =
      (a.mass_kg * a.center_in_base_m + b.mass_kg * b.center_in_base_m) / sum.mass_kg;
  for (const MassProperties& part : {a, b}) {
    const Eigen::Vector3d offset = part.center_in_base_m - sum.center_in_base_m;
    sum.inertia_kgm2 +=
        part.inertia_kgm2 + part.mass_kg * (offset.squaredNorm() * Eigen::Matrix3d::Identity() -
                                            offset * offset.transpose());
  }
  return sum;
}

Solid readCollision(const urdf::Collision& collision,
                    const std::string& link,
                    const Eigen::Isometry3d& base_from_link) {
  const std::string element = "link '" + link + "': collision";
  Solid solid;
  solid.world_from_solid = base_from_link * toIsometry(collision.origin);
  if (!collision.geometry) refuse(element, "has no geometry");
  if (const auto box = std::dynamic_pointer_cast<urdf::Box>(collision.geometry)) {
    solid.size_m = {box->dim.x, box->dim.y, box->dim.z};
  } else if (const auto cylinder = std::dynamic_pointer_cast<urdf::Cylinder>(collision.geometry)) {
    solid.shape = Shape::kCylinder;
    solid.size_m = {2.0 * cylinder->radius, 2.0 * cylinder->radius, cylinder->length};
  } else if (const auto sphere = std::dynamic_pointer_cast<urdf::Sphere>(collision.geometry)) {
    solid.shape = Shape::kSphere;
    solid.size_m = Eigen::Vector3d::Constant(2.0 * sphere->radius);
  } else {
    refuse(element, "must be a box, a cylinder or a sphere");
  }
  if (!(solid.size_m.minCoeff() >= kSmallestShape_m && solid.size_m.maxCoeff() <= kLargestSize_m)) {
    refuse(element, "sizes must be 0.001 to 5 m; are they in metres?");
  }
  return solid;
}

bool isCaster(const Solid& shape) {
  return shape.shape == Shape::kSphere && std::abs(shape.world_from_solid.translation().z() -
                                                   0.5 * shape.size_m.x()) <= kTouchesFloor_m;
}

Wheel readWheel(const urdf::Joint& joint,
                const urdf::Link& link,
                const Eigen::Isometry3d& base_from_link) {
  const std::string element = "joint '" + joint.name + "'";
  const Eigen::Vector3d axis =
      base_from_link.linear() * Eigen::Vector3d(joint.axis.x, joint.axis.y, joint.axis.z);
  if (!axis.isApprox(Eigen::Vector3d::UnitY(), 1e-6))
    refuse(element, "a wheel's axis must be the base's y axis");
  if (!link.inertial) refuse("link '" + link.name + "'", "a wheel needs an inertial element");
  if (!link.collision) refuse("link '" + link.name + "'", "a wheel needs a collision element");
  if (!joint.limits || !(joint.limits->effort > 0.0))
    refuse(element, "needs <limit effort=...>: the motor's torque in Nm");
  const Solid shape = readCollision(*link.collision, link.name, base_from_link);
  if (shape.shape == Shape::kBox)
    refuse("link '" + link.name + "'", "a wheel's collision must be a cylinder or a sphere");
  Wheel wheel;
  wheel.joint = joint.name;
  wheel.center_in_base_m = base_from_link.translation();
  wheel.radius_m = 0.5 * shape.size_m.x();
  wheel.mass = readMass(link, base_from_link);
  wheel.max_torque_nm = joint.limits->effort;
  if (std::abs(wheel.center_in_base_m.z() - wheel.radius_m) > kTouchesFloor_m) {
    refuse(element, "the wheel must touch the floor: its centre lies " +
                        std::to_string(wheel.center_in_base_m.z()) +
                        " m above the base frame, its radius is " + std::to_string(wheel.radius_m) +
                        " m");
  }
  return wheel;
}

/// Walks the tree of links, outwards from the base.
class Reader {
public:
  explicit Reader(RobotDescription& robot) : robot_(robot) {}

  void readChassisLink(const urdf::Link& link, const Eigen::Isometry3d& base_from_link) {
    if (link.inertial) robot_.chassis = merge(robot_.chassis, readMass(link, base_from_link));
    for (const auto& collision : link.collision_array) {
      const Solid shape = readCollision(*collision, link.name, base_from_link);
      if (isCaster(shape)) {
        robot_.casters.push_back({shape.world_from_solid.translation(), 0.5 * shape.size_m.x()});
      } else {
        robot_.chassis_shapes.push_back(shape);
      }
    }
    if (link.name == robot_.laser_frame) {
      robot_.base_from_laser = base_from_link;
      found_laser_ = true;
    }
    for (const auto& joint : link.child_joints) readJoint(*joint, link, base_from_link);
  }

  void finish() {
    if (!found_laser_)
      refuse("link '" + robot_.laser_frame + "'",
             "missing, or not fixed to the base: it is the lidar");
    if (wheels_.size() != 2) {
      refuse("continuous joints",
             "two driven wheels are needed, found " + std::to_string(wheels_.size()));
    }
    if (wheels_[0].center_in_base_m.y() < wheels_[1].center_in_base_m.y())
      std::swap(wheels_[0], wheels_[1]);
    robot_.left = wheels_[0];
    robot_.right = wheels_[1];
    const Eigen::Vector3d middle =
        0.5 * (robot_.left.center_in_base_m + robot_.right.center_in_base_m);
    if (middle.head<2>().norm() > 1e-6 ||
        std::abs(robot_.left.center_in_base_m.x() - robot_.right.center_in_base_m.x()) > 1e-6) {
      refuse("link '" + robot_.base_frame + "'", "must lie midway between the two wheels");
    }
    checkSize();
  }

private:
  void readJoint(const urdf::Joint& joint,
                 const urdf::Link& parent,
                 const Eigen::Isometry3d& base_from_parent) {
    const Eigen::Isometry3d base_from_child =
        base_from_parent * toIsometry(joint.parent_to_joint_origin_transform);
    for (const auto& child : parent.child_links) {
      if (child->name != joint.child_link_name) continue;
      if (joint.type == urdf::Joint::FIXED) {
        readChassisLink(*child, base_from_child);
      } else if (joint.type == urdf::Joint::CONTINUOUS) {
        wheels_.push_back(readWheel(joint, *child, base_from_child));
      } else {
        refuse("joint '" + joint.name + "'", "must be fixed, or continuous for a driven wheel");
      }
    }
  }

  void checkSize() const {
    if (!(robot_.chassis.mass_kg > 0.0)) refuse("chassis", "no fixed link has an inertial element");
    World parts;
    parts.solids = robot_.chassis_shapes;
    if (parts.solids.empty()) refuse("chassis", "no fixed link has a collision element");
    const Eigen::Vector3d size = boundsOf(parts).sizes();
    if (size.minCoeff() < kSmallestSize_m || size.maxCoeff() > kLargestSize_m) {
      std::ostringstream text;
      text << "its size " << size.transpose()
           << " m is not within 0.05 to 5 m; are the lengths in metres?";
      refuse("chassis", text.str());
    }
    if (!(robot_.trackWidth_m() >= kSmallestSize_m))
      refuse("wheels", "must be at least 0.05 m apart");
  }

  RobotDescription& robot_;
  std::vector<Wheel> wheels_;
  bool found_laser_ = false;
};

}  // namespace

RobotDescription parseRobot(const std::string& urdf, const std::string& laser_frame) {
  ParserLog log;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(urdf);
  } catch (const std::exception& error) {
    refuse("XML", error.what());
  }
  if (!model || !model->getRoot()) {
    refuse("XML", log.errors().empty() ? "not a URDF" : log.errors());
  }
  RobotDescription robot;
  robot.name = model->getName();
  robot.base_frame = model->getRoot()->name;
  robot.laser_frame = laser_frame;
  Reader reader(robot);
  reader.readChassisLink(*model->getRoot(), Eigen::Isometry3d::Identity());
  reader.finish();
  return robot;
}

RobotDescription readRobot(const std::string& path, const std::string& laser_frame) {
  std::ifstream stream(path);
  if (!stream) throw std::runtime_error(path + ": cannot be opened");
  std::ostringstream text;
  text << stream.rdbuf();
  return parseRobot(text.str(), laser_frame);
}

}  // namespace ramscout_sim
