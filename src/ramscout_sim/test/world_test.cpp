// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/world.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace ramscout_sim {
namespace {

TEST(MakeWall, StandsOnTheFloorWithItsThicknessCentredOnTheLine) {
  const Eigen::AlignedBox3d bounds = boundsOf(makeWall({1.0, 2.0}, {1.0, 5.0}, 0.2, 2.5));
  EXPECT_TRUE(bounds.min().isApprox(Eigen::Vector3d(0.9, 2.0, 0.0), 1e-9));
  EXPECT_TRUE(bounds.max().isApprox(Eigen::Vector3d(1.1, 5.0, 2.5), 1e-9));
}

TEST(MakeRamp, HasItsUpperFaceBetweenTheTwoEnds) {
  const Solid ramp = makeRamp({1.0, 0.0}, {5.0, 0.0}, 2.0, 3.0, 0.1);
  EXPECT_TRUE(ramp.drivable);
  EXPECT_NEAR(ramp.size_m.x(), 5.0, 1e-12);
  const Eigen::Vector3d low = ramp.world_from_solid * Eigen::Vector3d(-2.5, 0.0, 0.05);
  const Eigen::Vector3d high = ramp.world_from_solid * Eigen::Vector3d(2.5, 0.0, 0.05);
  EXPECT_TRUE(low.isApprox(Eigen::Vector3d(1.0, 0.0, 0.0), 1e-9));
  EXPECT_TRUE(high.isApprox(Eigen::Vector3d(5.0, 0.0, 3.0), 1e-9));
}

TEST(BoundsOf, HoldTheCornersOfATurnedBox) {
  Solid box;
  box.world_from_solid.rotate(Eigen::AngleAxisd(M_PI_4, Eigen::Vector3d::UnitZ()));
  EXPECT_NEAR(boundsOf(box).max().x(), std::sqrt(0.5), 1e-12);
}

TEST(BoundsOf, AreTheUnitBoxForAnEmptyWorld) {
  EXPECT_TRUE(boundsOf(World()).sizes().isApprox(Eigen::Vector3d::Ones()));
}

TEST(BoundsOf, HoldAllSolidsOfAWorld) {
  World world;
  world.solids = {makeWall({0.0, 0.0}, {4.0, 0.0}, 0.2, 2.0),
                  makeWall({10.0, 0.0}, {10.0, 6.0}, 0.2, 3.0)};
  EXPECT_TRUE(boundsOf(world).min().isApprox(Eigen::Vector3d(0.0, -0.1, 0.0), 1e-9));
  EXPECT_TRUE(boundsOf(world).max().isApprox(Eigen::Vector3d(10.1, 6.0, 3.0), 1e-9));
}

TEST(StandardMaterials, BeginWithTheOneThatSolidsAreOf) {
  const auto materials = standardMaterials();
  EXPECT_EQ(materials[Solid().material].name, "plaster");
  for (const Material& material : materials) {
    EXPECT_EQ(material.surface == Surface::kGlass, material.name == "glass");
    EXPECT_EQ(material.surface == Surface::kMirror, material.name == "mirror");
  }
}

}  // namespace
}  // namespace ramscout_sim
