// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/correlative_search.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

constexpr double kResolutionM = 0.1;
constexpr double kDeviationM = 0.1;
const Pose2 kMapFromLaser{2.35, -1.15, 0.52};

/// The walls of a room of 6 m x 4 m with a pillar.
std::vector<Eigen::Vector2f> wallsOfRoom() {
  std::vector<Eigen::Vector2f> points;
  for (float along = 0.0F; along <= 1.0F; along += 0.02F) {
    points.emplace_back(6.0F * along, -3.0F);
    points.emplace_back(6.0F * along, 1.0F);
    points.emplace_back(0.0F, 4.0F * along - 3.0F);
    points.emplace_back(6.0F, 4.0F * along - 3.0F);
    points.emplace_back(4.0F + 0.3F * std::cos(6.28F * along), 0.3F * std::sin(6.28F * along));
  }
  return points;
}

/// A part of the walls with noise, as seen from kMapFromLaser.
std::vector<Eigen::Vector2f> query(std::uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Vector2f> points;
  for (const Eigen::Vector2f& point : wallsOfRoom()) {
    const Eigen::Vector2d noise_m(0.03 * random.gaussian(), 0.03 * random.gaussian());
    if (random.uniform() < 0.3)
      points.push_back((kMapFromLaser.inverse() * Eigen::Vector2d(point.cast<double>() + noise_m))
                           .cast<float>());
  }
  return points;
}

/// The best of all shifts by whole cells and angles in the window.
double bestOfAll(const LikelihoodPyramid& pyramid,
                 const std::vector<Eigen::Vector2f>& points,
                 const Pose2& centre,
                 const SearchWindow& window) {
  const int reach = static_cast<int>(std::ceil(window.distance_m / kResolutionM));
  const int angles = static_cast<int>(std::ceil(window.angle_rad / window.angle_step_rad));
  double best = 0.0;
  for (int angle = -angles; angle <= angles; ++angle) {
    for (int row = -reach; row <= reach; ++row) {
      for (int column = -reach; column <= reach; ++column) {
        const Pose2 pose{centre.x_m + column * kResolutionM, centre.y_m + row * kResolutionM,
                         centre.yaw_rad + angle * window.angle_step_rad};
        best = std::max(best, scorePose(pyramid, points, pose));
      }
    }
  }
  return best;
}

class CorrelativeSearch : public testing::TestWithParam<int> {
protected:
  const LikelihoodPyramid pyramid_{wallsOfRoom(), kResolutionM, kDeviationM, GetParam()};
};

TEST_P(CorrelativeSearch, FindsWhatTryingEveryCellAndAngleFinds) {
  const SearchWindow window{1.3, 0.2, 0.05};
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const std::vector<Eigen::Vector2f> points = query(seed);
    const Pose2 centre = kMapFromLaser * Pose2{0.1 * static_cast<double>(seed), -0.7, 0.12};
    const auto found = searchPose(pyramid_, points, centre, window, 0.1);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->score, bestOfAll(pyramid_, points, centre, window), 1e-3);
    EXPECT_NEAR(scorePose(pyramid_, points, found->map_from_laser), found->score, 1e-3);
    EXPECT_LT((found->map_from_laser.translation() - kMapFromLaser.translation()).norm(), 0.15);
    EXPECT_NEAR(found->map_from_laser.yaw_rad, kMapFromLaser.yaw_rad, 0.05);
  }
}

TEST_P(CorrelativeSearch, FindsNothingWhereNothingFits) {
  const std::vector<Eigen::Vector2f> points = query(1);
  const SearchWindow window{0.5, 0.1, 0.05};
  EXPECT_FALSE(searchPose(pyramid_, points, kMapFromLaser, window, 0.999));
  EXPECT_FALSE(searchPose(pyramid_, points, {50.0, 0.0, 0.0}, window, 0.01));
  EXPECT_FALSE(searchPose(pyramid_, {}, kMapFromLaser, window, 0.1));
}

TEST_P(CorrelativeSearch, NothingOutsideTheMapScores) {
  const std::vector<Eigen::Vector2f> points = {{0.0F, 0.0F}};
  EXPECT_GT(scorePose(pyramid_, points, {0.0, 0.0, 0.0}), 0.5);
  for (const Pose2& outside : {Pose2{-1.0, 0.0, 0.0}, Pose2{1e6, 0.0, 0.0}, Pose2{3.0, -5.0, 0.0},
                               Pose2{3.0, 5.0, 0.0}, Pose2{-1e6, 1e6, 0.0}}) {
    EXPECT_EQ(scorePose(pyramid_, points, outside), 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Levels, CorrelativeSearch, testing::Values(1, 2, 5));

TEST(CorrelativeSearch, LeavesOutThePlacesAboutAnExcludedPose) {
  const LikelihoodPyramid pyramid(wallsOfRoom(), kResolutionM, 0.06, 4);
  SearchWindow window;
  window.angle_rad = 0.2;
  const auto best = searchPose(pyramid, query(1), kMapFromLaser, window, 0.0);
  ASSERT_TRUE(best);
  window.excluded = best->map_from_laser;
  window.excluded_gate = {0.2, 0.1};
  const auto other = searchPose(pyramid, query(1), kMapFromLaser, window, 0.0);
  ASSERT_TRUE(other);
  EXPECT_TRUE(
      window.excluded_gate.isExceededBy(best->map_from_laser.inverse() * other->map_from_laser));
  EXPECT_LT(other->score, best->score);
}

}  // namespace
}  // namespace ram_slam
