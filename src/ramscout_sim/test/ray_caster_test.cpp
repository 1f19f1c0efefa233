// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/ray_caster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <gmock/gmock.h>
#include <ode/ode.h>

#include "ramscout_sim/moving_solids.hpp"
#include "ramscout_sim/office.hpp"
#include "ramscout_sim/random.hpp"

#include "ray_worlds.hpp"
#include "shared.hpp"

namespace ramscout_sim {
namespace {

using testing::clutter;
using ::testing::Each;
using testing::makeRoom;
using testing::removeAllButBoxes;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kLaserHeight_m = 0.37;

/// Distance to the first solid along a ray, by ODE's own collision of rays with primitives.
class OdeRays {
public:
  explicit OdeRays(const World& world) {
    dInitODE2(0);
    space_ = dSimpleSpaceCreate(nullptr);
    for (const Solid& solid : world.solids) add(solid);
    dCreatePlane(space_, 0, 0, 1, 0);
    ray_ = dCreateRay(nullptr, 1000.0);
    dGeomRaySetClosestHit(ray_, 1);
  }
  ~OdeRays() {
    dGeomDestroy(ray_);
    dSpaceDestroy(space_);
  }
  OdeRays(const OdeRays&) = delete;
  OdeRays& operator=(const OdeRays&) = delete;

  double cast(const Ray& ray) {
    const Eigen::Vector3d o = ray.origin_m.cast<double>();
    const Eigen::Vector3d d = ray.direction.cast<double>();
    dGeomRaySet(ray_, o.x(), o.y(), o.z(), d.x(), d.y(), d.z());
    double nearest_m = std::numeric_limits<double>::infinity();
    dSpaceCollide2(ray_, reinterpret_cast<dGeomID>(space_), &nearest_m,
                   [](void* result, dGeomID a, dGeomID b) {
                     dContactGeom contact;
                     double& nearest = *static_cast<double*>(result);
                     if (dCollide(a, b, 1, &contact, sizeof(contact)) > 0)
                       nearest = std::min<double>(nearest, contact.depth);
                   });
    return nearest_m;
  }

private:
  void add(const Solid& solid) {
    const Eigen::Vector3d& size = solid.size_m;
    const dGeomID geom =
        solid.shape == Shape::kBox        ? dCreateBox(space_, size.x(), size.y(), size.z())
        : solid.shape == Shape::kCylinder ? dCreateCylinder(space_, 0.5 * size.x(), size.z())
                                          : dCreateSphere(space_, 0.5 * size.x());
    const Eigen::Vector3d p = solid.world_from_solid.translation();
    const Eigen::Quaterniond q(solid.world_from_solid.linear());
    const dQuaternion quaternion = {q.w(), q.x(), q.y(), q.z()};
    dGeomSetPosition(geom, p.x(), p.y(), p.z());
    dGeomSetQuaternion(geom, quaternion);
  }

  dSpaceID space_;
  dGeomID ray_;
};

/// Share of the rays on which the two differ by more than a millimetre, `count` rays all over.
double shareThatDiffers(const World& world, int count) {
  const RayCaster caster(world);
  OdeRays reference(world);
  const Eigen::AlignedBox3d bounds = boundsOf(world);
  Random random(9, Stream::kRange);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const double yaw_rad = random.uniform(-M_PI, M_PI);
    const double slope = random.uniform(-0.05, 0.05);
    Ray ray;
    ray.origin_m =
        Eigen::Vector3d(random.uniform(bounds.min().x(), bounds.max().x()),
                        random.uniform(bounds.min().y(), bounds.max().y()), kLaserHeight_m)
            .cast<float>();
    ray.direction =
        Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), slope).normalized().cast<float>();
    rays.push_back(ray);
  }
  const std::vector<float> found = caster.cast(rays);
  int different = 0;
  int compared = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double truth_m = reference.cast(rays[i]);
    if (truth_m > 30.0) continue;  // beyond any lidar; ODE's floor has no end
    ++compared;
    if (std::abs(static_cast<double>(found[i]) - truth_m) > 1e-3) ++different;
  }
  EXPECT_GT(compared, count / 2);
  return static_cast<double>(different) / compared;
}

TEST(RayCaster, AgreesWithOdesRaysInARoom) {
  EXPECT_EQ(shareThatDiffers(makeRoom(8.0, 5.0), 100000), 0.0);
}

TEST(RayCaster, AgreesWithOdesRaysInAnOffice) {
  World office = generateOffice({}).world;
  // Rays that graze a round bin meet it or do not.
  EXPECT_LT(shareThatDiffers(office, 10000), 1e-3);
  removeAllButBoxes(office);
  EXPECT_EQ(shareThatDiffers(office, 10000), 0.0);
}

TEST(RayCaster, AgreesWithOdesRaysAmongEveryShape) {
  EXPECT_LT(shareThatDiffers(clutter(), 30000), 5e-3);
}

TEST(RayCaster, FindsNothingWhereThereIsNothing) {
  const RayCaster empty{World()};
  EXPECT_THAT(empty.cast(std::vector<Ray>(17, Ray{{0, 0, 1}, {1, 0, 0}})), Each(kInfinity));
}

