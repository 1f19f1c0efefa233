// SPDX-License-Identifier: BSD-3-Clause
#include "surroundings.hpp"

#include <algorithm>

namespace ramscout_sim {
namespace {

dGeomID asGeom(const SpaceHandle& space) {
  return reinterpret_cast<dGeomID>(dSpaceID(space));
}

void setIfTouching(void* result, dGeomID a, dGeomID b) {
  dContactGeom contact;
  if (dCollide(a, b, 1, &contact, sizeof(contact)) > 0) *static_cast<bool*>(result) = true;
}

/// What ODE hands through to addContacts.
struct Search {
  const PhysicsParameters& parameters;
  std::vector<dContact>& contacts;
  std::vector<dContactGeom>& touches;  // room for those of one pair
};

void addContacts(void* data, dGeomID a, dGeomID b) {
  const auto& [parameters, contacts, touches] = *static_cast<Search*>(data);
  const int count =
      dCollide(a, b, parameters.contacts_per_pair, touches.data(), sizeof(dContactGeom));
  const auto most = static_cast<std::size_t>(parameters.max_contacts);
  for (int i = 0; i < count && contacts.size() < most; ++i) {
    dContact contact = {};
    contact.geom = touches[static_cast<std::size_t>(i)];
    contact.surface.mode = dContactApprox1 | dContactSoftCFM;
    contact.surface.mu = parameters.solid_friction;
    contact.surface.soft_cfm = parameters.solid_softness;
    contacts.push_back(contact);
  }
}

}  // namespace

Surroundings::Surroundings(const World& world, const PhysicsParameters& parameters)
    : parameters_(parameters),
      touches_(static_cast<std::size_t>(parameters.contacts_per_pair)),
      statics_(createStaticSpace(world)),
      obstacle_space_(dSimpleSpaceCreate(nullptr)),
      probe_(dCreateSphere(nullptr, 1.0)) {
  for (const Solid& solid : world.solids) {
    if (solid.solid) addStatic(solid);
  }
}

void Surroundings::addStatic(const Solid& solid) {
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

void Surroundings::setObstacles(const std::vector<Solid>& solids) {
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

bool Surroundings::touch(const SpaceHandle& chassis) const {
  bool touching = false;
  for (const SpaceHandle* space : {&statics_, &obstacle_space_})
    dSpaceCollide2(asGeom(chassis), asGeom(*space), &touching, setIfTouching);
  return touching;
}

std::vector<dContact> Surroundings::contacts(const SpaceHandle& chassis,
                                             const Eigen::Vector3d& center_m,
                                             double reach_m) {
  std::vector<dContact> found;
  if (mayTouchSolid(center_m, reach_m)) collide(chassis, asGeom(statics_), found);
  if (!obstacles_.empty()) collide(chassis, asGeom(obstacle_space_), found);
  return found;
}

void Surroundings::collide(const SpaceHandle& chassis,
                           dGeomID other,
                           std::vector<dContact>& contacts) {
  Search search = {parameters_, contacts, touches_};
  dSpaceCollide2(asGeom(chassis), other, &search, addContacts);
}

void Surroundings::forgetWhatIsNear() {
  clear_within_m_ = 0.0;
  steps_near_solid_ = 0;
}

/// False while the robot cannot have reached what was nearest when it last looked around; solids
/// stand still.
bool Surroundings::mayTouchSolid(const Eigen::Vector3d& center_m, double reach_m) {
  if ((center_m - clear_around_m_).norm() < clear_within_m_) return false;
  if (steps_near_solid_ > 0) {
    --steps_near_solid_;
    return true;
  }
  clear_around_m_ = center_m;
  dGeomSetPosition(probe_, center_m.x(), center_m.y(), center_m.z());
  for (const double ahead_m : parameters_.look_ahead_m) {
    bool occupied = false;
    dGeomSphereSetRadius(probe_, reach_m + ahead_m);
    dSpaceCollide2(probe_, asGeom(statics_), &occupied, setIfTouching);
    clear_within_m_ = occupied ? 0.0 : ahead_m;
    if (!occupied) return false;
  }
  steps_near_solid_ = parameters_.steps_near_solid;
  return true;
}

}  // namespace ramscout_sim
