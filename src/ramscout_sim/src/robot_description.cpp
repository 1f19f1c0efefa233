// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/robot_description.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include "parser_log.hpp"
#include "xml_text.hpp"

namespace ramscout_sim {
namespace {

using ram_parameters::toPlainText;

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
MassProperties readMass(const urdf::Link& link,
                        const Eigen::Isometry3d& base_from_link,
                        const RobotLimits& limits) {
  const std::string element = "link '" + link.name + "': inertial";
  const urdf::Inertial& inertial = *link.inertial;
  if (!(inertial.mass >= limits.min_mass_kg && inertial.mass <= limits.max_mass_kg)) {
    refuse(element, "mass must be " + toPlainText(limits.min_mass_kg) + " to " +
                        toPlainText(limits.max_mass_kg) + " kg, got " +
                        std::to_string(inertial.mass));
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
  if (radius_of_gyration_m > limits.max_size_m || radius_of_gyration_m < 1e-4) {
    refuse(element, "inertia and mass belong to a body of " + std::to_string(radius_of_gyration_m) +
                        " m radius of gyration; are the units kg and m?");
  }
  const Eigen::Isometry3d base_from_inertial = base_from_link * toIsometry(inertial.origin);
  const Eigen::Matrix3d rotation = base_from_inertial.linear();
  return {inertial.mass, base_from_inertial.translation(), rotation * own * rotation.transpose()};
}

Solid readCollision(const urdf::Collision& collision,
                    const std::string& link,
                    const Eigen::Isometry3d& base_from_link,
                    const RobotLimits& limits) {
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
  if (!(solid.size_m.minCoeff() >= limits.min_shape_m &&
        solid.size_m.maxCoeff() <= limits.max_size_m)) {
    refuse(element, "sizes must be " + toPlainText(limits.min_shape_m) + " to " +
                        toPlainText(limits.max_size_m) + " m; are they in metres?");
  }
  return solid;
}

bool isCaster(const Solid& shape, const RobotLimits& limits) {
  const double above_floor_m = shape.world_from_solid.translation().z() - 0.5 * shape.size_m.x();
  return shape.shape == Shape::kSphere && std::abs(above_floor_m) <= limits.touches_floor_m;
}

/// The axis without the small errors of descriptions that write 1.57 for a right angle.
Eigen::Vector3d horizontalAxis(const Eigen::Vector3d& axis, const std::string& element) {
  constexpr double kRounding = 1e-2;
  if (!(std::abs(axis.z()) < kRounding && std::abs(axis.norm() - 1.0) < 1e-3))
    refuse(element, "a wheel's axis must be horizontal");
  const auto rounded = [](double value) { return std::abs(value) < kRounding ? 0.0 : value; };
  return Eigen::Vector3d(rounded(axis.x()), rounded(axis.y()), 0.0).normalized();
}

Wheel readWheel(const urdf::Joint& joint,
                const urdf::Link& link,
                const Eigen::Isometry3d& base_from_link,
                const RobotLimits& limits) {
  const std::string element = "joint '" + joint.name + "'";
  const Eigen::Vector3d axis = horizontalAxis(
      base_from_link.linear() * Eigen::Vector3d(joint.axis.x, joint.axis.y, joint.axis.z), element);
  if (!link.inertial) refuse("link '" + link.name + "'", "a wheel needs an inertial element");
  if (!link.collision) refuse("link '" + link.name + "'", "a wheel needs a collision element");
  const Solid shape = readCollision(*link.collision, link.name, base_from_link, limits);
  if (shape.shape == Shape::kBox)
    refuse("link '" + link.name + "'", "a wheel's collision must be a cylinder or a sphere");
  Wheel wheel;
  wheel.joint = joint.name;
  wheel.center_in_base_m = base_from_link.translation();
  wheel.axle_in_base = axis.normalized();
  wheel.radius_m = 0.5 * shape.size_m.x();
  wheel.mass = readMass(link, base_from_link, limits);
  if (joint.limits) wheel.max_torque_nm = joint.limits->effort;
  if (!(wheel.max_torque_nm >= 0.0 && std::isfinite(wheel.max_torque_nm)))
    refuse(element, "<limit effort=...>, the motor's torque in Nm, must be >= 0");
  if (std::abs(wheel.center_in_base_m.z() - wheel.radius_m) > limits.touches_floor_m) {
    refuse(element, "the wheel must touch the floor: its centre lies " +
                        std::to_string(wheel.center_in_base_m.z()) +
                        " m above the base frame, its radius is " + std::to_string(wheel.radius_m) +
                        " m");
  }
  return wheel;
}

Steering readSteering(const urdf::Joint& joint, const Eigen::Isometry3d& base_from_link) {
  const std::string element = "joint '" + joint.name + "'";
  const Eigen::Vector3d axis =
      base_from_link.linear() * Eigen::Vector3d(joint.axis.x, joint.axis.y, joint.axis.z);
  if (!axis.isApprox(Eigen::Vector3d::UnitZ(), 1e-6))
    refuse(element, "a wheel is steered about the base's z axis");
  Steering steering;
  steering.joint = joint.name;
  if (joint.limits) {
    steering.max_angle_rad = std::min(-joint.limits->lower, joint.limits->upper);
    steering.max_speed_radps = joint.limits->velocity;
  }
  if (!(steering.max_angle_rad > 0.0 && steering.max_angle_rad < M_PI_2))
    refuse(element, "needs <limit lower=... upper=...> around 0 and within a right angle");
  if (!(steering.max_speed_radps > 0.0))
    refuse(element, "needs <limit velocity=...>: how fast it steers, in rad/s");
  return steering;
}

/// \throws std::invalid_argument if a base of this kind cannot drive on these wheels
void checkMotors(const RobotDescription& robot) {
  const std::vector<Wheel>& wheels = robot.wheels;
  const auto idle = std::find_if(wheels.begin(), wheels.end(),
                                 [](const Wheel& wheel) { return wheel.max_torque_nm == 0.0; });
  const bool car = robot.kind == BaseKind::kAckermann;
  if (car && std::all_of(wheels.begin(), wheels.end(),
                         [](const Wheel& wheel) { return wheel.max_torque_nm == 0.0; }))
    refuse("continuous joints", "a car needs a driven wheel: <limit effort=...>");
  if (!car && idle != wheels.end())
    refuse("joint '" + idle->joint + "'", "needs <limit effort=...>: the motor's torque in Nm");
  const std::string found = ", found " + std::to_string(wheels.size());
  if (robot.kind == BaseKind::kDifferential && wheels.size() != 2)
    refuse("continuous joints", "two driven wheels are needed" + found);
  if (robot.kind == BaseKind::kOmnidirectional && wheels.size() < 3)
    refuse("continuous joints", "three or four omni wheels are needed" + found);
}

/// Walks the tree of links, outwards from the base.
class Reader {
public:
  Reader(RobotDescription& robot, const RobotLimits& limits) : robot_(robot), limits_(limits) {}

  void readChassisLink(const urdf::Link& link, const Eigen::Isometry3d& base_from_link) {
    if (link.inertial)
      robot_.chassis = combined(robot_.chassis, readMass(link, base_from_link, limits_));
    for (const auto& collision : link.collision_array) {
      const Solid shape = readCollision(*collision, link.name, base_from_link, limits_);
      if (isCaster(shape, limits_)) {
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
    arrangeWheels();
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
        robot_.wheels.push_back(readWheel(joint, *child, base_from_child, limits_));
      } else if (joint.type == urdf::Joint::REVOLUTE) {
        readSteeredWheel(joint, *child, base_from_child);
      } else {
        refuse("joint '" + joint.name + "'",
               "must be fixed, continuous for a wheel, or revolute to steer one");
      }
    }
  }

  /// The link between, the knuckle, counts as part of the chassis.
  void readSteeredWheel(const urdf::Joint& joint,
                        const urdf::Link& knuckle,
                        const Eigen::Isometry3d& base_from_knuckle) {
    const std::string element = "joint '" + joint.name + "'";
    const Steering steering = readSteering(joint, base_from_knuckle);
    const std::size_t before = robot_.wheels.size();
    readChassisLink(knuckle, base_from_knuckle);
    if (robot_.wheels.size() != before + 1) refuse(element, "must steer one wheel");
    Wheel& wheel = robot_.wheels.back();
    if ((wheel.center_in_base_m - base_from_knuckle.translation()).head<2>().norm() > 1e-6)
      refuse(element, "its axis must go through the centre of the wheel");
    wheel.steering = steering;
  }

  /// Finds out what kind of base it is; the wheels that are not steered come first, left before
  /// right.
  void arrangeWheels() {
    std::vector<Wheel>& wheels = robot_.wheels;
    const std::string number = "found " + std::to_string(wheels.size());
    if (wheels.size() < 2 || wheels.size() > kMaxWheels)
      refuse("continuous joints", "two driven wheels are needed, at most four wheels, " + number);
    std::stable_sort(wheels.begin(), wheels.end(), [](const Wheel& a, const Wheel& b) {
      if (a.steering.has_value() != b.steering.has_value()) return b.steering.has_value();
      return a.center_in_base_m.y() > b.center_in_base_m.y();
    });
    // Either sign: an axis to the right rolls forward at a negative speed.
    const bool forward = std::all_of(wheels.begin(), wheels.end(), [](const Wheel& wheel) {
      return std::abs(wheel.axle_in_base.y()) > 1.0 - 1e-6;
    });
    if (wheels.back().steering) {
      robot_.kind = BaseKind::kAckermann;
    } else if (!forward) {
      robot_.kind = BaseKind::kOmnidirectional;
      for (Wheel& wheel : wheels) wheel.omni = true;
    }
    checkMotors(robot_);
    if (robot_.kind == BaseKind::kOmnidirectional) {
      checkMobility();
    } else {
      checkAxle(forward);
    }
  }

  void checkAxle(bool forward) const {
    const Wheel& left = robot_.wheels[0];
    const Wheel& right = robot_.wheels[1];
    if (left.steering || right.steering || (robot_.wheels.size() > 2 && !robot_.wheels[2].steering))
      refuse("continuous joints", "exactly two wheels of a car must not be steered");
    if (!forward) refuse("continuous joints", "a wheel's axis must be the base's y axis");
    const Eigen::Vector3d middle = 0.5 * (left.center_in_base_m + right.center_in_base_m);
    if (middle.head<2>().norm() > 1e-6 ||
        std::abs(left.center_in_base_m.x() - right.center_in_base_m.x()) > 1e-6) {
      refuse("link '" + robot_.base_frame + "'", "must lie midway between the two wheels");
    }
    if (!(robot_.trackWidth_m() >= limits_.min_size_m))
      refuse("wheels", "must be at least " + toPlainText(limits_.min_size_m) + " m apart");
    for (const Wheel& wheel : robot_.wheels) {
      if (wheel.steering && std::abs(wheel.center_in_base_m.x()) < limits_.min_size_m)
        refuse("joint '" + wheel.joint + "'", "a steered wheel must not lie on the other axle");
    }
  }

  /// Omni wheels must resist motion in every direction, or nothing would hold the robot.
  void checkMobility() const {
    Eigen::Matrix<double, Eigen::Dynamic, 3> rows(robot_.wheels.size(), 3);
    for (std::size_t i = 0; i < robot_.wheels.size(); ++i) {
      const Wheel& wheel = robot_.wheels[i];
      const Eigen::Vector3d rolling = wheel.axle_in_base.cross(Eigen::Vector3d::UnitZ());
      const double lever_m = wheel.center_in_base_m.cross(rolling).z();
      rows.row(static_cast<Eigen::Index>(i)) << rolling.x(), rolling.y(),
          lever_m / limits_.min_size_m;
    }
    const auto singular = Eigen::JacobiSVD<Eigen::MatrixXd>(rows).singularValues();
    if (!(singular[2] > 0.1))
      refuse("continuous joints", "such omni wheels cannot hold the base in every direction");
  }

  void checkSize() const {
    if (!(robot_.chassis.mass_kg > 0.0)) refuse("chassis", "no fixed link has an inertial element");
    World parts;
    parts.solids = robot_.chassis_shapes;
    if (parts.solids.empty()) refuse("chassis", "no fixed link has a collision element");
    const Eigen::Vector3d size = boundsOf(parts).sizes();
    if (size.minCoeff() < limits_.min_size_m || size.maxCoeff() > limits_.max_size_m) {
      std::ostringstream text;
      text << "its size " << size.transpose() << " m is not within "
           << toPlainText(limits_.min_size_m) << " to " << toPlainText(limits_.max_size_m)
           << " m; are the lengths in metres?";
      refuse("chassis", text.str());
    }
  }

  RobotDescription& robot_;
  const RobotLimits& limits_;
  bool found_laser_ = false;
};

}  // namespace

MassProperties combined(const MassProperties& a, const MassProperties& b) {
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

MassProperties combined(const RobotDescription& robot) {
  MassProperties whole = robot.chassis;
  for (const Wheel& wheel : robot.wheels) whole = combined(whole, wheel.mass);
  return whole;
}

const ram_parameters::ParameterTable<RobotLimits>& RobotLimits::table() {
  using namespace ram_parameters;
  using P = RobotLimits;
  static const auto table =
      ParameterTable<P>()
          .add("min_mass_kg", &P::min_mass_kg, "kg", positive(), "Lightest link.")
          .add("max_mass_kg", &P::max_mass_kg, "kg", positive(), "Heaviest link.")
          .add("min_shape_m", &P::min_shape_m, "m", positive(),
               "Smallest side of a collision element.")
          .add("min_size_m", &P::min_size_m, "m", positive(),
               "Smallest chassis, track and wheelbase.")
          .add("max_size_m", &P::max_size_m, "m", positive(),
               "Largest collision element and chassis.")
          .add("touches_floor_m", &P::touches_floor_m, "m", positive(),
               "Wheels and casters no farther from the floor touch it.");
  return table;
}

RobotDescription parseRobot(const std::string& urdf,
                            const std::string& laser_frame,
                            const RobotLimits& limits) {
  ParserLog log;
  urdf::ModelInterfaceSharedPtr model;
  try {
    requireShallowXml(urdf);
    model = urdf::parseURDF(urdf);
  } catch (const std::exception& error) {
    refuse("XML", error.what());
  }
  if (!model || !model->getRoot())
    refuse("XML", log.errors().empty() ? "not a URDF" : log.errors());
  RobotDescription robot;
  robot.name = model->getName();
  robot.base_frame = model->getRoot()->name;
  robot.laser_frame = laser_frame;
  Reader reader(robot, limits);
  reader.readChassisLink(*model->getRoot(), Eigen::Isometry3d::Identity());
  reader.finish();
  return robot;
}

RobotDescription readRobot(const std::string& path,
                           const std::string& laser_frame,
                           const RobotLimits& limits) {
  const std::string text = readXml(path);
  try {
    return parseRobot(text, laser_frame, limits);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(path + ": " + error.what());
  }
}

}  // namespace ramscout_sim
