// SPDX-License-Identifier: BSD-3-Clause
#include "ground.hpp"

namespace ramscout_sim {
namespace {

void keepDeepest(void* result, dGeomID ball, dGeomID solid) {
  dContactGeom& deepest = *static_cast<dContactGeom*>(result);
  dContactGeom contact;
  if (dCollide(ball, solid, 1, &contact, sizeof(contact)) == 0) return;
  if (contact.depth > deepest.depth) deepest = contact;
}

}  // namespace

Ground::Ground(const World& world)
    : solids_(createStaticSpace(world)), ball_(dCreateSphere(nullptr, 1.0)) {
  for (const Solid& solid : world.solids) {
    if (!solid.drivable) continue;
    is_even_ = false;
    placeGeom(createGeom(solids_, solid), solid.world_from_solid);
  }
}

bool Ground::touch(const Eigen::Vector3d& center_m, double radius_m, dContactGeom& contact) const {
  contact.depth = radius_m - center_m.z();
  contact.pos[0] = center_m.x();
  contact.pos[1] = center_m.y();
  contact.pos[2] = center_m.z() - radius_m;
  contact.normal[0] = contact.normal[1] = 0.0;
  contact.normal[2] = 1.0;
  if (!is_even_) {
    dGeomSphereSetRadius(ball_, radius_m);
    dGeomSetPosition(ball_, center_m.x(), center_m.y(), center_m.z());
    dSpaceCollide2(ball_, reinterpret_cast<dGeomID>(dSpaceID(solids_)), &contact, keepDeepest);
  }
  return contact.depth >= 0.0;
}

}  // namespace ramscout_sim
