// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/edge_detector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ramscout_feature_detector/edge_matcher.hpp"

#include "random_world.hpp"

namespace ramscout_feature_detector {
namespace {

constexpr double kNoiseM = 0.01;

MATCHER_P3(IsAt, kind, x_m, y_m, "") {
  return arg.kind == kind && (arg.position_m - Eigen::Vector2d(x_m, y_m)).norm() < 0.05;
}

TEST(EdgeDetector, FindsTheJambsOfADoorAndNotTheirShadows) {
  const EdgeDetector detector({});
  for (int i = 0; i < 50; ++i) {
    ram_slam::Random random(1, i);
    auto edges = detector.edges(door().scan({}, kNoiseM, random, 721, -0.25 * M_PI, M_PI / 1440.0));
    EXPECT_THAT(edges, testing::UnorderedElementsAre(IsAt(Edge::Kind::kEnd, 3.0, -0.5),
                                                     IsAt(Edge::Kind::kEnd, 3.0, 0.5)));
  }
}

TEST(EdgeDetector, EndsPointAwayFromTheirSurface) {
  ram_slam::Random random(2);
  const auto scan = door().scan({}, 0.0, random, 721, -0.25 * M_PI, M_PI / 1440.0);
  for (const Edge& edge : EdgeDetector({}).edges(scan)) {
    const double expected_rad = edge.position_m.y() < 0.0 ? M_PI_2 : -M_PI_2;
    EXPECT_NEAR(edge.orientation_rad, expected_rad, 0.01);
  }
}

TEST(EdgeDetector, ASmallThingIsOneFeatureAtItsMiddleWithoutClassifier) {
  PolygonWorld world;
  world.add({{1.9, -0.1}, {2.1, -0.1}, {2.1, 0.1}, {1.9, 0.1}}, true);
  ram_slam::Random random(3);
  const auto scan = world.scan({}, kNoiseM, random);
  EXPECT_THAT(EdgeDetector({}).edges(scan),
              testing::ElementsAre(IsAt(Edge::Kind::kObject, 1.93, 0.0)));
  const auto features = EdgeDetector({}).detect(scan, {}).features;
  ASSERT_EQ(features.size(), 1U);
  EXPECT_EQ(features[0].type, "edge");
  EXPECT_EQ(features[0].classifier, "");
  EXPECT_GE(features[0].orientation_variance_rad2, 1e6);
}

TEST(EdgeDetector, ACornerIsABendWithItsBisector) {
  PolygonWorld world;
  world.add({{3.0, -50.0}, {3.0, 2.0}, {-50.0, 2.0}}, false);
  const EdgeDetector detector({});
  std::size_t count = 0;
  for (int i = 0; i < 50; ++i) {
    ram_slam::Random random(4, i);
    const auto edges = detector.edges(world.scan({}, kNoiseM, random, 721, 0.0, M_PI / 1440.0));
    count += edges.size();
    const auto corner = std::find_if(edges.begin(), edges.end(), [](const Edge& edge) {
      return edge.kind == Edge::Kind::kBend &&
             (edge.position_m - Eigen::Vector2d(3.0, 2.0)).norm() < 0.03;
    });
    ASSERT_NE(corner, edges.end());
    EXPECT_NEAR(corner->orientation_rad, -0.75 * M_PI, 0.05);
  }
  EXPECT_LE(count, 51U);
}

TEST(EdgeDetector, WhatItFindsInRandomWorldsAreCorners) {
  for (const double noise_m : {0.01, 0.02}) {
    const EdgeDetector detector({});
    int count = 0;
    int false_count = 0;
    for (int i = 0; i < 60; ++i) {
      const RandomWorld world(static_cast<RandomWorld::Kind>(i % 3), 100 + i);
      ram_slam::Random random(13, i);
      const ram_slam::Pose2 pose = world.freePose(random);
      for (const Edge& edge : detector.edges(world.walls().scan(pose, noise_m, random))) {
        ++count;
        false_count += world.distanceToCorner_m(pose * edge.position_m) > 0.1 ? 1 : 0;
      }
    }
    EXPECT_GT(count, 700);
    EXPECT_LT(false_count, (noise_m < 0.015 ? 0.01 : 0.02) * count) << noise_m;
  }
}

TEST(EdgeDetector, AWallThatGoesOnAtAGrazingAngleHasNoEnd) {
  PolygonWorld world;
  world.add({{-1.0, 0.5}, {25.0, 0.5}}, false);
  const EdgeDetector detector({});
  for (int i = 0; i < 50; ++i) {
    ram_slam::Random random(14, i);
    for (const Edge& edge : detector.edges(world.scan({}, kNoiseM, random))) {
      EXPECT_LT((edge.position_m - Eigen::Vector2d(-1.0, 0.5)).norm(), 0.1);
    }
  }
}

TEST(EdgeDetector, StraightWallsYieldNothing) {
  const EdgeDetector detector({});
  PolygonWorld world;
  world.add({{2.0, -500.0}, {2.0, 500.0}}, false);
  std::size_t count = 0;
  for (int i = 0; i < 300; ++i) {
    ram_slam::Random random(5, i);
    const double yaw_rad = 2.0 * (random.uniform() - 0.5);
    // Up to a grazing angle of 10 degrees a wall is one surface.
    auto scan = world.scan({0.0, 0.0, yaw_rad}, kNoiseM, random);
    for (float& range_m : scan.ranges_m) {
      if (range_m > 11.0F) range_m = std::numeric_limits<float>::quiet_NaN();
    }
    count += detector.edges(scan).size();
  }
  EXPECT_LE(count, 3U);
}

TEST(EdgeDetector, WhereTheViewEndsIsNoEdge) {
  PolygonWorld world;
  world.add({{3.0, -50.0}, {3.0, 50.0}}, false);
  ram_slam::Random random(6);
  auto scan = world.scan({}, 0.0, random, 361, -0.25 * M_PI, M_PI / 720.0);
  EXPECT_THAT(EdgeDetector({}).edges(scan), testing::IsEmpty());
  scan.ranges_m[180] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(EdgeDetector({}).edges(scan), testing::IsEmpty());
}

TEST(EdgeDetector, SeesTheSameWorldClockwiseAndAcrossTheSeamOfAFullTurn) {
  PolygonWorld world;
  world.add({{-2.0, -0.2}, {-2.0, 0.7}, {-3.0, 0.7}, {-3.0, -0.2}}, true);
  world.add({{-5.0, -5.0}, {5.0, -5.0}, {5.0, 5.0}, {-5.0, 5.0}}, true);
  ram_slam::Random random(7);
  auto scan = world.scan({}, 0.0, random, 1440, -M_PI, M_PI / 720.0);
  const auto expected = EdgeDetector({}).edges(scan);
  EXPECT_THAT(expected, testing::UnorderedElementsAre(
                            IsAt(Edge::Kind::kEnd, -2.0, -0.2), IsAt(Edge::Kind::kEnd, -2.0, 0.7),
                            IsAt(Edge::Kind::kBend, -5.0, -5.0), IsAt(Edge::Kind::kBend, 5.0, -5.0),
                            IsAt(Edge::Kind::kBend, 5.0, 5.0), IsAt(Edge::Kind::kBend, -5.0, 5.0)));
  std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
  scan.angle_min_rad = scan.bearing_rad(scan.ranges_m.size() - 1);
  scan.angle_increment_rad = -scan.angle_increment_rad;
  EXPECT_EQ(EdgeDetector({}).edges(scan).size(), expected.size());
}

TEST(EdgeDetector, FeaturesAreInTheBaseFrame) {
  ram_slam::Random random(8);
  const auto scan = door().scan({}, 0.0, random, 721, -0.25 * M_PI, M_PI / 1440.0);
  const ram_slam::Pose2 base_from_laser{0.3, -0.1, 0.5};
  const EdgeDetector detector({});
  const auto edges = detector.edges(scan);
  const auto features = detector.detect(scan, base_from_laser).features;
  ASSERT_EQ(features.size(), edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    EXPECT_LT((features[i].position_m - base_from_laser * edges[i].position_m).norm(), 1e-9);
    EXPECT_NEAR(features[i].covariance_m2.determinant(), edges[i].covariance_m2.determinant(),
                1e-12);
    EXPECT_NE(EdgeMatcher().parse(features[i].classifier), nullptr);
  }
}

TEST(EdgeDetector, RefusesWhatItCannotUse) {
  ram_slam::Random random(9);
  const auto scan = door().scan({}, 0.0, random);
  EXPECT_THROW(EdgeDetector({}).detect({}, {}), std::invalid_argument);
  EXPECT_THROW(EdgeDetector({}).detect(scan, {std::nan(""), 0.0, 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace ramscout_feature_detector
