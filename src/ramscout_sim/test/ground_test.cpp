// SPDX-License-Identifier: BSD-3-Clause
#include "ground.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace ramscout_sim {
namespace {

constexpr double kRadius_m = 0.1;

/// ODE must have been started before spaces are made.
class GroundTest : public ::testing::Test {
protected:
  WorldHandle ode_{createOdeWorld()};
};

/// A world with one solid that wheels can stand on.
World worldWith(Solid solid) {
  solid.drivable = true;
  World world;
  world.solids = {solid};
  return world;
}

Solid platform(double height_m) {
  Solid box;
  box.size_m = {2.0, 2.0, height_m};
  box.world_from_solid.translation() = Eigen::Vector3d(5.0, 0.0, 0.5 * height_m);
  return box;
}

TEST_F(GroundTest, ABallIsAsDeepInTheFloorAsItsRadiusExceedsItsHeight) {
  const Ground ground{World()};
  dContactGeom contact = {};
  ASSERT_TRUE(ground.touch({3.0, -2.0, 0.09}, kRadius_m, contact));
  EXPECT_NEAR(contact.depth, 0.01, 1e-12);
  EXPECT_TRUE(toEigen(contact.normal).isApprox(Eigen::Vector3d::UnitZ()));
  EXPECT_TRUE(toEigen(contact.pos).isApprox(Eigen::Vector3d(3.0, -2.0, -0.01)));
}

TEST_F(GroundTest, ABallInTheAirTouchesNothing) {
  const Ground ground{World()};
  dContactGeom contact = {};
  EXPECT_FALSE(ground.touch({0.0, 0.0, 0.101}, kRadius_m, contact));
  EXPECT_TRUE(ground.touch({0.0, 0.0, 0.0999}, kRadius_m, contact));
}

TEST_F(GroundTest, APlatformCarriesABallAboveTheFloor) {
  const Ground ground(worldWith(platform(0.3)));
  dContactGeom contact = {};
  ASSERT_TRUE(ground.touch({5.0, 0.0, 0.38}, kRadius_m, contact));
  EXPECT_NEAR(contact.depth, 0.02, 1e-9);
  EXPECT_TRUE(toEigen(contact.normal).isApprox(Eigen::Vector3d::UnitZ(), 1e-9));
  EXPECT_FALSE(ground.touch({6.2, 0.0, 0.38}, kRadius_m, contact)) << "beside the platform";
}

TEST_F(GroundTest, TheNormalOfARampIsItsOwn) {
  constexpr double kLength_m = 4.0;
  constexpr double kHeight_m = 1.0;
  const Ground ground(worldWith(makeRamp({0.0, 0.0}, {kLength_m, 0.0}, 2.0, kHeight_m)));
  const double slope_rad = std::atan2(kHeight_m, kLength_m);
  const Eigen::Vector3d normal(-std::sin(slope_rad), 0.0, std::cos(slope_rad));
  const Eigen::Vector3d middle(0.5 * kLength_m, 0.0, 0.5 * kHeight_m);
  dContactGeom contact = {};
  ASSERT_TRUE(ground.touch(middle + 0.095 * normal, kRadius_m, contact));
  EXPECT_NEAR(contact.depth, 0.005, 1e-6);
  EXPECT_LT((toEigen(contact.normal) - normal).norm(), 1e-6);
}

TEST_F(GroundTest, OfFloorAndPlatformTheDeeperContactCounts) {
  const Ground ground(worldWith(platform(0.005)));
  dContactGeom contact = {};
  ASSERT_TRUE(ground.touch({5.0, 0.0, 0.1}, kRadius_m, contact));
  EXPECT_NEAR(contact.depth, 0.005, 1e-9) << "of the platform; the floor is only grazed";
  ASSERT_TRUE(ground.touch({0.0, 0.0, 0.099}, kRadius_m, contact));
  EXPECT_NEAR(contact.depth, 0.001, 1e-12) << "of the floor";
}

TEST_F(GroundTest, SolidsThatAreNotDrivableDoNotCarry) {
  World world;
  world.solids = {platform(0.3)};
  const Ground ground(world);
  dContactGeom contact = {};
  EXPECT_FALSE(ground.touch({5.0, 0.0, 0.38}, kRadius_m, contact));
}

}  // namespace
}  // namespace ramscout_sim
