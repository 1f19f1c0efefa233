// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/physics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <ode/ode.h>

namespace ramscout_sim {
namespace {

constexpr double kGravity_mps2 = 9.81;
// The floor is nearly rigid under the wheels; the casters are sprung a little softer, so that the
// wheels carry most of the weight although four points on a plane share it.
constexpr double kErrorReduction = 0.2;
constexpr double kWheelSoftness = 1e-6;
constexpr double kCasterSoftness = 1e-5;
constexpr double kSolidSoftness = 1e-5;
constexpr double kSolidFriction = 0.3;
constexpr double kMaxCorrectingSpeed_mps = 0.1;
constexpr int kContactsPerPair = 3;
constexpr int kMaxSolidContacts = 8;
constexpr double kLargestCoordinate_m = 1e5;

template <typename Id, void (*destroy)(Id)>
class Handle {
public:
  Handle() = default;
  explicit Handle(Id id) : id_(id) {}
  ~Handle() {
    if (id_) destroy(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  operator Id() const {
    return id_;
  }  // NOLINT(google-explicit-constructor): stands for the id in ODE's calls

private:
  Id id_ = nullptr;
};

using WorldHandle = Handle<dWorldID, dWorldDestroy>;
using SpaceHandle = Handle<dSpaceID, dSpaceDestroy>;
using GeomHandle = Handle<dGeomID, dGeomDestroy>;
using MeshData = Handle<dTriMeshDataID, dGeomTriMeshDataDestroy>;
using ContactGroup = Handle<dJointGroupID, dJointGroupDestroy>;

dWorldID createWorld() {
  static std::once_flag initialised;
  std::call_once(initialised, [] { dInitODE2(0); });
  dAllocateODEDataForThread(dAllocateMaskAll);
  return dWorldCreate();
}

Eigen::Vector3d toEigen(const dReal* v) {
  return {v[0], v[1], v[2]};
}

void placeGeom(dGeomID geom, const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const dQuaternion quaternion = {q.w(), q.x(), q.y(), q.z()};
  const Eigen::Vector3d p = pose.translation();
  dGeomSetPosition(geom, p.x(), p.y(), p.z());
  dGeomSetQuaternion(geom, quaternion);
}

/// Where a body is and how it moves, as ODE has it.
struct BodyState {
  Eigen::Vector3d position_m;
  Eigen::Vector4d quaternion;  // w x y z
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_radps = Eigen::Vector3d::Zero();
};

BodyState atRest(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return {pose.translation(), {q.w(), q.x(), q.y(), q.z()}};
}

BodyState stateOf(dBodyID body) {
  const dReal* q = dBodyGetQuaternion(body);
  return {toEigen(dBodyGetPosition(body)),
          {q[0], q[1], q[2], q[3]},
          toEigen(dBodyGetLinearVel(body)),
          toEigen(dBodyGetAngularVel(body))};
}

void setState(dBodyID body, const BodyState& state) {
  const auto& [p, q, v, w] = state;
  const dQuaternion quaternion = {q[0], q[1], q[2], q[3]};
  dBodySetPosition(body, p.x(), p.y(), p.z());
  dBodySetQuaternion(body, quaternion);
  dBodySetLinearVel(body, v.x(), v.y(), v.z());
  dBodySetAngularVel(body, w.x(), w.y(), w.z());
}

dGeomID createGeom(dSpaceID space, const Solid& solid) {
  switch (solid.shape) {
    case Shape::kBox:
      return dCreateBox(space, solid.size_m.x(), solid.size_m.y(), solid.size_m.z());
    case Shape::kCylinder:
      return dCreateCylinder(space, 0.5 * solid.size_m.x(), solid.size_m.z());
    case Shape::kSphere:
      return dCreateSphere(space, 0.5 * solid.size_m.x());
    case Shape::kMesh:
      break;  // needs data that outlive the geom: see addStatic
  }
  throw std::logic_error("unknown shape");
}

dSpaceID createStaticSpace(const World& world) {
  const Eigen::AlignedBox3d bounds = boundsOf(world);
  const Eigen::Vector3d center = bounds.center();
  const Eigen::Vector3d extents = 0.5 * bounds.sizes() + Eigen::Vector3d::Ones();
  const dVector3 ode_center = {center.x(), center.y(), center.z()};
  const dVector3 ode_extents = {extents.x(), extents.y(), extents.z()};
  constexpr int kDepth = 6;
  return dQuadTreeSpaceCreate(nullptr, ode_center, ode_extents, kDepth);
}

/// Body with the given mass; its ODE frame is at the centre of mass, parallel to the base frame.
dBodyID createBody(dWorldID world, const MassProperties& properties) {
  const Eigen::Matrix3d& i = properties.inertia_kgm2;
  dMass mass;
  dMassSetParameters(&mass, properties.mass_kg, 0, 0, 0, i(0, 0), i(1, 1), i(2, 2), i(0, 1),
                     i(0, 2), i(1, 2));
  const dBodyID body = dBodyCreate(world);
  dBodySetMass(body, &mass);
  return body;
}

struct WheelBody {
  Wheel description;
  dBodyID body = nullptr;
  dJointID axle = nullptr;
  GeomHandle geom;
  dJointFeedback contact_force = {};
  bool touched_floor = false;
  double load_n = 0.0;
  double angle_rad = 0.0;
};

}  // namespace

class Physics::Implementation {
public:
  Implementation(const RobotDescription& robot, const World& world, const Pose2& world_from_base)
      : robot_(robot),
        floor_friction_(world.floor_friction),
        world_(createWorld()),
        contacts_(dJointGroupCreate(0)),
        statics_(createStaticSpace(world)),
        chassis_space_(dSimpleSpaceCreate(nullptr)),
        floor_(dCreatePlane(nullptr, 0, 0, 1, 0)) {
    dWorldSetGravity(world_, 0, 0, -kGravity_mps2);
    dWorldSetERP(world_, kErrorReduction);
    dWorldSetCFM(world_, kWheelSoftness);
    dWorldSetContactMaxCorrectingVel(world_, kMaxCorrectingSpeed_mps);
    for (const Solid& solid : world.solids) {
      if (solid.solid) addStatic(solid);
    }
    createChassis();
    createWheel(robot.left, wheels_[0]);
    createWheel(robot.right, wheels_[1]);
    setPose(world_from_base);
  }

