// SPDX-License-Identifier: BSD-3-Clause
// The tree against Embree, against each solid in turn, and against itself.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <gmock/gmock.h>

#include "ramscout_sim/moving_solids.hpp"
#include "ramscout_sim/office.hpp"
#include "ramscout_sim/random.hpp"
#include "ramscout_sim/ray_caster.hpp"

#include "ray_worlds.hpp"
#include "shared.hpp"

namespace ramscout_sim {
namespace {

using testing::clutter;
using ::testing::Each;
using testing::removeAllButBoxes;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kLaserHeight_m = 0.37;

/// Beams of a turn about each of `places`, tilted a little, one after the other as a lidar's are.
Rays turnsAt(const std::vector<Eigen::Vector2d>& places) {
  constexpr int kBeams = 1081;
  std::vector<Ray> rays;
  for (const Eigen::Vector2d& place : places) {
    const Eigen::Isometry3d tilt = toIsometry({place.x(), place.y(), place.x()}) *
                                   Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY());
    for (int beam = 0; beam < kBeams; ++beam) {
      const double bearing_rad = 2.0 * M_PI * beam / kBeams;
      const Eigen::Vector3d to(std::cos(bearing_rad), std::sin(bearing_rad), 0.0);
      rays.push_back({Eigen::Vector3f(static_cast<float>(place.x()), static_cast<float>(place.y()),
                                      static_cast<float>(kLaserHeight_m)),
                      (tilt.linear() * to).cast<float>()});
    }
  }
  return rays;
}

/// At every metre of the tour through a building.
Rays turnsThrough(const Office& building) {
  const std::vector<Eigen::Vector2d>& waypoints_m = building.tour.waypoints_m;
  std::vector<Eigen::Vector2d> places;
  for (std::size_t i = 1; i < waypoints_m.size(); ++i) {
    const Eigen::Vector2d leg = waypoints_m[i] - waypoints_m[i - 1];
    for (double way_m = 0.0; way_m < leg.norm(); way_m += 1.0)
      places.push_back(waypoints_m[i - 1] + way_m * leg.normalized());
  }
  return turnsAt(places);
}

/// Rays from anywhere in a world to anywhere, up and down as well.
Rays strayRays(const World& world, int count) {
  const Eigen::AlignedBox3d bounds = boundsOf(world);
  Random random(21, Stream::kRange);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d from(random.uniform(bounds.min().x(), bounds.max().x()),
                               random.uniform(bounds.min().y(), bounds.max().y()),
                               random.uniform(0.05, 2.0));
    const Eigen::Vector3d to(random.gaussian(), random.gaussian(), random.gaussian());
    rays.push_back({from.cast<float>(), to.normalized().cast<float>()});
  }
  rays[0].direction = Eigen::Vector3f(0.0F, 0.0F, -1.0F);
  rays[1].direction = Eigen::Vector3f(0.0F, 0.0F, 1.0F);
  return rays;
}

/// The boxes of a world as a single mesh, which Embree casts.
World asMesh(const World& world) {
  constexpr std::array<std::array<unsigned, 4>, 6> kFaces = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  auto mesh = std::make_shared<TriangleMesh>();
  for (const Solid& box : world.solids) {
    const auto first = static_cast<unsigned>(mesh->vertices_m.size());
    for (unsigned i = 0; i < 8; ++i) {
      const Eigen::Vector3d sign((i & 1U) != 0 ? 0.5 : -0.5, (i & 2U) != 0 ? 0.5 : -0.5,
                                 (i & 4U) != 0 ? 0.5 : -0.5);
      mesh->vertices_m.push_back(
          (box.world_from_solid * sign.cwiseProduct(box.size_m)).cast<float>());
    }
    for (const auto& [a, b, c, d] : kFaces) {
      mesh->triangles.push_back({first + a, first + b, first + c});
      mesh->triangles.push_back({first + a, first + c, first + d});
    }
  }
  Solid solid;
  solid.shape = Shape::kMesh;
  solid.mesh = mesh;
  World meshes;
  meshes.solids = {solid};
  return meshes;
}

