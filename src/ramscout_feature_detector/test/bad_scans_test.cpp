// SPDX-License-Identifier: BSD-3-Clause
// What a sensor, a driver or a network may deliver instead of a scan.
#include <algorithm>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "ramscout_feature_detector/edge_detector.hpp"
#include "ramscout_feature_detector/feature_detector.hpp"

#include "polygon_world.hpp"

namespace ramscout_feature_detector {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A room whose four corners a full-turn lidar sees.
ram_slam::LaserScan roomScan(int beams = 720) {
  ram_slam::Random random(1);
  PolygonWorld room;
  room.add({{-2.0, -1.7}, {2.2, -1.7}, {2.2, 1.9}, {-2.0, 1.9}}, true);
  return room.scan({}, 0.005, random, beams, -M_PI, 2.0 * M_PI / beams);
}

std::size_t countFeatures(const ram_slam::LaserScan& scan) {
  return FeatureDetector({}).detect(scan, {}).features.size();
}

std::size_t countEdges(const ram_slam::LaserScan& scan) {
  return EdgeDetector({}).detect(scan, {}).features.size();
}

TEST(BadScans, AGoodOneHasFourCorners) {
  EXPECT_EQ(countFeatures(roomScan()), 4U);
  EXPECT_EQ(countEdges(roomScan()), 4U);
}

TEST(BadScans, ReadingsWithoutMeaningYieldNothing) {
  for (const float value :
       {kNan, kInfinity, -kInfinity, 0.0F, -1.0F, -0.0F, 1e30F, 1e-40F, 0.04F, 31.0F}) {
    auto scan = roomScan();
    std::fill(scan.ranges_m.begin(), scan.ranges_m.end(), value);
    EXPECT_EQ(countFeatures(scan), 0U) << value;
    EXPECT_EQ(countEdges(scan), 0U) << value;
  }
}

TEST(BadScans, AFewReadingsWithoutMeaningTakeAwayAtMostTheirSurroundings) {
  for (const float value : {kNan, kInfinity, -kInfinity, 0.0F, 1e30F}) {
    auto scan = roomScan();
    const auto whole = FeatureDetector({}).detect(scan, {}).features;
    scan.ranges_m[360] = value;
    const auto features = FeatureDetector({}).detect(scan, {}).features;
    EXPECT_EQ(features.size(), whole.size()) << value;
    EXPECT_GE(countEdges(scan), 4U) << value;
    EXPECT_LE(countEdges(scan), 6U) << value;  // of a hole in the wall the two sides
  }
}

TEST(BadScans, RangesAsFarAsFloatsGoOverflowNothing) {
  auto scan = roomScan();
  scan.range_max_m = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < scan.ranges_m.size(); i += 3) scan.ranges_m[i] = 1e30F;
  EXPECT_NO_THROW(countFeatures(scan));
  EXPECT_NO_THROW(countEdges(scan));
}

TEST(BadScans, CirclesAndSingleBeamsAreScansWithoutFeatures) {
  auto scan = roomScan();
  std::fill(scan.ranges_m.begin(), scan.ranges_m.end(), 3.0F);
  EXPECT_EQ(countFeatures(scan), 0U);
  EXPECT_EQ(countEdges(scan), 0U);
  std::fill(scan.ranges_m.begin(), scan.ranges_m.end(), scan.range_max_m);
  EXPECT_EQ(countFeatures(scan), 0U);
  EXPECT_EQ(countEdges(scan), 0U);
  scan.ranges_m.resize(1);
  EXPECT_EQ(countFeatures(scan), 0U);
  EXPECT_EQ(countEdges(scan), 0U);
}

