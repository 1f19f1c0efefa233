// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/feature_detector.hpp"

#include <algorithm>
#include <stdexcept>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "polygon_world.hpp"

namespace ramscout_feature_detector {
namespace {

constexpr double kNoiseM = 0.01;

/// Two walls of 4 m that meet 3 m ahead of the laser with the given opening towards it.
PolygonWorld twoWalls(double opening_rad) {
  const Eigen::Vector2d corner(3.0, 0.0);
  const auto leg = [&](double side) -> Eigen::Vector2d {
    const double angle_rad = M_PI - side * 0.5 * opening_rad;
    return corner + 4.0 * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
  };
  PolygonWorld world;
  world.add({leg(-1.0), corner, leg(1.0)}, false);
  return world;
}

class Openings : public testing::TestWithParam<double> {};

TEST_P(Openings, CornernessIsThatOfTwoHalfLines) {
  const double opening_rad = GetParam() * M_PI / 180.0;
  ram_slam::Random random(1);
  FeatureDetectorParameters parameters;
  parameters.corner_threshold = 0.03;
  const FeatureDetector detector(parameters);
  const auto analysis = detector.analyse(twoWalls(opening_rad).scan({}, 0.0, random));
  ASSERT_EQ(analysis.corners.size(), 1U);
  const Corner& corner = analysis.corners.front();
  const double expected = 0.5 * (1.0 - std::abs(std::cos(opening_rad)));
  EXPECT_NEAR(corner.lines.cornerness, expected, 0.01);
  EXPECT_NEAR(corner.peak.cornerness, expected, 0.2 * expected);
  EXPECT_NEAR((corner.lines.position_m - Eigen::Vector2d(3.0, 0.0)).norm(), 0.0, 1e-3);
  EXPECT_NEAR(std::abs(ram_slam::wrapAngle(corner.lines.orientation_rad)), M_PI, 1e-2);
}

INSTANTIATE_TEST_SUITE_P(Degrees, Openings, testing::Values(90.0, 120.0, 135.0, 150.0));

TEST(FeatureDetector, BendsTooWeakForTheThresholdAreNoCorners) {
  ram_slam::Random random(1);
  const auto scan = twoWalls(150.0 * M_PI / 180.0).scan({}, 0.0, random);
  EXPECT_TRUE(FeatureDetector({}).analyse(scan).corners.empty());
}

TEST(FeatureDetector, StraightWallYieldsNothing) {
  const FeatureDetector detector({});
  int features = 0;
  for (int i = 0; i < 1000; ++i) {
    ram_slam::Random random(2, i);
    PolygonWorld world;
    world.add({{2.0, -500.0}, {2.0, 500.0}}, false);
    const double yaw_rad = 2.0 * M_PI * (random.uniform() - 0.5);
    features += static_cast<int>(
        detector.analyse(world.scan({0.0, 0.0, yaw_rad}, kNoiseM, random)).corners.size());
  }
  EXPECT_LT(features, 10);
}

class Noise : public testing::TestWithParam<double> {};

TEST_P(Noise, ErrorsOfCornersAgreeWithTheCovariance) {
  FeatureDetectorParameters parameters;
  parameters.laser_range_sigma = GetParam();
  const FeatureDetector detector(parameters);
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < 2300; ++i) {
    ram_slam::Random random(3, i);
    const auto world = twoWalls(M_PI * (0.4 + 0.35 * random.uniform()));
    const ram_slam::Pose2 pose{2.0 * random.uniform() - 1.5, random.uniform() - 0.5,
                               0.5 * random.gaussian()};
    for (const Corner& corner : detector.analyse(world.scan(pose, GetParam(), random)).corners) {
      const Eigen::Vector2d error =
          corner.lines.position_m - pose.inverse() * Eigen::Vector2d(3.0, 0.0);
      if (error.norm() > 0.2) continue;
      sum += error.dot(corner.lines.covariance_m2.inverse() * error);
      ++count;
    }
  }
  EXPECT_GE(count, 2000);
  EXPECT_NEAR(sum / count, 2.0, 0.2);
}

INSTANTIATE_TEST_SUITE_P(Metres, Noise, testing::Values(0.01, 0.02));

TEST(FeatureDetector, TurningTheScanByWholeBeamsTurnsTheFeatures) {
  ram_slam::Random random(4);
  PolygonWorld room;
  room.add({{-2.0, -3.0}, {4.0, -3.0}, {4.0, 2.0}, {1.0, 2.0}, {1.0, 3.0}, {-2.0, 3.0}}, true);
  const auto scan = room.scan({}, kNoiseM, random, 1440, -M_PI, M_PI / 720.0);
  auto turned = scan;
  std::rotate(turned.ranges_m.begin(), turned.ranges_m.begin() + 360, turned.ranges_m.end());
  const FeatureDetector detector({});
  const auto features = detector.detect(scan, {}).features;
  const auto again = detector.detect(turned, {0.0, 0.0, M_PI_2}).features;
  ASSERT_GE(features.size(), 5U);
  ASSERT_EQ(features.size(), again.size());
  for (const auto& feature : features) {
    const auto same =
        std::min_element(again.begin(), again.end(), [&](const auto& a, const auto& b) {
          return (a.position_m - feature.position_m).norm() <
                 (b.position_m - feature.position_m).norm();
        });
    EXPECT_NEAR((same->position_m - feature.position_m).norm(), 0.0, 1e-4);
    EXPECT_EQ(same->classifier, feature.classifier);
  }
}

TEST(FeatureDetector, UpsideDownLaserSeesTheSameWorld) {
  ram_slam::Random random(5);
  const auto world = twoWalls(M_PI_2);
  const ram_slam::Pose2 pose{0.5, 0.3, 0.2};
  const auto upright = world.scan(pose, 0.0, random, 721, -M_PI_2, M_PI / 720.0);
  auto upside_down = upright;
  std::reverse(upside_down.ranges_m.begin(), upside_down.ranges_m.end());
  const FeatureDetector detector({});
  const auto expected = detector.detect(upright, pose).features;
  const auto features = detector.detect(ram_slam::mirrored(upside_down), pose).features;
  ASSERT_EQ(features.size(), 1U);
  ASSERT_EQ(expected.size(), 1U);
  EXPECT_NEAR((features[0].position_m - expected[0].position_m).norm(), 0.0, 1e-6);
}

TEST(FeatureDetector, NoFeaturesAtTheShadowsOfABox) {
  const FeatureDetector detector({});
  PolygonWorld world;
  world.add({{6.0, -8.0}, {6.0, 8.0}}, false);
  world.add({{2.0, -0.5}, {3.0, -0.5}, {3.0, 0.5}, {2.0, 0.5}}, true);
  int corners = 0;
  for (int i = 0; i < 100; ++i) {
    ram_slam::Random random(6, i);
    const ram_slam::Pose2 pose{0.5 * random.gaussian(), 2.0 * (random.uniform() - 0.5), 0.0};
    for (const Corner& corner : detector.analyse(world.scan(pose, kNoiseM, random)).corners) {
      const Eigen::Vector2d place_m = pose * corner.lines.position_m;
      EXPECT_LT(place_m.x(), 4.0) << "a feature on the wall in the background";
      ++corners;
    }
  }
  EXPECT_GT(corners, 20);
}

TEST(FeatureDetector, RefusesScansItCannotUse) {
  const FeatureDetector detector({});
  EXPECT_THROW(detector.detect({}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace ramscout_feature_detector
