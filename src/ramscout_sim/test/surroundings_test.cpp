// SPDX-License-Identifier: BSD-3-Clause
#include "surroundings.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "shared.hpp"

namespace ramscout_sim {
namespace {

/// A ball of 0.2 m as the chassis, in a room of 8 x 5 m.
class SurroundingsTest : public ::testing::Test {
protected:
  static constexpr double kRadius_m = 0.2;

  void moveTo(double x_m, double y_m) {
    center_m_ = {x_m, y_m, 0.5};
    dGeomSetPosition(ball_, x_m, y_m, 0.5);
  }
  std::vector<dContact> contacts(Surroundings& surroundings) const {
    return surroundings.contacts(chassis_, center_m_, kRadius_m);
  }
  static Solid boxAt(double x_m, double y_m) {
    Solid box;
    box.size_m = {0.2, 0.2, 1.0};
    box.world_from_solid.translation() = Eigen::Vector3d(x_m, y_m, 0.5);
    return box;
  }

  WorldHandle ode_{createOdeWorld()};
  SpaceHandle chassis_{dSimpleSpaceCreate(nullptr)};
  dGeomID ball_ = dCreateSphere(chassis_, kRadius_m);
  Eigen::Vector3d center_m_ = Eigen::Vector3d::Zero();
  PhysicsParameters parameters_;
  World room_ = testing::makeRoom(8.0, 5.0);
};

TEST_F(SurroundingsTest, ABallTouchesAWallWithinItsRadius) {
  const Surroundings surroundings(room_, parameters_);
  moveTo(0.21, 2.5);
  EXPECT_FALSE(surroundings.touch(chassis_));
  moveTo(0.19, 2.5);
  EXPECT_TRUE(surroundings.touch(chassis_));
}

TEST_F(SurroundingsTest, AContactHasTheDepthAndTheSurfaceOfTheParameters) {
  Surroundings surroundings(room_, parameters_);
  moveTo(0.15, 2.5);
  const std::vector<dContact> found = contacts(surroundings);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].geom.depth, 0.05, 1e-9);
  EXPECT_EQ(found[0].surface.mu, parameters_.solid_friction);
  EXPECT_EQ(found[0].surface.soft_cfm, parameters_.solid_softness);
}

TEST_F(SurroundingsTest, InACornerBothWallsAreTouched) {
  Surroundings surroundings(room_, parameters_);
  moveTo(0.15, 0.15);
  EXPECT_EQ(contacts(surroundings).size(), 2U);
}

TEST_F(SurroundingsTest, WhatIsOnlySeenIsNotTouched) {
  for (Solid& wall : room_.solids) wall.solid = false;
  Surroundings surroundings(room_, parameters_);
  moveTo(0.15, 2.5);
  EXPECT_FALSE(surroundings.touch(chassis_));
  EXPECT_TRUE(contacts(surroundings).empty());
}

TEST_F(SurroundingsTest, ContactsAppearHoweverSmallTheStepsTowardsAWallAre) {
  Surroundings surroundings(room_, parameters_);
  double first_contact_m = 0.0;
  for (double x_m = 4.0; x_m > 0.0 && first_contact_m == 0.0; x_m -= 1e-3) {
    moveTo(x_m, 2.5);
    if (!contacts(surroundings).empty()) first_contact_m = x_m;
  }
  EXPECT_NEAR(first_contact_m, kRadius_m, 1.1e-3) << "the search must not be left out too long";
}

TEST_F(SurroundingsTest, AfterATeleportTheSearchStartsAgain) {
  Surroundings surroundings(room_, parameters_);
  moveTo(4.0, 2.5);
  EXPECT_TRUE(contacts(surroundings).empty());
  surroundings.forgetWhatIsNear();
  moveTo(7.9, 2.5);
  EXPECT_FALSE(contacts(surroundings).empty());
}

TEST_F(SurroundingsTest, ObstaclesReplaceThoseBeforeThem) {
  Surroundings surroundings(room_, parameters_);
  moveTo(4.0, 2.5);
  surroundings.setObstacles({boxAt(4.2, 2.5)});
  EXPECT_TRUE(surroundings.touch(chassis_));
  EXPECT_EQ(contacts(surroundings).size(), 1U);
  surroundings.setObstacles({boxAt(6.0, 2.5)});
  EXPECT_FALSE(surroundings.touch(chassis_)) << "the same box elsewhere";
  Solid wide = boxAt(6.0, 2.5);
  wide.size_m.x() = 4.0;
  surroundings.setObstacles({wide});
  EXPECT_TRUE(surroundings.touch(chassis_)) << "another shape at the same place";
  surroundings.setObstacles({});
  EXPECT_FALSE(surroundings.touch(chassis_));
}

TEST_F(SurroundingsTest, ContactsAreAtMostAsManyAsTheParametersAllow) {
  parameters_.max_contacts = 3;
  Surroundings surroundings(room_, parameters_);
  moveTo(4.0, 2.5);
  surroundings.setObstacles(std::vector<Solid>(10, boxAt(4.2, 2.5)));
  EXPECT_EQ(contacts(surroundings).size(), 3U);
}

TEST_F(SurroundingsTest, AMeshIsTouchedAtItsTriangles) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices_m = {{3.0F, 0.0F, 0.0F}, {3.0F, 5.0F, 0.0F}, {3.0F, 0.0F, 3.0F}};
  mesh->triangles = {{0, 1, 2}};
  Solid solid;
  solid.shape = Shape::kMesh;
  solid.mesh = mesh;
  World world;
  world.solids = {solid};
  const Surroundings surroundings(world, parameters_);
  moveTo(3.1, 1.0);
  EXPECT_TRUE(surroundings.touch(chassis_));
  moveTo(3.3, 1.0);
  EXPECT_FALSE(surroundings.touch(chassis_));
  moveTo(3.1, 4.8);
  EXPECT_FALSE(surroundings.touch(chassis_)) << "beyond the slanted edge";
}

}  // namespace
}  // namespace ramscout_sim
