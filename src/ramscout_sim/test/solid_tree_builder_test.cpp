// SPDX-License-Identifier: BSD-3-Clause
#include "solid_tree_builder.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include <gtest/gtest.h>

#include "ramscout_sim/random.hpp"

namespace ramscout_sim {
namespace {

using Node = SolidTree::Node;

/// The floor and `count` boxes at random places.
std::vector<Solid> scattered(int count) {
  Random random(7, Stream::kBuilding);
  std::vector<Solid> solids(1);
  for (int i = 0; i < count; ++i) {
    Solid box;
    box.size_m = {random.uniform(0.1, 2.0), random.uniform(0.1, 2.0), random.uniform(0.1, 3.0)};
    box.world_from_solid =
        Eigen::Translation3d(random.uniform(-50.0, 50.0), random.uniform(-50.0, 50.0), 1.0) *
        Eigen::AngleAxisd(random.uniform(-3.0, 3.0), Eigen::Vector3d::UnitZ());
    solids.push_back(box);
  }
  return solids;
}

Eigen::AlignedBox3d boundsOfChild(const Node& node, std::size_t i) {
  return {Eigen::Vector3d(node.bounds_m[0][i], node.bounds_m[2][i], node.low_z_m[i]),
          Eigen::Vector3d(node.bounds_m[1][i], node.bounds_m[3][i], node.high_z_m[i])};
}

bool isThere(const Node& node, std::size_t i) {
  return node.low_z_m[i] <= node.high_z_m[i];
}

/// Calls `use(solid, bounds)` for every leaf below a node. \return the depth of the tree
int visit(const std::vector<Node>& nodes,
          std::size_t index,
          const std::function<void(std::int32_t, const Eigen::AlignedBox3d&)>& use) {
  int depth = 0;
  for (std::size_t i = 0; i < SolidTree::kChildren; ++i) {
    if (!isThere(nodes.at(index), i)) continue;
    const std::int32_t child = nodes[index].child[i];
    if (child < 0)
      use(~child, boundsOfChild(nodes[index], i));
    else
      depth = std::max(depth, visit(nodes, static_cast<std::size_t>(child), use));
  }
  return depth + 1;
}

TEST(BuildNodes, EverySolidButTheFloorIsOneLeaf) {
  for (const int count : {1, 2, 16, 17, 300}) {
    std::multiset<std::int32_t> found;
    visit(buildNodes(scattered(count)), 0,
          [&found](std::int32_t solid, const auto&) { found.insert(solid); });
    std::multiset<std::int32_t> expected;
    for (int i = 1; i <= count; ++i) expected.insert(i);
    EXPECT_EQ(found, expected) << count;
  }
}

TEST(BuildNodes, ALeafHoldsItsSolidWithRoomForRounding) {
  const std::vector<Solid> solids = scattered(200);
  visit(buildNodes(solids), 0, [&](std::int32_t solid, const Eigen::AlignedBox3d& leaf) {
    const Eigen::AlignedBox3d exact = boundsOf(solids[static_cast<std::size_t>(solid)]);
    EXPECT_TRUE(leaf.contains(exact));
    EXPECT_LT((leaf.sizes() - exact.sizes()).maxCoeff(), 1e-3);
  });
}

TEST(BuildNodes, ANodeHoldsAllItsChildren) {
  const std::vector<Node> nodes = buildNodes(scattered(300));
  for (const Node& node : nodes) {
    for (std::size_t i = 0; i < SolidTree::kChildren; ++i) {
      if (!isThere(node, i) || node.child[i] < 0) continue;
      const Node& child = nodes[static_cast<std::size_t>(node.child[i])];
      for (std::size_t k = 0; k < SolidTree::kChildren; ++k) {
        if (!isThere(child, k)) continue;
        EXPECT_TRUE(boundsOfChild(node, i).contains(boundsOfChild(child, k)));
      }
    }
  }
}

TEST(BuildNodes, AFullTreeIsShallow) {
  // 16 children each: 300 solids need three levels if they are shared out evenly.
  EXPECT_LE(visit(buildNodes(scattered(300)), 0, [](std::int32_t, const auto&) {}), 6);
}

TEST(BuildNodes, SolidsInOnePlaceDoNotMakeADeepTree) {
  std::vector<Solid> solids(1 + 4096);
  const int depth = visit(buildNodes(solids), 0, [](std::int32_t, const auto&) {});
  EXPECT_LE(depth, 30) << "each half gets a quarter of the solids at least";
}

TEST(BuildNodes, AWorldWithoutSolidsHasARootWithoutChildren) {
  const std::vector<Node> nodes = buildNodes(std::vector<Solid>(1));
  ASSERT_EQ(nodes.size(), 1U);
  for (std::size_t i = 0; i < SolidTree::kChildren; ++i) EXPECT_FALSE(isThere(nodes[0], i));
}

TEST(BuildNodes, TheSameSolidsGiveTheSameTree) {
  const std::vector<Node> first = buildNodes(scattered(100));
  const std::vector<Node> second = buildNodes(scattered(100));
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].child, second[i].child);
}

TEST(OverlapOf, IsAboveTheSpacingOfSinglePrecisionAtTheFarthestSolid) {
  for (const double away_m : {0.0, 10.0, 1e3, 1e5}) {
    std::vector<Solid> solids(2);
    solids[1].world_from_solid.translation().y() = -away_m;
    const float at_m = static_cast<float>(away_m);
    const double spacing_m = std::nextafter(at_m, 2e5F) - at_m;
    EXPECT_GT(overlapOf(solids), spacing_m) << away_m;
    EXPECT_LT(overlapOf(solids), 4.0 * spacing_m + 3e-6) << away_m;
  }
}

TEST(BodyOf, AnUprightBoxIsKeptWithItsYawAndTheOverlap) {
  Solid box;
  box.size_m = {2.0, 1.0, 0.5};
  box.world_from_solid =
      Eigen::Translation3d(3.0, 4.0, 5.0) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ());
  const SolidTree::Body body = bodyOf(box, 0.01);
  EXPECT_TRUE(body.upright_box);
  EXPECT_FLOAT_EQ(body.x_m, 3.0F);
  EXPECT_FLOAT_EQ(body.y_m, 4.0F);
  EXPECT_FLOAT_EQ(body.z_m, 5.0F);
  EXPECT_FLOAT_EQ(body.cos_yaw, std::cos(0.5F));
  EXPECT_FLOAT_EQ(body.sin_yaw, std::sin(0.5F));
  EXPECT_FLOAT_EQ(body.half_x_m, 1.01F);
  EXPECT_FLOAT_EQ(body.half_y_m, 0.51F);
  EXPECT_FLOAT_EQ(body.half_z_m, 0.26F);
}

TEST(BodyOf, AllElseIsACircleThatHoldsIt) {
  Solid tilted;
  tilted.size_m = {2.0, 1.0, 0.5};
  tilted.world_from_solid.rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()));
  Solid cylinder;
  cylinder.shape = Shape::kCylinder;
  cylinder.size_m = {0.4, 0.4, 2.0};
  for (const Solid& solid : {tilted, cylinder}) {
    const SolidTree::Body body = bodyOf(solid, 0.0);
    EXPECT_FALSE(body.upright_box);
    EXPECT_GE(body.half_x_m, 0.5 * boundsOf(solid).sizes().norm());
  }
}

}  // namespace
}  // namespace ramscout_sim
