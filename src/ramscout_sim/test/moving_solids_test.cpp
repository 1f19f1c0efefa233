// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/moving_solids.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace ramscout_sim {
namespace {

Solid at(Shape shape, double x_m, const Eigen::Vector3d& size_m) {
  Solid solid;
  solid.shape = shape;
  solid.size_m = size_m;
  solid.world_from_solid.translate(Eigen::Vector3d(x_m, 0.0, 0.0));
  return solid;
}

const Ray kAlongX = {Eigen::Vector3f::Zero(), Eigen::Vector3f::UnitX()};

TEST(Intersect, MeetsTheNearFaceOfEachShapeHeadOn) {
  for (const Shape shape : {Shape::kBox, Shape::kCylinder, Shape::kSphere}) {
    const auto hit = intersect(kAlongX, at(shape, 5.0, {2.0, 2.0, 2.0}));
    ASSERT_TRUE(hit);
    EXPECT_FLOAT_EQ(hit->distance_m, 4.0F);
    EXPECT_TRUE(hit->normal.isApprox(-Eigen::Vector3f::UnitX(), 1e-6F));
  }
}

TEST(Intersect, LeavesFromInsideAtTheFarFace) {
  for (const Shape shape : {Shape::kBox, Shape::kCylinder, Shape::kSphere}) {
    const auto hit = intersect(kAlongX, at(shape, 0.5, {2.0, 2.0, 2.0}));
    ASSERT_TRUE(hit);
    EXPECT_FLOAT_EQ(hit->distance_m, 1.5F);
    EXPECT_TRUE(hit->normal.isApprox(Eigen::Vector3f::UnitX(), 1e-6F));
  }
}

TEST(Intersect, MissesWhatIsBehindBesideOrAMesh) {
  EXPECT_FALSE(intersect(kAlongX, at(Shape::kBox, -5.0, {2.0, 2.0, 2.0})));
  Solid beside = at(Shape::kCylinder, 5.0, {2.0, 2.0, 2.0});
  beside.world_from_solid.translate(Eigen::Vector3d(0.0, 1.01, 0.0));
  EXPECT_FALSE(intersect(kAlongX, beside));
  EXPECT_FALSE(intersect(kAlongX, at(Shape::kMesh, 5.0, {2.0, 2.0, 2.0})));
}

TEST(Intersect, MeetsTheCornerOfATurnedBox) {
  Solid box = at(Shape::kBox, 5.0, {2.0, 2.0, 2.0});
  box.world_from_solid.rotate(Eigen::AngleAxisd(M_PI_4, Eigen::Vector3d::UnitZ()));
  const auto hit = intersect(kAlongX, box);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance_m, 5.0 - std::sqrt(2.0), 1e-5);
}

TEST(CastMoving, ShortensRangesWithinTheWindowOnly) {
  const Rays rays(std::vector<Ray>(4, kAlongX));
  const std::vector<Solid> solids = {at(Shape::kSphere, 5.0, {2.0, 2.0, 2.0})};
  std::vector<float> ranges_m = {9.0F, 9.0F, 3.0F, 9.0F};
  castMoving(rays, solids, {{0, 1, 3}}, ranges_m);
  EXPECT_EQ(ranges_m, (std::vector<float>{9.0F, 4.0F, 3.0F, 9.0F}));
}

TEST(TraceMoving, ReplacesFartherHitsByTheSolidWithItsMaterial) {
  const Rays rays(std::vector<Ray>(2, kAlongX));
  Solid solid = at(Shape::kBox, 5.0, {2.0, 2.0, 2.0});
  solid.material = 3;
  std::vector<Hit> hits(2);
  hits[0].distance_m = 2.0F;
  hits[1].distance_m = 7.0F;
  traceMoving(rays, {solid}, {{0, 0, 2}}, hits);
  EXPECT_EQ(hits[0].distance_m, 2.0F);
  EXPECT_EQ(hits[1].distance_m, 4.0F);
  EXPECT_EQ(hits[1].material, 3U);
}

}  // namespace
}  // namespace ramscout_sim