TEST(BadScans, ClockwiseScansShowTheSameWorld) {
  auto scan = roomScan();
  const auto expected = FeatureDetector({}).detect(scan, {}).features;
  std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
  scan.angle_min_rad = scan.bearing_rad(scan.ranges_m.size() - 1);
  scan.angle_increment_rad = -scan.angle_increment_rad;
  const auto features = FeatureDetector({}).detect(scan, {}).features;
  ASSERT_EQ(features.size(), expected.size());
  for (const auto& feature : features) {
    double nearest_m = 1.0;
    for (const auto& other : expected) {
      nearest_m = std::min(nearest_m, (feature.position_m - other.position_m).norm());
    }
    EXPECT_LT(nearest_m, 0.01);
  }
}

TEST(BadScans, AnglesMayBeCountedInAnotherTurnAndTheLastBeamRepeatTheFirst) {
  auto scan = roomScan();
  const auto expected = FeatureDetector({}).detect(scan, {}).features;
  scan.angle_min_rad += 4.0 * M_PI;
  scan.ranges_m.push_back(scan.ranges_m.front());
  const auto features = FeatureDetector({}).detect(scan, {}).features;
  ASSERT_EQ(features.size(), expected.size());
  EXPECT_LT((features[0].position_m - expected[0].position_m).norm(), 1e-3);
  EXPECT_EQ(features[0].classifier, expected[0].classifier);
}

TEST(BadScans, TheSizeMayChangeFromScanToScan) {
  const FeatureDetector detector({});
  for (const int beams : {720, 447, 1440, 461, 3}) {
    EXPECT_NO_THROW(detector.detect(roomScan(beams), {})) << beams;
    EXPECT_NO_THROW(countEdges(roomScan(beams))) << beams;
  }
}

TEST(BadScans, SaltNoiseBoundsTheFeatures) {
  const std::size_t limit = 3 * countFeatures(roomScan());
  for (int seed = 0; seed < 20; ++seed) {
    auto scan = roomScan();
    ram_slam::Random random(seed);
    for (float& range_m : scan.ranges_m) {
      if (random.uniform() < 0.3) range_m = static_cast<float>(30.0 * random.uniform());
    }
    EXPECT_LE(countFeatures(scan), limit);
    EXPECT_LE(countEdges(scan), scan.ranges_m.size() / 10);
  }
}

/// Those farther than 0.1 m from all of the corners.
int countStray(const std::vector<ram_slam::Feature>& features,
               const std::vector<Eigen::Vector2d>& corners_m) {
  return static_cast<int>(std::count_if(features.begin(), features.end(), [&](const auto& feature) {
    return std::none_of(corners_m.begin(), corners_m.end(), [&](const Eigen::Vector2d& corner_m) {
      return (feature.position_m - corner_m).norm() <= 0.1;
    });
  }));
}

int countStrayFeatures(const ram_slam::LaserScan& scan,
                       const std::vector<Eigen::Vector2d>& corners_m) {
  return countStray(FeatureDetector({}).detect(scan, {}).features, corners_m);
}

int countStrayEdges(const ram_slam::LaserScan& scan,
                    const std::vector<Eigen::Vector2d>& corners_m) {
  return countStray(EdgeDetector({}).detect(scan, {}).features, corners_m);
}

TEST(BadScans, MixedPixelsAtTheSidesOfACupboardAreSeldomFeatures) {
  const std::vector<Eigen::Vector2d> room_m = {{-2.0, -1.7}, {3.2, -1.7}, {3.2, 1.9}, {-2.0, 1.9}};
  const std::vector<Eigen::Vector2d> cupboard_m = {
      {1.2, -0.5}, {2.0, -0.5}, {2.0, 0.4}, {1.2, 0.4}};
  PolygonWorld world;
  world.add(room_m, true);
  world.add(cupboard_m, true);
  auto corners_m = room_m;
  corners_m.insert(corners_m.end(), cupboard_m.begin(), cupboard_m.end());
  int mixed = 0;
  int stray = 0;
  int stray_edges = 0;
  for (int seed = 0; seed < 50; ++seed) {
    ram_slam::Random random(seed);
    auto scan = world.scan({}, 0.01, random, 720, -M_PI, 2.0 * M_PI / 720);
    for (std::size_t i = 0; i + 3 < scan.ranges_m.size(); ++i) {
      const float step_m = scan.ranges_m[i + 3] - scan.ranges_m[i];
      if (std::abs(step_m) < 0.5F) continue;
      scan.ranges_m[i + 1] = scan.ranges_m[i] + static_cast<float>(random.uniform()) * step_m;
      scan.ranges_m[i + 2] = scan.ranges_m[i] + static_cast<float>(random.uniform()) * step_m;
      i += 3;
      ++mixed;
    }
    stray += countStrayFeatures(scan, corners_m);
    stray_edges += countStrayEdges(scan, corners_m);
  }
  EXPECT_GE(mixed, 100);
  EXPECT_LE(stray, mixed / 20);
  EXPECT_LE(stray_edges, mixed / 10);
}

