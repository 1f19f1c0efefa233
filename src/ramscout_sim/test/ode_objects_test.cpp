// SPDX-License-Identifier: BSD-3-Clause
#include "ode_objects.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>

namespace ramscout_sim {
namespace {

Eigen::Isometry3d examplePose() {
  return Eigen::Translation3d(1.0, -2.0, 0.5) *
         Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -0.5).normalized());
}

MassProperties exampleMass() {
  MassProperties mass;
  mass.mass_kg = 3.0;
  mass.inertia_kgm2 << 0.3, 0.01, 0.02, 0.01, 0.4, 0.03, 0.02, 0.03, 0.5;
  return mass;
}

class OdeObjects : public ::testing::Test {
protected:
  WorldHandle world_{createOdeWorld()};
};

TEST_F(OdeObjects, ABodyIsWhereItsStateIs) {
  const dBodyID body = createBody(world_, exampleMass());
  BodyState state = atRest(examplePose());
  state.velocity_mps = {0.1, 0.2, 0.3};
  state.turn_radps = {-0.3, 0.5, 0.7};
  setState(body, state);
  const BodyState found = stateOf(body);
  EXPECT_TRUE(found.position_m.isApprox(state.position_m, 1e-12));
  EXPECT_TRUE(found.quaternion.isApprox(state.quaternion, 1e-12));
  EXPECT_TRUE(found.velocity_mps.isApprox(state.velocity_mps, 1e-12));
  EXPECT_TRUE(found.turn_radps.isApprox(state.turn_radps, 1e-12));
  EXPECT_LT((rotationOf(body) - examplePose().linear()).norm(), 1e-12);
}

TEST_F(OdeObjects, ABodyAtRestHasNoSpeed) {
  const BodyState state = atRest(examplePose());
  EXPECT_EQ(state.velocity_mps.norm(), 0.0);
  EXPECT_EQ(state.turn_radps.norm(), 0.0);
  EXPECT_NEAR(state.quaternion.norm(), 1.0, 1e-12);
}

TEST_F(OdeObjects, ABodyHasItsMassAndTheFullInertia) {
  const dBodyID body = createBody(world_, exampleMass());
  dMass mass;
  dBodyGetMass(body, &mass);
  EXPECT_EQ(mass.mass, 3.0);
  const Eigen::Matrix3d inertia = exampleMass().inertia_kgm2;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      EXPECT_EQ(mass.I[4 * row + column], inertia(row, column)) << row << ", " << column;
  }
}

TEST_F(OdeObjects, GeomsHaveTheSizesOfTheirSolids) {
  const SpaceHandle space(dSimpleSpaceCreate(nullptr));
  Solid solid;
  solid.size_m = {0.5, 0.6, 0.7};
  dVector3 lengths;
  dGeomBoxGetLengths(createGeom(space, solid), lengths);
  EXPECT_TRUE(toEigen(lengths).isApprox(solid.size_m));
  solid.shape = Shape::kCylinder;
  solid.size_m = {0.5, 0.5, 0.7};
  double radius_m = 0.0;
  double length_m = 0.0;
  dGeomCylinderGetParams(createGeom(space, solid), &radius_m, &length_m);
  EXPECT_EQ(radius_m, 0.25);
  EXPECT_EQ(length_m, 0.7);
  solid.shape = Shape::kSphere;
  EXPECT_EQ(dGeomSphereGetRadius(createGeom(space, solid)), 0.25);
  EXPECT_EQ(dSpaceGetNumGeoms(space), 3);
}

TEST_F(OdeObjects, AMeshNeedsDataOfItsOwn) {
  const SpaceHandle space(dSimpleSpaceCreate(nullptr));
  Solid mesh;
  mesh.shape = Shape::kMesh;
  EXPECT_THROW(createGeom(space, mesh), std::logic_error);
}

TEST_F(OdeObjects, AGeomIsPlacedInTheWorldOrRelativeToItsBody) {
  const SpaceHandle space(dSimpleSpaceCreate(nullptr));
  const dGeomID geom = createGeom(space, Solid());
  placeGeom(geom, examplePose());
  EXPECT_LT((toEigen(dGeomGetPosition(geom)) - examplePose().translation()).norm(), 1e-12);

  const dBodyID body = createBody(world_, exampleMass());
  setState(body, atRest(examplePose()));
  dGeomSetBody(geom, body);
  const Eigen::Isometry3d body_from_geom(Eigen::Translation3d(0.1, 0.2, 0.3));
  offsetGeom(geom, body_from_geom);
  const Eigen::Vector3d expected_m = (examplePose() * body_from_geom).translation();
  EXPECT_LT((toEigen(dGeomGetPosition(geom)) - expected_m).norm(), 1e-12);
}

int collisions(dGeomID a, dGeomID b) {
  int count = 0;
  dSpaceCollide2(a, b, &count, [](void* data, dGeomID first, dGeomID second) {
    dContactGeom contact;
    *static_cast<int*>(data) += dCollide(first, second, 1, &contact, sizeof(contact));
  });
  return count;
}

TEST_F(OdeObjects, AStaticSpaceFindsItsSolidsEverywhere) {
  World world;
  for (int i = 0; i < 30; ++i) {
    Solid post;
    post.size_m = {0.1, 0.1, 1.0};
    post.world_from_solid.translation() = Eigen::Vector3d(3.0 * i, -2.0 * i, 0.5);
    world.solids.push_back(post);
  }
  const SpaceHandle space(createStaticSpace(world));
  for (const Solid& solid : world.solids)
    placeGeom(createGeom(space, solid), solid.world_from_solid);
  const GeomHandle probe(dCreateSphere(nullptr, 0.2));
  const auto touching = [&](double x_m, double y_m) {
    dGeomSetPosition(probe, x_m, y_m, 0.5);
    return collisions(probe, reinterpret_cast<dGeomID>(dSpaceID(space)));
  };
  for (int i = 0; i < 30; ++i) EXPECT_EQ(touching(3.0 * i + 0.1, -2.0 * i), 1) << i;
  EXPECT_EQ(touching(1.5, -1.0), 0) << "between two posts";
}

TEST_F(OdeObjects, AHandleThatIsMovedDestroysItsObjectOnce) {
  SpaceHandle first(dSimpleSpaceCreate(nullptr));
  const dSpaceID id = first;
  SpaceHandle second(std::move(first));
  EXPECT_EQ(dSpaceID(second), id);
  EXPECT_EQ(dSpaceID(first), nullptr);  // NOLINT: that it is empty is what is tested
  SpaceHandle third;
  third = std::move(second);
  EXPECT_EQ(dSpaceID(third), id);
}

}  // namespace
}  // namespace ramscout_sim
