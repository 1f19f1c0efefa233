// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

Solid makeWall(const Eigen::Vector2d& begin_m,
               const Eigen::Vector2d& end_m,
               double thickness_m,
               double height_m) {
  const Eigen::Vector2d along = end_m - begin_m;
  const Eigen::Vector2d middle = 0.5 * (begin_m + end_m);
  Solid wall;
  wall.world_from_solid.translate(Eigen::Vector3d(middle.x(), middle.y(), 0.5 * height_m));
  wall.world_from_solid.rotate(
      Eigen::AngleAxisd(std::atan2(along.y(), along.x()), Eigen::Vector3d::UnitZ()));
  wall.size_m = {along.norm(), thickness_m, height_m};
  return wall;
}

Solid makeRamp(const Eigen::Vector2d& begin_m,
               const Eigen::Vector2d& end_m,
               double width_m,
               double height_m,
               double thickness_m) {
  const Eigen::Vector2d along = end_m - begin_m;
  const Eigen::Vector2d middle = 0.5 * (begin_m + end_m);
  Solid ramp;
  ramp.drivable = true;
  ramp.world_from_solid.translate(Eigen::Vector3d(middle.x(), middle.y(), 0.5 * height_m));
  ramp.world_from_solid.rotate(
      Eigen::AngleAxisd(std::atan2(along.y(), along.x()), Eigen::Vector3d::UnitZ()));
  ramp.world_from_solid.rotate(
      Eigen::AngleAxisd(-std::atan2(height_m, along.norm()), Eigen::Vector3d::UnitY()));
  ramp.world_from_solid.translate(Eigen::Vector3d(0.0, 0.0, -0.5 * thickness_m));
  ramp.size_m = {std::hypot(along.norm(), height_m), width_m, thickness_m};
  return ramp;
}

std::vector<Material> standardMaterials() {
  std::vector<Material> materials(5);
  materials[1].name = "wood";
  materials[1].reflectivity = 0.5;
  materials[2].name = "dark";
  materials[2].reflectivity = 0.08;
  materials[3].name = "glass";
  materials[3].surface = Surface::kGlass;
  materials[4].name = "mirror";
  materials[4].surface = Surface::kMirror;
  return materials;
}

Eigen::AlignedBox3d boundsOf(const Solid& solid) {
  Eigen::AlignedBox3d own(-0.5 * solid.size_m, 0.5 * solid.size_m);
  if (solid.shape == Shape::kMesh) {
    own.setEmpty();
    for (const Eigen::Vector3f& vertex : solid.mesh->vertices_m) own.extend(vertex.cast<double>());
  }
  Eigen::AlignedBox3d bounds;
  for (int corner = 0; corner < 8; ++corner) {
    bounds.extend(solid.world_from_solid *
                  own.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  }
  return bounds;
}

Eigen::AlignedBox3d boundsOf(const World& world) {
  if (world.solids.empty())
    return {Eigen::Vector3d::Constant(-0.5), Eigen::Vector3d::Constant(0.5)};
  Eigen::AlignedBox3d bounds;
  for (const Solid& solid : world.solids) bounds.extend(boundsOf(solid));
  return bounds;
}

}  // namespace ramscout_sim