const std::vector<Eigen::Vector2d> kRoomCornersM = {
    {-2.0, -1.7}, {2.2, -1.7}, {2.2, 1.9}, {-2.0, 1.9}};

/// A pane in one wall that half of the beams pass: they see what stands behind, or mirror images.
ram_slam::LaserScan glassScan(int seed) {
  PolygonWorld room;
  room.add(kRoomCornersM, true);
  ram_slam::Random random(seed);
  auto scan = room.scan({}, 0.01, random, 720, -M_PI, 2.0 * M_PI / 720);
  for (std::size_t i = 320; i < 400; ++i) {
    if (random.uniform() < 0.5) {
      scan.ranges_m[i] += 1.0F + 2.0F * static_cast<float>(random.uniform());
    }
  }
  return scan;
}

TEST(BadScans, GlassThatSomeBeamsPassIsNoFeature) {
  for (int seed = 0; seed < 50; ++seed) {
    EXPECT_EQ(countStrayFeatures(glassScan(seed), kRoomCornersM), 0) << seed;
  }
}

/// What half of the beams pass is a fence to the edge detector, of as many small things as it
/// shows.
TEST(BadScans, GlassThatSomeBeamsPassHidesNoEdgesAndAddsFew) {
  constexpr int kScans = 50;
  int stray = 0;
  for (int seed = 0; seed < kScans; ++seed) {
    const auto features = EdgeDetector({}).detect(glassScan(seed), {}).features;
    for (const Eigen::Vector2d& corner_m : kRoomCornersM) {
      EXPECT_LT(countStray(features, {corner_m}), static_cast<int>(features.size())) << seed;
    }
    stray += countStray(features, kRoomCornersM);
  }
  EXPECT_LE(stray, 10 * kScans);
}

TEST(BadScans, UnusableScansAreRefused) {
  const auto refused = [](auto&& change) {
    auto scan = roomScan();
    change(scan);
    EXPECT_THROW(countFeatures(scan), std::invalid_argument);
    EXPECT_THROW(countEdges(scan), std::invalid_argument);
  };
  refused([](auto& scan) { scan.ranges_m.clear(); });
  refused([](auto& scan) { scan.ranges_m.resize(1000000); });
  refused([](auto& scan) { scan.angle_increment_rad = 0.0; });
  refused([](auto& scan) { scan.angle_increment_rad = 1e-9; });
  refused([](auto& scan) { scan.angle_increment_rad = std::nan(""); });
  refused([](auto& scan) { scan.angle_min_rad = kInfinity; });
  refused([](auto& scan) { std::swap(scan.range_min_m, scan.range_max_m); });
  refused([](auto& scan) { scan.range_min_m = kNan; });
  refused([](auto& scan) { scan.range_max_m = -1.0F; });
}

TEST(BadScans, AMountingThatIsNoPoseIsRefused) {
  const ram_slam::Pose2 mounting{std::nan(""), 0.0, 0.0};
  EXPECT_THROW(FeatureDetector({}).detect(roomScan(), mounting), std::invalid_argument);
  EXPECT_THROW(EdgeDetector({}).detect(roomScan(), mounting), std::invalid_argument);
}

}  // namespace
}  // namespace ramscout_feature_detector
