// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_scene.hpp"

#include <cmath>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

namespace ramscout_sim {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A square of 4 x 4 m in the plane x = 0 of its own axes, about their origin.
Solid square(const Eigen::Isometry3d& world_from_square, std::size_t material = 0) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices_m = {
      {0.0F, -2.0F, -2.0F}, {0.0F, 2.0F, -2.0F}, {0.0F, 2.0F, 2.0F}, {0.0F, -2.0F, 2.0F}};
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  Solid solid;
  solid.shape = Shape::kMesh;
  solid.mesh = mesh;
  solid.world_from_solid = world_from_square;
  solid.material = material;
  return solid;
}

Solid squareAt(double x_m, std::size_t material = 0) {
  return square(Eigen::Isometry3d(Eigen::Translation3d(x_m, 0.0, 0.0)), material);
}

Ray rayAlong(double bearing_rad, double y_m = 0.0) {
  return {Eigen::Vector3f(0.0F, static_cast<float>(y_m), 0.0F),
          Eigen::Vector3d(std::cos(bearing_rad), std::sin(bearing_rad), 0.0).cast<float>()};
}

constexpr InstructionSet kAllSets[] = {InstructionSet::kSse42, InstructionSet::kAvx,
                                       InstructionSet::kAvx2, InstructionSet::kAvx512};

TEST(MeshScene, ASlantedRayIsAsLongAsItsSecant) {
  for (const InstructionSet set : kAllSets) {
    const MeshScene scene({squareAt(3.0)}, set);
    std::vector<Ray> rays;
    for (int i = 0; i < 21; ++i) rays.push_back(rayAlong(0.05 * (i - 10)));  // no full packet
    std::vector<float> distances_m(rays.size(), kInfinity);
    scene.cast(rays, kInfinity, distances_m);
    for (int i = 0; i < 21; ++i)
      EXPECT_NEAR(distances_m[static_cast<std::size_t>(i)], 3.0 / std::cos(0.05 * (i - 10)), 1e-5);
  }
}

TEST(MeshScene, BothSidesAreHit) {
  const MeshScene scene({squareAt(3.0), squareAt(-2.0)}, InstructionSet::kAvx2);
  std::vector<float> distances_m(2, kInfinity);
  scene.cast(std::vector<Ray>{rayAlong(0.0), rayAlong(M_PI)}, kInfinity, distances_m);
  EXPECT_NEAR(distances_m[0], 3.0, 1e-6);
  EXPECT_NEAR(distances_m[1], 2.0, 1e-6);
}

TEST(MeshScene, OnlyNearerHitsReplaceADistance) {
  const MeshScene scene({squareAt(3.0)}, InstructionSet::kAvx2);
  std::vector<float> distances_m = {1.0F, 5.0F, kInfinity};
  scene.cast(std::vector<Ray>(3, rayAlong(0.0)), kInfinity, distances_m);
  EXPECT_EQ(distances_m[0], 1.0F);
  EXPECT_NEAR(distances_m[1], 3.0, 1e-6);
  EXPECT_NEAR(distances_m[2], 3.0, 1e-6);
}

TEST(MeshScene, WhatIsFartherThanTheLimitIsNotHit) {
  const MeshScene scene({squareAt(3.0)}, InstructionSet::kAvx2);
  std::vector<float> distances_m(1, kInfinity);
  scene.cast(std::vector<Ray>{rayAlong(0.0)}, 2.9F, distances_m);
  EXPECT_EQ(distances_m[0], kInfinity);
}

TEST(MeshScene, RaysBesideTheTrianglesHitNothing) {
  const MeshScene scene({squareAt(3.0)}, InstructionSet::kAvx2);
  std::vector<float> distances_m(2, kInfinity);
  scene.cast(std::vector<Ray>{rayAlong(0.0, 2.01), rayAlong(0.0, 1.99)}, kInfinity, distances_m);
  EXPECT_EQ(distances_m[0], kInfinity);
  EXPECT_NEAR(distances_m[1], 3.0, 1e-6);
}

TEST(MeshScene, ATracedRayHasTheNormalAndTheMaterialOfWhatItHits) {
  const Eigen::Isometry3d turned =
      Eigen::Translation3d(3.0, 0.0, 0.0) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ());
  const MeshScene scene({squareAt(6.0, 1), square(turned, 2)}, InstructionSet::kAvx2);
  std::vector<Hit> hits(1);
  scene.trace(std::vector<Ray>{rayAlong(0.0)}, kInfinity, hits);
  EXPECT_NEAR(hits[0].distance_m, 3.0, 1e-6);
  EXPECT_EQ(hits[0].material, 2U);
  EXPECT_TRUE(hits[0].two_sided);
  const Eigen::Vector3f normal(std::cos(0.5F), std::sin(0.5F), 0.0F);
  EXPECT_NEAR(std::abs(hits[0].normal.dot(normal)), 1.0, 1e-6);
}

TEST(MeshScene, AMissLeavesTheHitAsItWas) {
  const MeshScene scene({squareAt(3.0)}, InstructionSet::kAvx2);
  std::vector<Hit> hits(1);
  hits[0].distance_m = 7.0F;
  hits[0].material = 4;
  scene.trace(std::vector<Ray>{rayAlong(M_PI)}, kInfinity, hits);
  EXPECT_EQ(hits[0].distance_m, 7.0F);
  EXPECT_EQ(hits[0].material, 4U);
  EXPECT_FALSE(hits[0].two_sided);
}

TEST(MeshScene, AGrazingRayEndsInThePlaneOfItsTriangle) {
  // The wall runs along x at y = 0.01 m; rays at half a degree meet it after 1.15 m.
  const Eigen::Isometry3d wall = Eigen::Translation3d(1.5, 0.01, 0.0) *
                                 Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitZ());
  const MeshScene scene({square(wall)}, InstructionSet::kAvx2);
  const double bearing_rad = M_PI / 360.0;
  std::vector<float> distances_m(1, kInfinity);
  scene.cast(std::vector<Ray>{rayAlong(bearing_rad)}, kInfinity, distances_m);
  EXPECT_NEAR(distances_m[0], 0.01 / std::sin(bearing_rad), 2e-6);
}

}  // namespace
}  // namespace ramscout_sim
