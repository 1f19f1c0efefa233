// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/physics.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "ground.hpp"
#include "ode_objects.hpp"
#include "surroundings.hpp"
#include "wheel_contact.hpp"

namespace ramscout_sim {
class Physics::Implementation {
public:
  Implementation(const RobotDescription& robot,
                 const World& world,
                 const Pose2& world_from_base,
                 const PhysicsParameters& parameters)
      : parameters_(parameters),
        robot_(robot),
        whole_(combined(robot)),
        floor_friction_(world.floor_friction),
        world_(createOdeWorld()),
        contacts_(dJointGroupCreate(0)),
        surroundings_(world, parameters),
        ground_(world),
        chassis_space_(dSimpleSpaceCreate(nullptr)),
        floor_(dCreatePlane(nullptr, 0, 0, 1, 0)),
        chassis_(createBody(world_, whole_)) {
    const Eigen::Vector3d& gravity = world.gravity_mps2;
    dWorldSetGravity(world_, gravity.x(), gravity.y(), gravity.z());
    dWorldSetERP(world_, parameters_.error_reduction);
    dWorldSetCFM(world_, parameters_.friction_softness);
    dWorldSetContactMaxCorrectingVel(world_, parameters_.max_correcting_speed_mps);
    for (const Solid& shape : robot_.chassis_shapes) {
      chassis_geoms_.push_back(createGeom(chassis_space_, shape));
      dGeomSetBody(chassis_geoms_.back(), chassis_);
    }
    for (const Wheel& wheel : robot.wheels) wheels_.emplace_back(wheel, wheels_.size(), parameters);
    arrangeAboutCenterOfMass();
    setPose(world_from_base);
  }

  void step(double duration_s, const WheelMotion& motion) {
    collideChassis();
    for (std::size_t i = 0; i < wheels_.size(); ++i) {
      WheelContact& wheel = wheels_[i];
      wheel.steering_rad = motion.steering_rad[i];
      wheel.touch(ground_, inWorld(wheel.center_in_body_m), axleInWorld(wheel), floor_friction_);
    }
    const BodyState before = stateOf(chassis_);
    for (int trial = 0; trial < parameters_.motor_trials; ++trial) {
      if (trial > 0) setState(chassis_, before);
      addSpinTorques();
      dBodyAddForce(chassis_, push_n_.x(), push_n_.y(), push_n_.z());
      createContactJoints(duration_s, motion);
      dWorldStep(world_, duration_s);
      dJointGroupEmpty(contacts_);
      if (motorsDidAsAssumed(duration_s, motion)) break;
    }
    for (std::size_t i = 0; i < wheels_.size(); ++i)
      wheels_[i].spin(duration_s, motion.speeds_radps[i]);
    const double sum = toEigen(dBodyGetPosition(chassis_)).sum() + rotationOf(chassis_).sum() +
                       toEigen(dBodyGetLinearVel(chassis_)).sum();
    if (!(std::abs(sum) <= parameters_.diverged_sum))  // nor is NaN
      throw std::runtime_error("the physics diverged: the robot's pose or speed is absurd");
  }

  Eigen::Isometry3d worldFromBase() const {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = rotationOf(chassis_);
    pose.translation() =
        toEigen(dBodyGetPosition(chassis_)) - pose.linear() * whole_.center_in_base_m;
    return pose;
  }

  Eigen::Vector3d linearVelocity() const {
    const Eigen::Vector3d base_offset = rotationOf(chassis_) * -whole_.center_in_base_m;
    return toEigen(dBodyGetLinearVel(chassis_)) + angularVelocity().cross(base_offset);
  }
  Eigen::Vector3d angularVelocity() const { return toEigen(dBodyGetAngularVel(chassis_)); }

  template <typename Member>
  WheelValues ofWheels(Member member) const {
    WheelValues values = {};
    for (std::size_t i = 0; i < wheels_.size(); ++i) values[i] = wheels_[i].*member;
    return values;
  }
  bool touchesSolid() const { return !solid_contacts_.empty(); }
  void setFloorFriction(double friction) { floor_friction_ = friction; }
  void setPush(const Eigen::Vector3d& force_n) { push_n_ = force_n; }

  void setObstacles(const std::vector<Solid>& solids) { surroundings_.setObstacles(solids); }

