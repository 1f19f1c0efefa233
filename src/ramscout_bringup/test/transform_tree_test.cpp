// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/transform_tree.hpp"

#include <cmath>

#include <gmock/gmock.h>

namespace ramscout_bringup {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Eigen::Isometry3d pose(double x_m, double y_m, double yaw_rad) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.translate(Eigen::Vector3d(x_m, y_m, 0.0));
  result.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  return result;
}

TEST(TransformTree, FollowsChainsBothWaysAndOverTime) {
  TransformTree tree;
  tree.add("odom", "base_footprint", 100, pose(0.0, 0.0, 0.0), false);
  tree.add("odom", "base_footprint", 200, pose(1.0, 0.0, M_PI_2), false);
  tree.add("/base_footprint", "/base_link", 0, pose(0.0, 0.5, 0.0), true);
  tree.add("base_footprint", "laser", 0, pose(0.2, 0.0, M_PI), true);
  tree.finish();
  const auto odom_from_base = tree.lookup("odom", "base_link", 150);
  ASSERT_TRUE(odom_from_base);
  EXPECT_NEAR(odom_from_base->translation().x(), 0.5 - 0.5 * std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(odom_from_base->translation().y(), 0.5 * std::sqrt(0.5), 1e-12);
  EXPECT_TRUE(tree.lookup("base_link", "odom", 150)->isApprox(odom_from_base->inverse()));
  const auto base_from_laser = tree.lookup("base_link", "laser", 99999);
  ASSERT_TRUE(base_from_laser) << "the part that moves is not in the way";
  EXPECT_TRUE(base_from_laser->isApprox(pose(0.2, -0.5, M_PI)));
  EXPECT_THAT(tree.stamps("odom", "base_link"), ElementsAre(100, 200));
  EXPECT_THAT(tree.stamps("base_link", "laser"), IsEmpty());
}

TEST(TransformTree, KnowsToWhatAFrameIsFixed) {
  TransformTree tree;
  tree.add("world", "chassis", 100, pose(0.0, 0.0, 0.0), false);
  tree.add("world", "chassis", 200, pose(1.0, 0.0, 0.0), false);
  tree.add("chassis", "mast", 0, pose(0.0, 0.0, 0.0), true);
  tree.add("mast", "laser", 0, pose(0.2, 0.0, 0.0), true);
  tree.finish();
  EXPECT_EQ(tree.fixedAncestor("laser"), "chassis");
  EXPECT_EQ(tree.fixedAncestor("unknown"), "unknown");
  EXPECT_EQ(tree.parent("chassis"), "world");
  EXPECT_EQ(tree.parent("world"), "");
}

TEST(TransformTree, DoesNotExtrapolate) {
  TransformTree tree;
  tree.add("odom", "base_link", 100, pose(0.0, 0.0, 0.0), false);
  tree.add("odom", "base_link", 200, pose(1.0, 0.0, 0.0), false);
  tree.finish();
  EXPECT_FALSE(tree.lookup("odom", "base_link", 99));
  EXPECT_FALSE(tree.lookup("odom", "base_link", 201));
  EXPECT_TRUE(tree.lookup("odom", "base_link", 200));
}

TEST(TransformTree, TransformThatIsRepeatedUnchangedHoldsAlways) {
  TransformTree tree;
  for (int i = 0; i < 5; ++i) tree.add("base_link", "laser", i, pose(0.1, 0.0, 0.0), false);
  tree.finish();
  EXPECT_TRUE(tree.isConstant("base_link", "laser"));
  EXPECT_TRUE(tree.lookup("base_link", "laser", 1000));
}

TEST(TransformTree, IgnoresWhatCannotBeAndSaysHowMuch) {
  TransformTree tree;
  tree.add("odom", "base_link", 0, pose(0.0, 0.0, 0.0), false);
  tree.add("other", "base_link", 0, pose(0.0, 0.0, 0.0), false);
  tree.add("a", "a", 0, pose(0.0, 0.0, 0.0), false);
  tree.add("a", "b", 0, pose(std::nan(""), 0.0, 0.0), false);
  tree.finish();
  EXPECT_EQ(tree.ignoredCount(), 3U);
  EXPECT_EQ(tree.frames(), "base_link, odom");
  EXPECT_FALSE(tree.connects("odom", "laser"));
}

TEST(TransformTree, LoopOfFramesEndsTheSearch) {
  TransformTree tree;
  tree.add("a", "b", 0, pose(0.0, 0.0, 0.0), true);
  tree.add("b", "a", 0, pose(0.0, 0.0, 0.0), true);
  tree.finish();
  EXPECT_FALSE(tree.lookup("odom", "a", 0));
}

TEST(TransformTree, TheNewestOfStaticTransformsCounts) {
  TransformTree tree;
  tree.add("base_link", "laser", 5, pose(0.1, 0.0, 0.0), true);
  tree.add("base_link", "laser", 3, pose(0.7, 0.0, 0.0), true);
  tree.finish();
  EXPECT_EQ(tree.lookup("base_link", "laser", 0)->translation().x(), 0.7);
}

TEST(TransformTree, SamplesInAnyOrderAreSortedByStamp) {
  TransformTree tree;
  for (const int i : {3, 0, 4, 1, 2})
    tree.add("odom", "base_link", 100 * i, pose(i, 0.0, 0.1 * i), false);
  tree.finish();
  for (int at = 0; at <= 400; at += 10) {
    const auto found = tree.lookup("odom", "base_link", at);
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->isApprox(pose(0.01 * at, 0.0, 0.001 * at), 1e-9)) << at;
  }
  EXPECT_THAT(tree.stamps("odom", "base_link"), ElementsAre(0, 100, 200, 300, 400));
}

TEST(TransformTree, AFrameSeenFromItselfIsTheIdentity) {
  TransformTree tree;
  EXPECT_EQ(tree.frames(), "none");
  tree.add("a", "b", 0, pose(1.0, 2.0, 3.0), true);
  tree.finish();
  for (const char* frame : {"a", "b", "unknown"})
    EXPECT_TRUE(tree.lookup(frame, frame, 0)->isApprox(Eigen::Isometry3d::Identity())) << frame;
  EXPECT_TRUE(tree.has("a"));
  EXPECT_TRUE(tree.has("/b"));
  EXPECT_FALSE(tree.has("unknown"));
}

}  // namespace
}  // namespace ramscout_bringup
