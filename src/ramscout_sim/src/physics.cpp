// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/physics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "ode_objects.hpp"

namespace ramscout_sim {
namespace {

// The floor is nearly rigid under the wheels; the casters are sprung a little softer, so that the
// wheels carry most of the weight although four points on a plane share it.
constexpr double kErrorReduction = 0.2;
constexpr double kWheelSoftness = 1e-6;
constexpr double kCasterSoftness = 1e-5;
constexpr double kSolidSoftness = 1e-5;
constexpr double kFrictionSoftness = 1e-9;  // two wheels on one axle resist the same motion
// ODE's solver gives up (and says so) if two wheels reach their friction limits at the very same
// moment, as those of a symmetric robot do: each wheel has a little more than the one before.
constexpr double kTieBreaker = 1e-6;
constexpr double kSolidFriction = 0.3;
constexpr double kMaxCorrectingSpeed_mps = 0.1;
constexpr int kContactsPerPair = 3;
constexpr std::size_t kMaxSolidContacts = 8;
constexpr double kLargestCoordinate_m = 1e5;
constexpr double kLargestSum = 1e6;  // of coordinates and speeds; NaN is not below it either
constexpr int kMotorTrials = 4;
// How far around the robot it is looked for solids, and how many steps it is not looked again
// where one is near.
constexpr std::array<double, 3> kLookAhead_m = {0.5, 0.1, 0.02};
constexpr int kStepsNearSolid = 20;

struct WheelState {
  Wheel description;
  Eigen::Vector3d center_in_body_m = Eigen::Vector3d::Zero();
  double inertia_kgm2 = 0.0;  // about the axle
  double friction_share = 1.0;
  double steering_rad = 0.0;
  double angle_rad = 0.0;
  double speed_radps = 0.0;
  double acceleration_radps2 = 0.0;
  double load_n = 0.0;
  /// What the motor gives whatever the speed; nothing: it holds its speed.
  std::optional<double> fixed_torque_nm;

  // In the step under way.
  bool touches_floor = false;
  Eigen::Vector3d rolling = Eigen::Vector3d::UnitX();  // world axes
  dContact contact = {};
  dJointFeedback force = {};

  double traction_n() const { return touches_floor ? toEigen(force.f1).dot(rolling) : 0.0; }
};

}  // namespace

class Physics::Implementation {
public:
  Implementation(const RobotDescription& robot, const World& world, const Pose2& world_from_base)
      : robot_(robot),
        whole_(combined(robot)),
        floor_friction_(world.floor_friction),
        world_(createOdeWorld()),
        contacts_(dJointGroupCreate(0)),
        statics_(createStaticSpace(world)),
        obstacle_space_(dSimpleSpaceCreate(nullptr)),
        chassis_space_(dSimpleSpaceCreate(nullptr)),
        floor_(dCreatePlane(nullptr, 0, 0, 1, 0)),
        probe_(dCreateSphere(nullptr, 1.0)),
        chassis_(createBody(world_, whole_)) {
    const Eigen::Vector3d& gravity = world.gravity_mps2;
    dWorldSetGravity(world_, gravity.x(), gravity.y(), gravity.z());
    dWorldSetERP(world_, kErrorReduction);
    dWorldSetCFM(world_, kFrictionSoftness);
    dWorldSetContactMaxCorrectingVel(world_, kMaxCorrectingSpeed_mps);
    for (const Solid& solid : world.solids) {
      if (solid.solid) addStatic(solid);
    }
    createChassis();
    for (const Wheel& wheel : robot.wheels) createWheel(wheel);
    setPose(world_from_base);
  }