TEST(SolidTree, AgreesWithEmbreeAlongATourThroughAnOffice) {
  Office building = generateOffice({});
  removeAllButBoxes(building.world);
  const Rays rays = turnsThrough(building);
  const std::vector<float> own = RayCaster(building.world).cast(rays);
  const std::vector<float> embrees = RayCaster(asMesh(building.world)).cast(rays);
  int different = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (!(std::abs(own[i] - embrees[i]) < 1e-3F || own[i] == embrees[i])) ++different;
  }
  EXPECT_GT(own.size(), 30000U);
  EXPECT_LE(different, static_cast<int>(own.size() / 10000));  // along the edge of a box
}

TEST(SolidTree, HasTheSameBitsWithAllVectorInstructions) {
  const Office building = generateOffice({});
  for (const Rays& rays : {turnsThrough(building), strayRays(building.world, 5000)}) {
    const std::vector<float> plain = RayCaster(building.world, InstructionSet::kSse42).cast(rays);
    for (const InstructionSet set : {InstructionSet::kAvx2, InstructionSet::kAvx512})
      EXPECT_EQ(RayCaster(building.world, set).cast(rays), plain);
  }
}

TEST(SolidTree, RaysInAllDirectionsEndAtTheNearestSolid) {
  for (const World& world : {generateOffice({}).world, clutter()}) {
    const Rays rays = strayRays(world, 5000);
    const std::vector<Hit> found = RayCaster(world).trace(rays);
    int different = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Ray ray = rays[i];
      float nearest_m = -ray.origin_m.z() / ray.direction.z();
      if (!(nearest_m >= 0.0F)) nearest_m = kInfinity;
      for (const Solid& solid : world.solids) {
        const std::optional<Hit> hit = intersect(ray, solid);
        if (hit) nearest_m = std::min(nearest_m, hit->distance_m);
      }
      if (nearest_m > 100.0F) continue;  // the floor ends somewhere
      if (!(std::abs(found[i].distance_m - nearest_m) < 1e-3F)) ++different;
    }
    EXPECT_LE(different, 1);  // along the edge of a box
  }
}

TEST(SolidTree, RaysDoNotDependOnTheirNeighbours) {
  const Office building = generateOffice({});
  const Rays rays = turnsThrough(building);
  const RayCaster caster(building.world);
  const std::vector<float> together = caster.cast(rays);
  for (std::size_t i = 0; i < rays.size(); i += 97)
    EXPECT_EQ(caster.cast(std::vector<Ray>(1, rays[i]))[0], together[i]) << i;
}

TEST(SolidTree, ALimitOfTheRangeLeavesOutWhatIsBeyondOnly) {
  const Office building = generateOffice({});
  const Rays rays = turnsThrough(building);
  for (const World& world : {building.world, asMesh(building.world)}) {
    const RayCaster caster(world);
    const std::vector<float> all = caster.cast(rays);
    const std::vector<float> near = caster.cast(rays, 3.0F);
    int beyond = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i] <= 3.0F) {
        ASSERT_EQ(near[i], all[i]) << i;
      } else {
        ASSERT_GT(near[i], 3.0F) << i;
        beyond += near[i] == kInfinity ? 1 : 0;
      }
    }
    EXPECT_GT(beyond, 1000);
  }
}

TEST(SolidTree, StandsManySolidsInOnePlace) {
  World world;
  for (int i = 0; i < 3000; ++i)
    world.solids.push_back(makeWall({5.0, -1.0}, {5.0, 1.0}, 0.2, 2.0));
  const RayCaster caster(world);
  EXPECT_THAT(caster.cast(std::vector<Ray>(40, Ray{{0, 0, 1}, {1, 0, 0}})),
              Each(::testing::FloatNear(4.9F, 1e-5F)));
}

}  // namespace
}  // namespace ramscout_sim