  void step(double duration_s, const WheelPair& speeds_radps) {
    dJointSetHingeParam(wheels_[0].axle, dParamVel, speeds_radps.left);
    dJointSetHingeParam(wheels_[1].axle, dParamVel, speeds_radps.right);
    for (WheelBody& wheel : wheels_) addWheelContact(wheel);
    for (const GeomHandle& caster : casters_) addCasterContact(caster);
    collideChassis();
    dWorldStep(world_, duration_s);
    for (WheelBody& wheel : wheels_) {
      wheel.load_n = wheel.touched_floor ? std::max(0.0, wheel.contact_force.f1[2]) : 0.0;
      wheel.angle_rad += duration_s * dJointGetHingeAngleRate(wheel.axle);
    }
    dJointGroupEmpty(contacts_);
    if (!worldFromBase().matrix().allFinite() || !std::isfinite(linearVelocity().norm())) {
      throw std::runtime_error("the physics diverged: the robot's pose is not finite");
    }
  }

  Eigen::Isometry3d worldFromBase() const {
    const dReal* q = dBodyGetQuaternion(chassis_);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
    pose.translation() =
        toEigen(dBodyGetPosition(chassis_)) - pose.linear() * robot_.chassis.center_in_base_m;
    return pose;
  }

  Eigen::Vector3d linearVelocity() const {
    const Eigen::Vector3d base_offset = worldFromBase().linear() * -robot_.chassis.center_in_base_m;
    return toEigen(dBodyGetLinearVel(chassis_)) + angularVelocity().cross(base_offset);
  }
  Eigen::Vector3d angularVelocity() const { return toEigen(dBodyGetAngularVel(chassis_)); }

  WheelPair angles() const { return {wheels_[0].angle_rad, wheels_[1].angle_rad}; }
  WheelPair speeds() const {
    return {dJointGetHingeAngleRate(wheels_[0].axle), dJointGetHingeAngleRate(wheels_[1].axle)};
  }
  WheelPair loads() const { return {wheels_[0].load_n, wheels_[1].load_n}; }
  bool touchesSolid() const { return solid_contacts_ > 0; }

