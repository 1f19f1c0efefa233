// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/checkpoint.hpp"

#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "ram_slam/world_map/world_map_file.hpp"

#include "../world_map/example_world.hpp"

namespace ram_slam {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

Checkpoint example() {
  Checkpoint checkpoint;
  checkpoint.map.stamp_ns = 40;
  for (const LandmarkId id : {3U, 8U}) {
    LandmarkEstimate landmark;
    landmark.id = id;
    landmark.type = "corner";
    landmark.classifier = std::string("pg1:\0:x", 7);
    landmark.mean_m = {1.5 * id, -2.0};
    landmark.covariance_m2 << 4e-4, 1e-4, 1e-4, 2e-4;
    landmark.existence_log_odds = 3.5;
    landmark.orientation_rad = -0.7;
    landmark.orientation_variance_rad2 = 0.02;
    landmark.placed_ns = 10 * static_cast<std::int64_t>(id);
    checkpoint.map.landmarks.push_back(landmark);
  }
  checkpoint.path = {{10, {0.0, 0.0, 0.0}}, {30, {1.0, 0.1, 0.2}}, {40, {1.5, 0.2, 0.3}}};
  return checkpoint;
}

void expectRefused(const std::string& bytes, const std::string& reason) {
  EXPECT_THAT([&] { checkpointFromBytes(bytes); },
              ThrowsMessage<std::runtime_error>(HasSubstr(reason)));
}

TEST(Checkpoint, ComesBackAsItWas) {
  const Checkpoint from = example();
  const Checkpoint to = checkpointFromBytes(toBytes(from));
  EXPECT_EQ(to.map.stamp_ns, 40);
  EXPECT_FALSE(to.isLost());
  ASSERT_EQ(to.map.landmarks.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const LandmarkEstimate& a = from.map.landmarks[i];
    const LandmarkEstimate& b = to.map.landmarks[i];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.type, b.type);
    EXPECT_EQ(a.classifier, b.classifier);
    EXPECT_EQ(a.mean_m, b.mean_m);
    EXPECT_EQ(a.covariance_m2, b.covariance_m2);
    EXPECT_EQ(a.existence_log_odds, b.existence_log_odds);
    EXPECT_NEAR(a.orientation_rad, b.orientation_rad, 1e-12);
    EXPECT_EQ(a.orientation_variance_rad2, b.orientation_variance_rad2);
    EXPECT_EQ(a.placed_ns, b.placed_ns);
  }
  ASSERT_EQ(to.path.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(to.path[i].stamp_ns, from.path[i].stamp_ns);
    EXPECT_EQ(to.path[i].pose.x_m, from.path[i].pose.x_m);
    EXPECT_EQ(to.path[i].pose.yaw_rad, from.path[i].pose.yaw_rad);
  }
}

TEST(Checkpoint, StatesThatTheRobotWasLost) {
  Checkpoint checkpoint = example();
  checkpoint.path.pop_back();
  EXPECT_TRUE(checkpointFromBytes(toBytes(checkpoint)).isLost());
}

TEST(Checkpoint, RefusesWhatIsNone) {
  const std::string good = toBytes(example());
  expectRefused("", "not a world map");
  expectRefused("P5 3 3 255", "not a world map");
  expectRefused(good.substr(0, good.size() / 2), "cut short");
  std::string damaged = good;
  damaged[good.size() / 2] = static_cast<char>(damaged[good.size() / 2] ^ 1);
  expectRefused(damaged, "damaged");
  std::string of_another_version = good;
  of_another_version[8] = 0;
  expectRefused(of_another_version, "version 0");
  WorldMap world;
  world.put(occupancyAt(poseAt(0.0, 0.0), 5, "map"));
  expectRefused(toBytes(world), "stored world");
  expectRefused(toBytes(WorldMap()), "no reading");
  Checkpoint impossible = example();
  impossible.map.stamp_ns = 35;
  expectRefused(toBytes(impossible), "goes on after");
}

TEST(Checkpoint, KeepsTheEndsOfAPathAndItsTurns) {
  Trajectory path;
  for (int i = 0; i <= 100; ++i) path.push_back({i + 1, {0.03 * i, 0.0, 0.0}});  // 3 m
  for (int i = 0; i < 50; ++i) path.push_back({i + 200, {3.0, 0.0, 0.02 * i}});  // 1 rad
  for (int i = 0; i < 50; ++i) path.push_back({i + 300, {3.0, 0.0, 0.98}});      // at rest
  const Trajectory kept = thinned(path, {0.1, 0.1});
  EXPECT_EQ(kept.front().stamp_ns, 1);
  EXPECT_EQ(kept.back().stamp_ns, 349);
  EXPECT_LT(kept.size(), 45U);
  for (const StampedPose2& pose : path) {
    const Pose2 there = *poseAt(kept, pose.stamp_ns);
    EXPECT_NEAR(there.x_m, pose.pose.x_m, 0.1);
    EXPECT_NEAR(there.yaw_rad, pose.pose.yaw_rad, 0.1);
  }
  EXPECT_TRUE(thinned({}, {0.1, 0.1}).empty());
}

}  // namespace
}  // namespace ram_slam
