// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include <Eigen/Geometry>
#include <ode/ode.h>

#include "ramscout_sim/robot_description.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// Owns one of ODE's objects.
template <typename Id, void (*destroy)(Id)>
class OdeHandle {
public:
  OdeHandle() = default;
  explicit OdeHandle(Id id) : id_(id) {}
  ~OdeHandle() {
    if (id_) destroy(id_);
  }
  OdeHandle(OdeHandle&& other) noexcept : id_(std::exchange(other.id_, nullptr)) {}
  OdeHandle& operator=(OdeHandle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  // NOLINTNEXTLINE(google-explicit-constructor): stands for the id in ODE's calls
  operator Id() const { return id_; }

private:
  Id id_ = nullptr;
};

using WorldHandle = OdeHandle<dWorldID, dWorldDestroy>;
using SpaceHandle = OdeHandle<dSpaceID, dSpaceDestroy>;
using GeomHandle = OdeHandle<dGeomID, dGeomDestroy>;
using MeshData = OdeHandle<dTriMeshDataID, dGeomTriMeshDataDestroy>;
using ContactGroup = OdeHandle<dJointGroupID, dJointGroupDestroy>;

/// Where a body is and how it moves, as ODE has it.
struct BodyState {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector4d quaternion = Eigen::Vector4d::UnitX();  // w x y z
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_radps = Eigen::Vector3d::Zero();
};

/// Starts ODE if need be, also for this thread.
dWorldID createOdeWorld();

Eigen::Vector3d toEigen(const dReal* v);
Eigen::Matrix3d rotationOf(dBodyID body);

BodyState atRest(const Eigen::Isometry3d& pose);
BodyState stateOf(dBodyID body);
void setState(dBodyID body, const BodyState& state);

void placeGeom(dGeomID geom, const Eigen::Isometry3d& pose);
void offsetGeom(dGeomID geom, const Eigen::Isometry3d& body_from_geom);
/// A box, cylinder or sphere. \throws std::logic_error for a mesh
dGeomID createGeom(dSpaceID space, const Solid& solid);

/// For solids that stay where they are.
dSpaceID createStaticSpace(const World& world);

/// Body with the given mass; its ODE frame is at the centre of mass, parallel to the base frame.
dBodyID createBody(dWorldID world, const MassProperties& properties);
void setMass(dBodyID body, const MassProperties& properties);

}  // namespace ramscout_sim