  void step(double duration_s, const WheelMotion& motion) {
    solid_contacts_.clear();
    if (mayTouchSolid() || isTipped()) collideChassis();
    if (!obstacles_.empty()) collideChassisWith(obstacle_space_);
    for (std::size_t i = 0; i < wheels_.size(); ++i) {
      wheels_[i].steering_rad = motion.steering_rad[i];
      prepareContact(wheels_[i]);
    }
    const BodyState before = stateOf(chassis_);
    for (int trial = 0; trial < kMotorTrials; ++trial) {
      if (trial > 0) setState(chassis_, before);
      addSpinTorques();
      dBodyAddForce(chassis_, push_n_.x(), push_n_.y(), push_n_.z());
      createContactJoints(duration_s, motion);
      dWorldStep(world_, duration_s);
      dJointGroupEmpty(contacts_);
      if (motorsDidAsAssumed(duration_s, motion)) break;
    }
    for (std::size_t i = 0; i < wheels_.size(); ++i)
      spin(wheels_[i], duration_s, motion.speeds_radps[i]);
    const double sum = toEigen(dBodyGetPosition(chassis_)).sum() + rotationOf(chassis_).sum() +
                       toEigen(dBodyGetLinearVel(chassis_)).sum();
    if (!(std::abs(sum) <= kLargestSum))
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

  void setObstacles(const std::vector<Solid>& solids) {
    const bool same_shapes = std::equal(
        solids.begin(), solids.end(), obstacles_.begin(), obstacles_.end(),
        [](const Solid& a, const Solid& b) { return a.shape == b.shape && a.size_m == b.size_m; });
    obstacles_ = solids;
    if (!same_shapes) {
      obstacle_geoms_.clear();
      for (const Solid& solid : solids)
        obstacle_geoms_.emplace_back(createGeom(obstacle_space_, solid));
    }
    for (std::size_t i = 0; i < solids.size(); ++i)
      placeGeom(obstacle_geoms_[i], solids[i].world_from_solid);
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
    if (insideSolid()) {
      setState(chassis_, before);
      throw std::invalid_argument("a robot at (" + std::to_string(pose.x_m) + ", " +
                                  std::to_string(pose.y_m) + ") m would stand inside a solid");
    }
    for (WheelState& wheel : wheels_) {
      wheel.load_n = 0.25 * dGravity() * whole_.mass_kg;
      wheel.speed_radps = wheel.acceleration_radps2 = 0.0;
    }
    clear_within_m_ = 0.0;
    steps_near_solid_ = 0;
  }

private:
  void addStatic(const Solid& solid) {
    if (solid.shape != Shape::kMesh) {
      placeGeom(createGeom(statics_, solid), solid.world_from_solid);
      return;
    }
    const TriangleMesh& mesh = *solid.mesh;
    meshes_.push_back(solid.mesh);  // ODE reads it where it is
    mesh_data_.emplace_back(dGeomTriMeshDataCreate());
    dGeomTriMeshDataBuildSingle(mesh_data_.back(), mesh.vertices_m.data(), sizeof(Eigen::Vector3f),
                                static_cast<int>(mesh.vertices_m.size()), mesh.triangles.data(),
                                static_cast<int>(3 * mesh.triangles.size()), 3 * sizeof(unsigned));
    placeGeom(dCreateTriMesh(statics_, mesh_data_.back(), nullptr, nullptr, nullptr),
              solid.world_from_solid);
  }

  double dGravity() const {
    dVector3 gravity;
    dWorldGetGravity(world_, gravity);
    return toEigen(gravity).norm();
  }

  void createChassis() {
    Eigen::Isometry3d body_from_base = Eigen::Isometry3d::Identity();
    body_from_base.translation() = -whole_.center_in_base_m;
    World parts;
    parts.solids = robot_.chassis_shapes;
    const Eigen::AlignedBox3d bounds = boundsOf(parts);
    reach_m_ = (bounds.max() - whole_.center_in_base_m)
                   .cwiseAbs()
                   .cwiseMax((bounds.min() - whole_.center_in_base_m).cwiseAbs())
                   .norm();
    for (const Solid& shape : robot_.chassis_shapes) {
      const dGeomID geom = createGeom(chassis_space_, shape);
      dGeomSetBody(geom, chassis_);
      offsetGeom(geom, body_from_base * shape.world_from_solid);
    }
  }

  void createWheel(const Wheel& description) {
    WheelState wheel;
    wheel.description = description;
    wheel.center_in_body_m = description.center_in_base_m - whole_.center_in_base_m;
    wheel.inertia_kgm2 =
        description.axle_in_base.dot(description.mass.inertia_kgm2 * description.axle_in_base);
    wheel.friction_share = 1.0 + kTieBreaker * static_cast<double>(wheels_.size());
    if (description.max_torque_nm == 0.0) wheel.fixed_torque_nm = 0.0;
    wheels_.push_back(wheel);
  }

  bool insideSolid() {
    bool inside = false;
    for (const SpaceHandle* space : {&statics_, &obstacle_space_}) {
      dSpaceCollide2(reinterpret_cast<dGeomID>(dSpaceID(chassis_space_)),
                     reinterpret_cast<dGeomID>(dSpaceID(*space)), &inside, setIfTouching);
    }
    return inside;
  }

  static void setIfTouching(void* result, dGeomID a, dGeomID b) {
    dContactGeom contact;
    if (dCollide(a, b, 1, &contact, sizeof(contact)) > 0) *static_cast<bool*>(result) = true;
  }

  /// False while the robot cannot have reached what was nearest when it last looked around; solids
  /// stand still.
  bool mayTouchSolid() {
    const Eigen::Vector3d position = toEigen(dBodyGetPosition(chassis_));
    if ((position - clear_around_m_).norm() < clear_within_m_) return false;
    if (steps_near_solid_ > 0) {
      --steps_near_solid_;
      return true;
    }
    clear_around_m_ = position;
    dGeomSetPosition(probe_, position.x(), position.y(), position.z());
    for (const double ahead_m : kLookAhead_m) {
      bool occupied = false;
      dGeomSphereSetRadius(probe_, reach_m_ + ahead_m);
      dSpaceCollide2(probe_, reinterpret_cast<dGeomID>(dSpaceID(statics_)), &occupied,
                     setIfTouching);
      clear_within_m_ = occupied ? 0.0 : ahead_m;
      if (!occupied) return false;
    }
    steps_near_solid_ = kStepsNearSolid;
    return true;
  }

  /// The contact of a sphere with the floor; false if it does not touch.
  static bool touchFloor(const Eigen::Vector3d& center_m, double radius_m, dContact& contact) {
    contact.geom.depth = radius_m - center_m.z();
    if (contact.geom.depth < 0.0) return false;
    contact.geom.pos[0] = center_m.x();
    contact.geom.pos[1] = center_m.y();
    contact.geom.pos[2] = center_m.z() - radius_m;
    contact.geom.normal[2] = 1.0;
    return true;
  }

  Eigen::Vector3d inWorld(const Eigen::Vector3d& in_body_m) const {
    return toEigen(dBodyGetPosition(chassis_)) + rotationOf(chassis_) * in_body_m;
  }

  Eigen::Vector3d axleInWorld(const WheelState& wheel) const {
    const Eigen::AngleAxisd steered(wheel.steering_rad, Eigen::Vector3d::UnitZ());
    return rotationOf(chassis_) * (steered * wheel.description.axle_in_base);
  }

  void prepareContact(WheelState& wheel) const {
    wheel.contact = {};
    wheel.touches_floor =
        touchFloor(inWorld(wheel.center_in_body_m), wheel.description.radius_m, wheel.contact);
    if (!wheel.touches_floor) return;
    wheel.rolling = axleInWorld(wheel).cross(Eigen::Vector3d::UnitZ()).normalized();
    for (int i = 0; i < 3; ++i) wheel.contact.fdir1[i] = wheel.rolling[i];
    dSurfaceParameters& surface = wheel.contact.surface;
    surface.mode = dContactMu2 | dContactFDir1 | dContactMotion1 | dContactSlip1 | dContactSoftCFM;
    surface.mu = floor_friction_ * wheel.load_n * wheel.friction_share;
    surface.mu2 = wheel.description.omni ? 0.0 : surface.mu;
    surface.soft_cfm = kWheelSoftness;
  }

  /// Contact speed = r w' with w' = target, or w + h / I (torque - r traction).
  static void driveContact(WheelState& wheel, double duration_s, double target_radps) {
    dSurfaceParameters& surface = wheel.contact.surface;
    const double radius_m = wheel.description.radius_m;
    surface.motion1 = radius_m * target_radps;
    surface.slip1 = kFrictionSoftness;
    if (wheel.fixed_torque_nm) {
      const double per_torque = duration_s / wheel.inertia_kgm2;
      surface.motion1 = radius_m * (wheel.speed_radps + per_torque * *wheel.fixed_torque_nm);
      surface.slip1 += radius_m * radius_m * per_torque;
    }
  }

  void createContactJoints(double duration_s, const WheelMotion& motion) {
    for (std::size_t i = 0; i < wheels_.size(); ++i) {
      WheelState& wheel = wheels_[i];
      if (!wheel.touches_floor) continue;
      driveContact(wheel, duration_s, motion.speeds_radps[i]);
      const dJointID joint = dJointCreateContact(world_, contacts_, &wheel.contact);
      dJointSetFeedback(joint, &wheel.force);
      dJointAttach(joint, chassis_, nullptr);
    }
    for (const Caster& caster : robot_.casters) {
      dContact contact = {};
      const Eigen::Vector3d center_m = inWorld(caster.center_in_base_m - whole_.center_in_base_m);
      if (!touchFloor(center_m, caster.radius_m, contact)) continue;
      contact.surface.mode = dContactSoftCFM;
      contact.surface.soft_cfm = kCasterSoftness;
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
    for (const WheelState& wheel : wheels_) {
      const Eigen::Vector3d axle = wheel.inertia_kgm2 * axleInWorld(wheel);
      torque_nm -=
          wheel.acceleration_radps2 * axle + angularVelocity().cross(wheel.speed_radps * axle);
    }
    dBodyAddTorque(chassis_, torque_nm.x(), torque_nm.y(), torque_nm.z());
  }

  /// The torque that would bring the wheel to the target speed.
  static double neededTorque_nm(const WheelState& wheel, double duration_s, double target_radps) {
    return wheel.inertia_kgm2 * (target_radps - wheel.speed_radps) / duration_s +
           wheel.description.radius_m * wheel.traction_n();
  }

  /// Otherwise notes what to assume instead.
  bool motorsDidAsAssumed(double duration_s, const WheelMotion& motion) {
    bool right = true;
    for (std::size_t i = 0; i < wheels_.size(); ++i) {
      WheelState& wheel = wheels_[i];
      const double limit_nm = wheel.description.max_torque_nm;
      if (limit_nm == 0.0) continue;
      const double needed_nm = neededTorque_nm(wheel, duration_s, motion.speeds_radps[i]);
      std::optional<double> fixed_nm;
      if (std::abs(needed_nm) > limit_nm) fixed_nm = std::copysign(limit_nm, needed_nm);
      right = right && fixed_nm == wheel.fixed_torque_nm;
      wheel.fixed_torque_nm = fixed_nm;
    }
    return right;
  }

  static void spin(WheelState& wheel, double duration_s, double target_radps) {
    const double limit_nm = wheel.description.max_torque_nm;
    const double torque_nm =
        std::clamp(neededTorque_nm(wheel, duration_s, target_radps), -limit_nm, limit_nm);
    wheel.acceleration_radps2 =
        (torque_nm - wheel.description.radius_m * wheel.traction_n()) / wheel.inertia_kgm2;
    wheel.speed_radps += duration_s * wheel.acceleration_radps2;
    wheel.angle_rad += duration_s * wheel.speed_radps;
    wheel.load_n = wheel.touches_floor ? std::max(0.0, wheel.force.f1[2]) : 0.0;
  }

  void collideChassis() {
    collideChassisWith(statics_);
    // A robot that tips over lies on the floor with its chassis.
    if (isTipped()) {
      dSpaceCollide2(reinterpret_cast<dGeomID>(dSpaceID(chassis_space_)), floor_, this, touch);
    }
  }

  void collideChassisWith(const SpaceHandle& space) {
    dSpaceCollide2(reinterpret_cast<dGeomID>(dSpaceID(chassis_space_)),
                   reinterpret_cast<dGeomID>(dSpaceID(space)), this, touch);
  }

  static void touch(void* self, dGeomID a, dGeomID b) {
    static_cast<Implementation*>(self)->touchSolid(a, b);
  }

  bool isTipped() const { return rotationOf(chassis_)(2, 2) < 0.99; }

  void touchSolid(dGeomID a, dGeomID b) {
    std::array<dContactGeom, kContactsPerPair> touches;
    const int count = dCollide(a, b, kContactsPerPair, touches.data(), sizeof(dContactGeom));
    for (int i = 0; i < count && solid_contacts_.size() < kMaxSolidContacts; ++i) {
      dContact contact = {};
      contact.geom = touches[static_cast<std::size_t>(i)];
      contact.surface.mode = dContactApprox1 | dContactSoftCFM;
      contact.surface.mu = kSolidFriction;
      contact.surface.soft_cfm = kSolidSoftness;
      solid_contacts_.push_back(contact);
    }
  }

  RobotDescription robot_;
  MassProperties whole_;
  double floor_friction_;
  WorldHandle world_;
  ContactGroup contacts_;
  std::vector<std::shared_ptr<const TriangleMesh>> meshes_;
  std::vector<MeshData> mesh_data_;
  SpaceHandle statics_;
  SpaceHandle obstacle_space_;
  std::vector<GeomHandle> obstacle_geoms_;
  std::vector<Solid> obstacles_;
  Eigen::Vector3d push_n_ = Eigen::Vector3d::Zero();
  SpaceHandle chassis_space_;
  GeomHandle floor_;
  GeomHandle probe_;
  dBodyID chassis_;
  std::vector<WheelState> wheels_;
  std::vector<dContact> solid_contacts_;
  double reach_m_ = 0.0;  // of the chassis from its centre of mass
  Eigen::Vector3d clear_around_m_ = Eigen::Vector3d::Zero();
  double clear_within_m_ = 0.0;
  int steps_near_solid_ = 0;
};

Physics::Physics(const RobotDescription& robot, const World& world, const Pose2& world_from_base)
    : implementation_(std::make_unique<Implementation>(robot, world, world_from_base)) {}
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
  return implementation_->ofWheels(&WheelState::angle_rad);
}
WheelValues Physics::wheelSpeeds_radps() const {
  return implementation_->ofWheels(&WheelState::speed_radps);
}
WheelValues Physics::wheelLoads_n() const {
  return implementation_->ofWheels(&WheelState::load_n);
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
void Physics::setObstacles(const std::vector<Solid>& solids) {
  implementation_->setObstacles(solids);
}
void Physics::setPose(const Pose2& world_from_base) {
  implementation_->setPose(world_from_base);
}

}  // namespace ramscout_sim
