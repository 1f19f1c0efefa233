// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/ray_caster.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <utility>

#include "ramscout_sim/moving_solids.hpp"

#include "mesh_scene.hpp"
#include "solid_tree.hpp"

namespace ramscout_sim {
namespace {

/// The floor up to z = 0, a metre thick, around the solids as far as any lidar reaches (80 m).
Solid floorUnder(const World& world) {
  constexpr double kMargin_m = 100.0;
  const Eigen::AlignedBox3d bounds = boundsOf(world);
  Solid floor;
  floor.size_m = bounds.sizes() + Eigen::Vector3d::Constant(2.0 * kMargin_m);
  floor.size_m.z() = 1.0;
  floor.world_from_solid.translate(Eigen::Vector3d(bounds.center().x(), bounds.center().y(), -0.5));
  return floor;
}

/// The solids that are seen, and meshes or not; the floor is not one.
std::vector<Solid> seen(const World& world, bool meshes) {
  std::vector<Solid> solids;
  std::copy_if(world.solids.begin(), world.solids.end(), std::back_inserter(solids),
               [meshes](const Solid& solid) {
                 return solid.seen && (solid.shape == Shape::kMesh) == meshes;
               });
  return solids;
}

std::vector<Solid> floorAndSolids(const World& world) {
  std::vector<Solid> solids = seen(world, false);
  solids.insert(solids.begin(), floorUnder(world));
  return solids;
}

}  // namespace

class RayCaster::Implementation {
public:
  Implementation(const World& world, InstructionSet widest)
      : widest_(widest), solids_(floorAndSolids(world)) {
    std::vector<Solid> meshes = seen(world, true);
    if (!meshes.empty()) meshes_.emplace(std::move(meshes), widest);
  }

  std::vector<float> cast(const Rays& rays, float farthest_m) const {
    std::vector<float> distances_m = solids_.cast(rays, farthest_m, widest_).distances_m;
    if (meshes_) meshes_->cast(rays, farthest_m, distances_m);
    return distances_m;
  }

  std::vector<Hit> trace(const Rays& rays, float farthest_m) const {
    const auto& [distances_m, solids] = solids_.cast(rays, farthest_m, widest_);
    std::vector<Hit> hits(rays.size());
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (solids[i] < 0) continue;
      const Solid& solid = solids_[static_cast<std::size_t>(solids[i])];
      const std::optional<Hit> exact = intersect(rays[i], solid);  // or along an edge
      hits[i] = {distances_m[i], exact ? exact->normal : -rays[i].direction,
                 static_cast<std::uint32_t>(solid.material)};
    }
    if (meshes_) meshes_->trace(rays, farthest_m, hits);
    return hits;
  }

private:
  InstructionSet widest_;
  SolidTree solids_;
  std::optional<MeshScene> meshes_;
};

Rays::Rays(std::size_t count)
    : origins_m(static_cast<Eigen::Index>(count), 3),
      directions(static_cast<Eigen::Index>(count), 3) {}

Rays::Rays(const std::vector<Ray>& rays) : Rays(rays.size()) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    origins_m.row(static_cast<Eigen::Index>(i)) = rays[i].origin_m;
    directions.row(static_cast<Eigen::Index>(i)) = rays[i].direction;
  }
}

Ray Rays::operator[](std::size_t index) const {
  const auto row = static_cast<Eigen::Index>(index);
  return {origins_m.row(row), directions.row(row)};
}

RayCaster::RayCaster(const World& world, InstructionSet widest)
    : implementation_(std::make_unique<Implementation>(world, widest)),
      materials_(world.materials),
      has_clear_surfaces_(
          std::any_of(world.solids.begin(), world.solids.end(), [&world](const Solid& solid) {
            return solid.seen && world.materials[solid.material].surface != Surface::kOpaque;
          })) {}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;
std::vector<float> RayCaster::cast(const Rays& rays, float farthest_m) const {
  return implementation_->cast(rays, farthest_m);
}
std::vector<Hit> RayCaster::trace(const Rays& rays, float farthest_m) const {
  return implementation_->trace(rays, farthest_m);
}

}  // namespace ramscout_sim
