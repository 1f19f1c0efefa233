// SPDX-License-Identifier: BSD-3-Clause
#include "ode_objects.hpp"

#include <mutex>
#include <stdexcept>

namespace ramscout_sim {

dWorldID createOdeWorld() {
  static std::once_flag initialised;
  std::call_once(initialised, [] { dInitODE2(0); });
  dAllocateODEDataForThread(dAllocateMaskAll);
  return dWorldCreate();
}

Eigen::Vector3d toEigen(const dReal* v) {
  return {v[0], v[1], v[2]};
}

Eigen::Matrix3d rotationOf(dBodyID body) {
  const dReal* r = dBodyGetRotation(body);
  Eigen::Matrix3d rotation;
  rotation << r[0], r[1], r[2],  //
      r[4], r[5], r[6],          //
      r[8], r[9], r[10];
  return rotation;
}

BodyState atRest(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  BodyState state;
  state.position_m = pose.translation();
  state.quaternion = {q.w(), q.x(), q.y(), q.z()};
  return state;
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

void placeGeom(dGeomID geom, const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const dQuaternion quaternion = {q.w(), q.x(), q.y(), q.z()};
  const Eigen::Vector3d p = pose.translation();
  dGeomSetPosition(geom, p.x(), p.y(), p.z());
  dGeomSetQuaternion(geom, quaternion);
}

void offsetGeom(dGeomID geom, const Eigen::Isometry3d& body_from_geom) {
  const Eigen::Quaterniond q(body_from_geom.linear());
  const dQuaternion quaternion = {q.w(), q.x(), q.y(), q.z()};
  const Eigen::Vector3d p = body_from_geom.translation();
  dGeomSetOffsetPosition(geom, p.x(), p.y(), p.z());
  dGeomSetOffsetQuaternion(geom, quaternion);
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
      break;  // needs data that outlive the geom
  }
  throw std::logic_error("unknown shape");
}

dSpaceID createStaticSpace(const World& world) {
  const Eigen::AlignedBox3d bounds = boundsOf(world);
  const Eigen::Vector3d center = bounds.center();
  const Eigen::Vector3d extents = 0.5 * bounds.sizes() + Eigen::Vector3d::Ones();
  const dVector3 ode_center = {center.x(), center.y(), center.z()};
  const dVector3 ode_extents = {extents.x(), extents.y(), extents.z()};
  constexpr int kDepth = 6;  // faster than 4 and 8 for ODE's rays, see docs/simulator_physics.md
  return dQuadTreeSpaceCreate(nullptr, ode_center, ode_extents, kDepth);
}

void setMass(dBodyID body, const MassProperties& properties) {
  const Eigen::Matrix3d& i = properties.inertia_kgm2;
  dMass mass;
  dMassSetParameters(&mass, properties.mass_kg, 0, 0, 0, i(0, 0), i(1, 1), i(2, 2), i(0, 1),
                     i(0, 2), i(1, 2));
  dBodySetMass(body, &mass);
}

dBodyID createBody(dWorldID world, const MassProperties& properties) {
  const dBodyID body = dBodyCreate(world);
  setMass(body, properties);
  return body;
}

}  // namespace ramscout_sim
