// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/landmark_tree.hpp"

#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

Landmark landmarkAt(double x_m) {
  return {{x_m, -x_m}, Eigen::Matrix2d::Identity()};
}

void expectEqual(const LandmarkTree& tree, const std::map<LandmarkId, double>& wanted) {
  EXPECT_EQ(tree.size(), wanted.size());
  auto next = wanted.begin();
  tree.forEach([&](LandmarkId id, const Landmark& landmark) {
    ASSERT_NE(next, wanted.end());
    EXPECT_EQ(id, next->first);
    EXPECT_EQ(landmark.mean_m.x(), next->second);
    ++next;
  });
  EXPECT_EQ(next, wanted.end());
}

TEST(LandmarkTree, BehavesAsMapsThatAreCopied) {
  constexpr int kTrees = 8;
  Random random(1);
  std::vector<LandmarkTree> trees(kTrees);
  std::vector<std::map<LandmarkId, double>> maps(kTrees);
  const auto anyTree = [&random] { return static_cast<std::size_t>(random() % kTrees); };
  for (int step = 0; step < 20000; ++step) {
    const std::size_t i = anyTree();
    const LandmarkId id = static_cast<LandmarkId>(random() % 3000);
    switch (random() % 4) {
      case 0: {
        const std::size_t from = anyTree();
        trees[i] = trees[from];
        maps[i] = maps[from];
        break;
      }
      case 1:
        EXPECT_EQ(trees[i].erase(id), maps[i].erase(id) == 1);
        break;
      default:
        trees[i].set(id, landmarkAt(step));
        maps[i][id] = step;
    }
    const Landmark* found = trees[i].find(id);
    EXPECT_EQ(found != nullptr, maps[i].count(id) == 1);
  }
  for (std::size_t i = 0; i < kTrees; ++i) expectEqual(trees[i], maps[i]);
}

TEST(LandmarkTree, TransformingTreesChangesEachLandmarkOnceAndKeepsWhatTheyShare) {
  std::vector<LandmarkTree> trees(3);
  for (LandmarkId id = 0; id < 200; ++id) trees[0].set(id, landmarkAt(id));
  trees[1] = trees[0];
  trees[2] = trees[0];
  trees[1].set(7, landmarkAt(1000.0));
  trees[2].erase(8);
  const auto bytes = [&trees] {
    std::unordered_set<const void*> seen;
    std::size_t sum = 0;
    for (const LandmarkTree& tree : trees) sum += tree.bytes(seen);
    return sum;
  };
  const std::size_t bytes_before = bytes();
  int changes = 0;
  LandmarkTree::transform({&trees[0], &trees[1], &trees[2]},
                          [&changes](LandmarkId, const Landmark& landmark) {
                            ++changes;
                            return landmarkAt(2.0 * landmark.mean_m.x());
                          });
  EXPECT_EQ(bytes(), bytes_before);
  EXPECT_LT(changes, 220);
  std::map<LandmarkId, double> wanted;
  for (LandmarkId id = 0; id < 200; ++id) wanted[id] = 2.0 * id;
  expectEqual(trees[0], wanted);
  std::map<LandmarkId, double> second = wanted;
  second[7] = 2000.0;
  expectEqual(trees[1], second);
  wanted.erase(8);
  expectEqual(trees[2], wanted);
}

TEST(LandmarkTree, ChangingACopyLeavesTheOthersAlone) {
  LandmarkTree original;
  for (LandmarkId id = 0; id < 100; ++id) original.set(id, landmarkAt(id));
  LandmarkTree first = original;
  LandmarkTree second = original;
  first.set(50, landmarkAt(-1.0));
  second.erase(50);
  EXPECT_EQ(original.find(50)->mean_m.x(), 50.0);
  EXPECT_EQ(first.find(50)->mean_m.x(), -1.0);
  EXPECT_EQ(second.find(50), nullptr);
  EXPECT_EQ(second.find(51)->mean_m.x(), 51.0);
}

TEST(LandmarkTree, HundredCopiesWithOneChangeEachTakeLittleMemory) {
  LandmarkTree original;
  for (LandmarkId id = 0; id < 1000; ++id) original.set(id, landmarkAt(id));
  std::vector<LandmarkTree> copies(100, original);
  std::unordered_set<const void*> seen;
  std::size_t shared_bytes = original.bytes(seen);
  for (const LandmarkTree& copy : copies) shared_bytes += copy.bytes(seen);
  std::unordered_set<const void*> alone;
  EXPECT_EQ(shared_bytes, original.bytes(alone));  // copying allocated nothing
  for (LandmarkId id = 0; id < 100; ++id) copies[id].set(10 * id, landmarkAt(0.0));
  std::size_t changed_bytes = 0;
  for (const LandmarkTree& copy : copies) changed_bytes += copy.bytes(seen);
  EXPECT_LT(changed_bytes, 100U * 2000U);  // one path each, not 100 maps of about 80 kB
  EXPECT_GT(changed_bytes, 100U * 200U);
}

}  // namespace
}  // namespace ram_slam