  void setPose(const Pose2& pose) {
    if (!(std::abs(pose.x_m) <= kLargestCoordinate_m &&
          std::abs(pose.y_m) <= kLargestCoordinate_m && std::isfinite(pose.yaw_rad))) {
      throw std::invalid_argument("a robot cannot be put at (" + std::to_string(pose.x_m) + ", " +
                                  std::to_string(pose.y_m) + ") m, yaw " +
                                  std::to_string(pose.yaw_rad) +
                                  ": the pose must be finite and within 100 km");
    }
    const std::array<dBodyID, 3> bodies = {chassis_, wheels_[0].body, wheels_[1].body};
    std::array<BodyState, 3> before;
    std::transform(bodies.begin(), bodies.end(), before.begin(), stateOf);
    place(toIsometry(pose));
    if (insideSolid()) {
      for (std::size_t i = 0; i < bodies.size(); ++i) setState(bodies[i], before[i]);
      throw std::invalid_argument("a robot at (" + std::to_string(pose.x_m) + ", " +
                                  std::to_string(pose.y_m) + ") m would stand inside a solid");
    }
    for (WheelBody& wheel : wheels_) wheel.load_n = 0.25 * kGravity_mps2 * robot_.chassis.mass_kg;
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

  void createChassis() {
    chassis_ = createBody(world_, robot_.chassis);
    Eigen::Isometry3d center_from_base = Eigen::Isometry3d::Identity();
    center_from_base.translation() = -robot_.chassis.center_in_base_m;
    for (const Solid& shape : robot_.chassis_shapes) {
      const dGeomID geom = createGeom(chassis_space_, shape);
      dGeomSetBody(geom, chassis_);
      offsetGeom(geom, center_from_base * shape.world_from_solid);
    }
    for (const Caster& caster : robot_.casters) {
      casters_.emplace_back(dCreateSphere(nullptr, caster.radius_m));
      dGeomSetBody(casters_.back(), chassis_);
      const Eigen::Vector3d offset = center_from_base * caster.center_in_base_m;
      dGeomSetOffsetPosition(casters_.back(), offset.x(), offset.y(), offset.z());
    }
  }

  static void offsetGeom(dGeomID geom, const Eigen::Isometry3d& body_from_geom) {
    const Eigen::Quaterniond q(body_from_geom.linear());
    const dQuaternion quaternion = {q.w(), q.x(), q.y(), q.z()};
    const Eigen::Vector3d p = body_from_geom.translation();
    dGeomSetOffsetPosition(geom, p.x(), p.y(), p.z());
    dGeomSetOffsetQuaternion(geom, quaternion);
  }

  void createWheel(const Wheel& description, WheelBody& wheel) {
    wheel.description = description;
    wheel.body = createBody(world_, description.mass);
    wheel.geom = GeomHandle(dCreateSphere(nullptr, description.radius_m));
    dGeomSetBody(wheel.geom, wheel.body);
    const Eigen::Vector3d center = description.center_in_base_m - robot_.chassis.center_in_base_m;
    dBodySetPosition(wheel.body, center.x(), center.y(), center.z());
    wheel.axle = dJointCreateHinge(world_, nullptr);
    dJointAttach(wheel.axle, wheel.body, chassis_);
    dJointSetHingeAnchor(wheel.axle, center.x(), center.y(), center.z());
    dJointSetHingeAxis(wheel.axle, 0, 1, 0);
    dJointSetHingeParam(wheel.axle, dParamFMax, description.max_torque_nm);
  }

  void place(const Eigen::Isometry3d& world_from_base) {
    const auto at = [&world_from_base](const Eigen::Vector3d& offset) {
      Eigen::Isometry3d pose = world_from_base;
      pose.translation() = world_from_base * offset;
      return pose;
    };
    setState(chassis_, atRest(at(robot_.chassis.center_in_base_m)));
    for (WheelBody& wheel : wheels_) {
      setState(wheel.body, atRest(at(wheel.description.center_in_base_m)));
    }
  }

  bool insideSolid() {
    bool inside = false;
    dSpaceCollide2(reinterpret_cast<dGeomID>(dSpaceID(chassis_space_)),
                   reinterpret_cast<dGeomID>(dSpaceID(statics_)), &inside,
                   [](void* result, dGeomID a, dGeomID b) {
                     dContactGeom contact;
                     if (dCollide(a, b, 1, &contact, sizeof(contact)) > 0)
                       *static_cast<bool*>(result) = true;
                   });
    return inside;
  }

  /// The joint that keeps a geom on the floor; null if it does not touch.
  bool touchFloor(dGeomID geom, dContact& contact) {
    return dCollide(geom, floor_, 1, &contact.geom, sizeof(dContactGeom)) > 0;
  }

  void addWheelContact(WheelBody& wheel) {
    dContact contact = {};
    wheel.touched_floor = touchFloor(wheel.geom, contact);
    if (!wheel.touched_floor) return;
    contact.surface.mode = dContactMu2 | dContactFDir1 | dContactSoftCFM;
    contact.surface.mu = floor_friction_ * wheel.load_n;
    contact.surface.mu2 = contact.surface.mu;
    contact.surface.soft_cfm = kWheelSoftness;
    dVector3 axle;
    dJointGetHingeAxis(wheel.axle, axle);
    const Eigen::Vector3d rolling = toEigen(axle).cross(toEigen(contact.geom.normal)).normalized();
    for (int i = 0; i < 3; ++i) contact.fdir1[i] = rolling[i];
    const dJointID joint = dJointCreateContact(world_, contacts_, &contact);
    dJointSetFeedback(joint, &wheel.contact_force);
    dJointAttach(joint, wheel.body, nullptr);
  }

  void addCasterContact(dGeomID caster) {
    dContact contact = {};
    if (!touchFloor(caster, contact)) return;
    contact.surface.mode = dContactSoftCFM;
    contact.surface.mu = 0.0;
    contact.surface.soft_cfm = kCasterSoftness;
    dJointAttach(dJointCreateContact(world_, contacts_, &contact), chassis_, nullptr);
  }

  void collideChassis() {
    solid_contacts_ = 0;
    const auto near = [](void* self, dGeomID a, dGeomID b) {
      static_cast<Implementation*>(self)->touchSolid(a, b);
    };
    dSpaceCollide2(reinterpret_cast<dGeomID>(dSpaceID(chassis_space_)),
                   reinterpret_cast<dGeomID>(dSpaceID(statics_)), this, near);
    // A robot that tips over lies on the floor with its chassis.
    if (worldFromBase().linear()(2, 2) < 0.99) {
      dSpaceCollide2(reinterpret_cast<dGeomID>(dSpaceID(chassis_space_)), floor_, this, near);
    }
  }

  void touchSolid(dGeomID a, dGeomID b) {
    std::array<dContactGeom, kContactsPerPair> touches;
    const int count = dCollide(a, b, kContactsPerPair, touches.data(), sizeof(dContactGeom));
    for (int i = 0; i < count && solid_contacts_ < kMaxSolidContacts; ++i) {
      dContact contact = {};
      contact.geom = touches[static_cast<std::size_t>(i)];
      contact.surface.mode = dContactApprox1 | dContactSoftCFM;
      contact.surface.mu = kSolidFriction;
      contact.surface.soft_cfm = kSolidSoftness;
      dJointAttach(dJointCreateContact(world_, contacts_, &contact), dGeomGetBody(contact.geom.g1),
                   dGeomGetBody(contact.geom.g2));
      ++solid_contacts_;
    }
  }

  RobotDescription robot_;
  double floor_friction_;
  WorldHandle world_;
  ContactGroup contacts_;
  std::vector<std::shared_ptr<const TriangleMesh>> meshes_;
  std::vector<MeshData> mesh_data_;
  SpaceHandle statics_;
  SpaceHandle chassis_space_;
  GeomHandle floor_;
  dBodyID chassis_ = nullptr;
  std::vector<GeomHandle> casters_;
  std::array<WheelBody, 2> wheels_;
  int solid_contacts_ = 0;
};

Physics::Physics(const RobotDescription& robot, const World& world, const Pose2& world_from_base)
    : implementation_(std::make_unique<Implementation>(robot, world, world_from_base)) {}
Physics::~Physics() = default;
Physics::Physics(Physics&&) noexcept = default;
Physics& Physics::operator=(Physics&&) noexcept = default;

void Physics::step(double duration_s, const WheelPair& wheel_speeds_radps) {
  implementation_->step(duration_s, wheel_speeds_radps);
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
WheelPair Physics::wheelAngles_rad() const {
  return implementation_->angles();
}
WheelPair Physics::wheelSpeeds_radps() const {
  return implementation_->speeds();
}
WheelPair Physics::wheelLoads_n() const {
  return implementation_->loads();
}
bool Physics::touchesSolid() const {
  return implementation_->touchesSolid();
}
void Physics::setPose(const Pose2& world_from_base) {
  implementation_->setPose(world_from_base);
}

}  // namespace ramscout_sim