  void setPayload(const MassProperties& payload) {
    const BodyState before = stateOf(chassis_);
    const Eigen::Isometry3d world_from_base = worldFromBase();
    const Eigen::Vector3d base_velocity_mps = linearVelocity();
    whole_ = combined(combined(robot_), payload);
    setMass(chassis_, whole_);
    arrangeAboutCenterOfMass();
    BodyState after = before;
    after.position_m = world_from_base * whole_.center_in_base_m;
    after.velocity_mps = base_velocity_mps + before.turn_radps.cross(world_from_base.linear() *
                                                                     whole_.center_in_base_m);
    setState(chassis_, after);
  }

  void setPose(const Pose2& pose) {
    if (!(std::abs(pose.x_m) <= kLargestCoordinate_m &&
          std::abs(pose.y_m) <= kLargestCoordinate_m && std::isfinite(pose.yaw_rad))) {
      throw std::invalid_argument("a robot cannot be put at (" + std::to_string(pose.x_m) + ", " +
                                  std::to_string(pose.y_m) + ") m, yaw " +
                                  std::to_string(pose.yaw_rad) +
                                  ": the pose must be finite and within 100 km");
    }
    const BodyState before = stateOf(chassis_);
    Eigen::Isometry3d world_from_body = toIsometry(pose);
    world_from_body.translation() = world_from_body * whole_.center_in_base_m;
    setState(chassis_, atRest(world_from_body));
    if (surroundings_.touch(chassis_space_)) {
      setState(chassis_, before);
      throw std::invalid_argument("a robot at (" + std::to_string(pose.x_m) + ", " +
                                  std::to_string(pose.y_m) + ") m would stand inside a solid");
    }
    for (WheelContact& wheel : wheels_) {
      wheel.load_n = 0.25 * gravity_mps2() * whole_.mass_kg;
      wheel.speed_radps = wheel.acceleration_radps2 = 0.0;
    }
    surroundings_.forgetWhatIsNear();
  }

private:
  double gravity_mps2() const {
    dVector3 gravity;
    dWorldGetGravity(world_, gravity);
    return toEigen(gravity).norm();
  }

  /// ODE's body is at the centre of mass.
  void arrangeAboutCenterOfMass() {
    const Eigen::Isometry3d body_from_base(Eigen::Translation3d(-whole_.center_in_base_m));
    for (std::size_t i = 0; i < chassis_geoms_.size(); ++i)
      offsetGeom(chassis_geoms_[i], body_from_base * robot_.chassis_shapes[i].world_from_solid);
    for (WheelContact& wheel : wheels_)
      wheel.center_in_body_m = body_from_base * wheel.description.center_in_base_m;
    World parts;
    parts.solids = robot_.chassis_shapes;
    const Eigen::AlignedBox3d bounds = boundsOf(parts);
    reach_m_ = (bounds.max() - whole_.center_in_base_m)
                   .cwiseAbs()
                   .cwiseMax((bounds.min() - whole_.center_in_base_m).cwiseAbs())
                   .norm();
  }

  Eigen::Vector3d inWorld(const Eigen::Vector3d& in_body_m) const {
    return toEigen(dBodyGetPosition(chassis_)) + rotationOf(chassis_) * in_body_m;
  }
  Eigen::Vector3d axleInWorld(const WheelContact& wheel) const {
    return rotationOf(chassis_) * wheel.axleInBody();
  }

  void collideChassis() {
    solid_contacts_ =
        surroundings_.contacts(chassis_space_, toEigen(dBodyGetPosition(chassis_)), reach_m_);
    // A robot that tips over lies on the floor with its chassis.
    if (rotationOf(chassis_)(2, 2) < parameters_.lying_cosine)
      surroundings_.collide(chassis_space_, floor_, solid_contacts_);
  }

  void createContactJoints(double duration_s, const WheelMotion& motion) {
    for (std::size_t i = 0; i < wheels_.size(); ++i) {
      WheelContact& wheel = wheels_[i];
      if (!wheel.touches_ground) continue;
      wheel.drive(duration_s, motion.speeds_radps[i]);
      const dJointID joint = dJointCreateContact(world_, contacts_, &wheel.contact);
      dJointSetFeedback(joint, &wheel.force);
      dJointAttach(joint, chassis_, nullptr);
    }
    for (const Caster& caster : robot_.casters) {
      dContact contact = {};
      const Eigen::Vector3d center_m = inWorld(caster.center_in_base_m - whole_.center_in_base_m);
      if (!ground_.touch(center_m, caster.radius_m, contact.geom)) continue;
      contact.surface.mode = dContactSoftCFM;
      contact.surface.soft_cfm = parameters_.caster_softness;
      dJointAttach(dJointCreateContact(world_, contacts_, &contact), chassis_, nullptr);
    }
    for (const dContact& contact : solid_contacts_) {
      dJointAttach(dJointCreateContact(world_, contacts_, &contact), dGeomGetBody(contact.geom.g1),
                   dGeomGetBody(contact.geom.g2));
    }
  }

