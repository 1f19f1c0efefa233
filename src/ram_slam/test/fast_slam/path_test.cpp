// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/path.hpp"

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

std::vector<double> placesOf(const Path& path) {
  std::vector<double> places_m;
  for (const StampedPose2& pose : path.poses()) places_m.push_back(pose.pose.x_m);
  return places_m;
}

TEST(Path, GivesThePosesOldestFirst) {
  Path path;
  EXPECT_TRUE(path.empty());
  EXPECT_THAT(path.poses(), testing::IsEmpty());
  path.append({1, {0.1, 0.0, 0.0}});
  path.append({2, {0.2, 0.0, 0.0}});
  EXPECT_FALSE(path.empty());
  EXPECT_THAT(placesOf(path), testing::ElementsAre(0.1, 0.2));
}

TEST(Path, ReplacesAPoseOfTheSameStamp) {
  Path path;
  path.append({1, {0.1, 0.0, 0.0}});
  path.append({2, {0.2, 0.0, 0.0}});
  path.append({2, {0.3, 0.0, 0.0}});
  EXPECT_THAT(placesOf(path), testing::ElementsAre(0.1, 0.3));
}

TEST(Path, MovesItsLastPoseOnly) {
  Path path;
  path.moveLast({1.0, 0.0, 0.0});  // there is none yet
  EXPECT_TRUE(path.empty());
  path.append({1, {0.0, 0.0, 0.0}});
  path.append({2, {1.0, 0.0, 0.0}});
  path.moveLast({0.0, 0.5, 0.0});
  const std::vector<StampedPose2> poses = path.poses();
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0].pose.y_m, 0.0);
  EXPECT_EQ(poses[1].pose.y_m, 0.5);
  EXPECT_EQ(poses[1].stamp_ns, 2);
}

TEST(Path, OfACopyDoesNotChangeTheOriginal) {
  Path path;
  path.append({1, {0.1, 0.0, 0.0}});
  Path copy = path;
  copy.append({1, {0.5, 0.0, 0.0}});
  copy.append({2, {0.6, 0.0, 0.0}});
  path.append({2, {0.2, 0.0, 0.0}});
  EXPECT_THAT(placesOf(path), testing::ElementsAre(0.1, 0.2));
  EXPECT_THAT(placesOf(copy), testing::ElementsAre(0.5, 0.6));
}

TEST(Path, OfAMillionPosesIsDestroyedWithoutExhaustingTheStack) {
  constexpr std::int64_t kPoses = 1000000;
  Path kept;
  {
    Path path;
    for (std::int64_t i = 1; i <= kPoses; ++i) {
      path.append({i, {}});
      if (i == 3) kept = path;
    }
    EXPECT_EQ(path.poses().size(), static_cast<std::size_t>(kPoses));
  }
  EXPECT_EQ(kept.poses().size(), 3U) << "what is shared with another path stays";
}

}  // namespace
}  // namespace ram_slam