TEST(RayCaster, DirectionsAlongAnAxisButForRoundingMissNothing) {
  const RayCaster caster(makeRoom(20.0, 10.0), InstructionSet::kAvx512);
  for (const float tiny : {0.0F, -0.0F, 1e-19F, -1e-19F, -9e-20F, 6e-22F, -1e-39F}) {
    std::vector<Ray> rays;
    for (int i = -8; i < 8; ++i) {
      const float bearing_rad = 0.004F * static_cast<float>(i);
      rays.push_back({{10.2F, 5.0F, 0.37F}, {std::cos(bearing_rad), std::sin(bearing_rad), tiny}});
    }
    rays[8].direction.y() = -tiny;
    EXPECT_NEAR(caster.cast(rays)[8], 9.8, 1e-5) << tiny;
    for (Ray& ray : rays) ray.direction.z() = -ray.direction.y() * 1e-18F;
    EXPECT_THAT(caster.cast(rays), Each(::testing::Le(9.9F))) << tiny;
  }
}

TEST(RayCaster, GrazingRaysEndWhereTheSurfaceIs) {
  // A wall at 30 degrees, 60 m from the origin, whose corners single precision rounds.
  const double wall_yaw_rad = M_PI / 6.0;
  const Eigen::Vector2d along(std::cos(wall_yaw_rad), std::sin(wall_yaw_rad));
  const Eigen::Vector2d across(-along.y(), along.x());
  const Eigen::Vector2d begin(61.237, 17.913);
  World world;
  world.solids = {makeWall(begin, begin + 20.0 * along, 0.1, 2.0)};
  const RayCaster caster(world);
  for (const double angle_rad : {1e-3, 2e-3, 1e-2, 0.1}) {
    for (const double height_m : {0.31, 0.37, 0.43}) {
      // From 5 mm beside its face, which a ray from there meets 5 mm / sin(angle) further on.
      const Eigen::Vector2d from = begin + 1.0 * along - 0.055 * across;
      const Eigen::Vector2d to =
          Eigen::Rotation2Dd(wall_yaw_rad + angle_rad) * Eigen::Vector2d::UnitX();
      Ray ray;
      ray.origin_m = Eigen::Vector3d(from.x(), from.y(), height_m).cast<float>();
      ray.direction = Eigen::Vector3d(to.x(), to.y(), 0.0).cast<float>();
      const Rays rays(std::vector<Ray>(1, ray));
      const Eigen::Vector2d exact_from(rays.origins_m(0, 0), rays.origins_m(0, 1));
      const Eigen::Vector2d exact_to(rays.directions(0, 0), rays.directions(0, 1));
      const double expected_m =
          across.dot(begin - 0.05 * across - exact_from) / across.dot(exact_to);
      EXPECT_NEAR(caster.cast(rays)[0], expected_m, 5e-5) << angle_rad;
    }
  }
}

/// Rays from all around to points on a line.
std::vector<Ray> aimedAt(const Eigen::Vector3d& begin_m, const Eigen::Vector3d& end_m, int count) {
  Random random(5, Stream::kRange);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d target_m = begin_m + random.uniform() * (end_m - begin_m);
    const Eigen::AngleAxisd around(random.uniform(-M_PI, M_PI), Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d from_m =
        target_m + around * Eigen::Vector3d(random.uniform(5.0, 20.0), 0.0, 0.0);
    Ray ray;
    ray.origin_m = from_m.cast<float>();
    ray.direction = (target_m - ray.origin_m.cast<double>()).normalized().cast<float>();
    rays.push_back(ray);
  }
  return rays;
}

TEST(RayCaster, NoRaySlipsIntoABoxThroughAnEdge) {
  Solid box;
  box.size_m = {6.0, 0.7, 2.0};
  box.world_from_solid = toIsometry({31.7, 12.3, 0.4});
  box.world_from_solid.pretranslate(Eigen::Vector3d(0.0, 0.0, 1.0));
  World world;
  world.solids = {box};
  const RayCaster caster(world);
  const std::vector<Ray> rays =
      aimedAt(box.world_from_solid * Eigen::Vector3d(-3.0, -0.35, -0.9),
              box.world_from_solid * Eigen::Vector3d(-3.0, -0.35, 0.9), 300000);
  const std::vector<float> found_m = caster.cast(rays);
  int hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::optional<Hit> entry = intersect(rays[i], box);
    if (!entry) continue;
    Ray inside = rays[i];
    inside.origin_m += (entry->distance_m + 1e-4F) * inside.direction;
    const std::optional<Hit> exit = intersect(inside, box);
    if (!exit || exit->distance_m < 0.01F) continue;  // cuts the edge: may pass as well
    if (std::abs(inside.direction.dot(entry->normal)) < 0.01F) continue;
    ++hits;
    ASSERT_NEAR(found_m[i], entry->distance_m, 1e-3) << i;
  }
  EXPECT_GT(hits, 100000);
}

TEST(RayCaster, NoRaySlipsBetweenBoxesEndToEnd) {
  World world;
  world.solids = {makeWall({-3.0, 8.1}, {1.3, 8.1}, 0.2, 2.0),
                  makeWall({1.3, 8.1}, {4.9, 8.1}, 0.2, 2.0)};
  const RayCaster caster(world);
  const std::vector<Ray> rays = aimedAt({1.3, 8.0, 0.1}, {1.3, 8.0, 1.9}, 300000);
  const std::vector<float> found_m = caster.cast(rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays[i].direction.y() < 0.1F) continue;  // from behind, or along the wall
    const float to_face_m = (8.0F - rays[i].origin_m.y()) / rays[i].direction.y();
    ASSERT_NEAR(found_m[i], to_face_m, 1e-3) << i;
  }
}

}  // namespace
}  // namespace ramscout_sim