  /// What the spinning wheels do to the chassis: the reaction to their acceleration (of the step
  /// before) and their gyroscopic torque.
  void addSpinTorques() {
    Eigen::Vector3d torque_nm = Eigen::Vector3d::Zero();
    for (const WheelContact& wheel : wheels_) {
      const Eigen::Vector3d axle = wheel.inertia_kgm2 * axleInWorld(wheel);
      torque_nm -=
          wheel.acceleration_radps2 * axle + angularVelocity().cross(wheel.speed_radps * axle);
    }
    dBodyAddTorque(chassis_, torque_nm.x(), torque_nm.y(), torque_nm.z());
  }

  /// Otherwise it is noted what to assume instead.
  bool motorsDidAsAssumed(double duration_s, const WheelMotion& motion) {
    bool right = true;
    for (std::size_t i = 0; i < wheels_.size(); ++i)
      right = wheels_[i].didAsAssumed(duration_s, motion.speeds_radps[i]) && right;
    return right;
  }

  PhysicsParameters parameters_;
  RobotDescription robot_;
  MassProperties whole_;
  double floor_friction_;
  WorldHandle world_;
  ContactGroup contacts_;
  Surroundings surroundings_;
  Ground ground_;
  Eigen::Vector3d push_n_ = Eigen::Vector3d::Zero();
  SpaceHandle chassis_space_;
  std::vector<dGeomID> chassis_geoms_;
  GeomHandle floor_;
  dBodyID chassis_;
  std::vector<WheelContact> wheels_;
  std::vector<dContact> solid_contacts_;
  double reach_m_ = 0.0;  // of the chassis from its centre of mass
};

Physics::Physics(const RobotDescription& robot,
                 const World& world,
                 const Pose2& world_from_base,
                 const PhysicsParameters& parameters)
    : implementation_(std::make_unique<Implementation>(robot, world, world_from_base, parameters)) {
}
Physics::~Physics() = default;
Physics::Physics(Physics&&) noexcept = default;
Physics& Physics::operator=(Physics&&) noexcept = default;

void Physics::step(double duration_s, const WheelMotion& motion) {
  implementation_->step(duration_s, motion);
}
Eigen::Isometry3d Physics::worldFromBase() const {
  return implementation_->worldFromBase();
}
Eigen::Vector3d Physics::linearVelocity_mps() const {
  return implementation_->linearVelocity();
}
Eigen::Vector3d Physics::angularVelocity_radps() const {
  return implementation_->angularVelocity();
}
WheelValues Physics::wheelAngles_rad() const {
  return implementation_->ofWheels(&WheelContact::angle_rad);
}
WheelValues Physics::wheelSpeeds_radps() const {
  return implementation_->ofWheels(&WheelContact::speed_radps);
}
WheelValues Physics::wheelLoads_n() const {
  return implementation_->ofWheels(&WheelContact::load_n);
}
bool Physics::touchesSolid() const {
  return implementation_->touchesSolid();
}
void Physics::setFloorFriction(double friction) {
  if (!(friction >= 0.0 && std::isfinite(friction))) {
    throw std::invalid_argument("floor friction must be >= 0 and finite, got " +
                                std::to_string(friction));
  }
  implementation_->setFloorFriction(friction);
}
void Physics::setPush(const Eigen::Vector3d& force_n) {
  implementation_->setPush(force_n);
}
void Physics::setPayload(const MassProperties& payload) {
  if (!(payload.mass_kg >= 0.0 && std::isfinite(payload.mass_kg))) {
    throw std::invalid_argument("a payload's mass must be >= 0 and finite, got " +
                                std::to_string(payload.mass_kg));
  }
  implementation_->setPayload(payload);
}
void Physics::setObstacles(const std::vector<Solid>& solids) {
  implementation_->setObstacles(solids);
}
void Physics::setPose(const Pose2& world_from_base) {
  implementation_->setPose(world_from_base);
}

}  // namespace ramscout_sim
