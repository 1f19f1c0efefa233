// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/path.hpp"

#include <gmock/gmock.h>

#include "ram_slam/fast_slam/particle.hpp"

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

TEST(Path, AtRestDoesNotGrow) {
  Path path;
  for (std::int64_t i = 1; i <= 1000; ++i)
    path.append({i, {0.002 * static_cast<double>(i % 7), 0.0, 0.0}}, {0.05, 0.05});
  EXPECT_EQ(path.size(), 2U) << "the first one and the newest";
  EXPECT_EQ(path.last().stamp_ns, 1000);
}

TEST(Path, KeepsTheLastPoseBeforeItLeavesAStep) {
  Path path;
  for (std::int64_t i = 0; i <= 10; ++i)
    path.append({i, {0.1 * static_cast<double>(i), 0.0, 0.0}}, {0.25, 0.05});
  EXPECT_THAT(placesOf(path),
              testing::Pointwise(testing::DoubleNear(1e-9), {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}));
  path.append({3'600'000, {20.0, 0.0, 0.0}}, {0.25, 0.05});
  EXPECT_NEAR(placesOf(path)[5], 1.0, 1e-9) << "where it was before it was carried away";
}

TEST(Path, KeepsTurnsOnTheSpot) {
  Path path;
  for (std::int64_t i = 0; i <= 10; ++i)
    path.append({i, {0.0, 0.0, 0.03 * static_cast<double>(i)}}, {0.05, 0.05});
  EXPECT_EQ(path.size(), 11U);
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

/// Two particles that drove 1 m per second, the second one beside the first.
std::vector<Particle> drivenFor(std::int64_t seconds) {
  std::vector<Particle> particles(2);
  for (std::int64_t i = 1; i <= seconds; ++i) {
    const auto x_m = static_cast<double>(i);
    particles[0].path.append({i, {x_m, 0.0, 0.0}});
    particles[1].path.append({i, {x_m, 2.0, 0.0}});
  }
  return particles;
}

TEST(LimitPaths, LeavesPathsThatAreShortEnough) {
  std::vector<Particle> particles = drivenFor(100);
  limitPaths(particles, 0, 100);
  EXPECT_EQ(particles[0].path.size(), 100U);
  EXPECT_EQ(particles[1].path.poses().front().pose.y_m, 2.0);
}

TEST(LimitPaths, GivesAllParticlesTheBestOnesPathWithHalfAsManyPoses) {
  std::vector<Particle> particles = drivenFor(101);
  limitPaths(particles, 1, 100);
  for (const Particle& particle : particles) {
    EXPECT_LE(particle.path.size(), 50U);
    EXPECT_GE(particle.path.size(), 40U);
    const auto poses = particle.path.poses();
    EXPECT_EQ(poses.front().stamp_ns, 1);
    EXPECT_EQ(poses.front().pose.y_m, 2.0);
    EXPECT_EQ(poses.back().stamp_ns, 101);
  }
}

TEST(LimitPaths, EachParticleKeepsItsNewestPose) {
  std::vector<Particle> particles = drivenFor(101);
  limitPaths(particles, 1, 100);
  EXPECT_EQ(particles[0].path.last().pose.y_m, 0.0);
  EXPECT_EQ(particles[1].path.last().pose.y_m, 2.0);
}

}  // namespace
}  // namespace ram_slam
