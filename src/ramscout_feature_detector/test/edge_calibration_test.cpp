// SPDX-License-Identifier: BSD-3-Clause
// Whether the covariances of edges are those of their errors.
#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "ramscout_feature_detector/edge_detector.hpp"

#include "polygon_world.hpp"

namespace ramscout_feature_detector {
namespace {

/// Mean of e^T C^-1 e, e the edges' distance from a place near them; 2 if the covariances are
/// right.
struct Calibration {
  double sum = 0.0;
  int count = 0;

  void add(const std::vector<Edge>& edges, const Eigen::Vector2d& place_m, double nearest_m) {
    for (const Edge& edge : edges) {
      const Eigen::Vector2d error_m = edge.position_m - place_m;
      if (error_m.norm() > nearest_m) continue;
      sum += error_m.dot(edge.covariance_m2.inverse() * error_m);
      ++count;
    }
  }
  double mean() const { return sum / count; }
};

EdgeDetectorParameters forNoise(double noise_m) {
  EdgeDetectorParameters parameters;
  parameters.laser_range_sigma = noise_m;
  return parameters;
}

TEST(EdgeDetector, CovariancesOfEndsAgreeWithTheirErrors) {
  for (const double noise_m : {0.01, 0.02}) {
    const EdgeDetector detector(forNoise(noise_m));
    Calibration calibration;
    for (int i = 0; i < 2000; ++i) {
      ram_slam::Random random(10, i);
      const ram_slam::Pose2 pose{2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0,
                                 0.5 * random.uniform() - 0.25};
      const auto edges =
          detector.edges(door().scan(pose, noise_m, random, 721, -0.5 * M_PI, M_PI / 720.0));
      calibration.add(edges, pose.inverse() * Eigen::Vector2d(3.0, -0.5), 0.1);
      calibration.add(edges, pose.inverse() * Eigen::Vector2d(3.0, 0.5), 0.1);
    }
    EXPECT_GT(calibration.count, 3800);
    EXPECT_NEAR(calibration.mean(), 2.0, 0.2) << noise_m;
  }
}

TEST(EdgeDetector, CovariancesOfCornersAgreeWithTheirErrors) {
  PolygonWorld world;
  world.add({{3.0, -50.0}, {3.0, 2.0}, {-50.0, 2.0}}, false);
  for (const double noise_m : {0.01, 0.02}) {
    const EdgeDetector detector(forNoise(noise_m));
    Calibration calibration;
    for (int i = 0; i < 2000; ++i) {
      ram_slam::Random random(11, i);
      const ram_slam::Pose2 pose{2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.5, 0.0};
      const auto edges =
          detector.edges(world.scan(pose, noise_m, random, 361, -0.25 * M_PI, M_PI / 360.0));
      calibration.add(edges, pose.inverse() * Eigen::Vector2d(3.0, 2.0), 0.1);
    }
    EXPECT_GT(calibration.count, 1950);
    EXPECT_NEAR(calibration.mean(), 2.0, 0.2) << noise_m;
  }
}

TEST(EdgeDetector, CovariancesOfSquareAndRoundPostsAgreeWithTheirErrors) {
  Calibration calibration;
  for (int i = 0; i < 1000; ++i) {
    ram_slam::Random random(12, i);
    const Eigen::Vector2d middle_m(1.0 + 3.0 * random.uniform(), random.uniform() - 0.5);
    const double radius_m = 0.02 + 0.1 * random.uniform();
    const double yaw_rad = random.uniform();
    const int sides = i % 2 == 0 ? 4 : 16;
    std::vector<Eigen::Vector2d> outline_m;
    for (int side = 0; side < sides; ++side) {
      const double angle_rad = yaw_rad + 2.0 * M_PI * side / sides;
      outline_m.push_back(middle_m +
                          radius_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
    }
    PolygonWorld world;
    world.add(outline_m, true);
    calibration.add(EdgeDetector(forNoise(0.01)).edges(world.scan({}, 0.01, random)), middle_m,
                    1.0);
  }
  EXPECT_GT(calibration.count, 950);
  EXPECT_NEAR(calibration.mean(), 2.0, 0.4);
}

/// A box's corner, seen along one of its sides: a few readings lie on that side, 5 to 50 cm apart,
/// and noise decides whether the last one on the other side appears as one of them.
TEST(EdgeDetector, CornersSeenAlongAWallErrNoMoreThanTheirCovariances) {
  PolygonWorld world;
  world.add({{3.0, 0.0}, {3.0, -2.0}, {9.0, -2.0}, {9.0, 0.0}}, true);
  world.add({{-1.0, 8.0}, {12.0, 8.0}, {12.0, -8.0}}, false);
  for (const double noise_m : {0.01, 0.02}) {
    const EdgeDetector detector(forNoise(noise_m));
    Calibration calibration;
    for (int i = 0; i < 3000; ++i) {
      ram_slam::Random random(15, i);
      const double distance_m = 0.5 + 6.0 * random.uniform();
      const ram_slam::Pose2 pose{3.0 - distance_m, distance_m * (0.02 + 0.15 * random.uniform()),
                                 0.01 * random.uniform()};
      const auto edges =
          detector.edges(world.scan(pose, noise_m, random, 721, -0.5 * M_PI, M_PI / 720.0));
      calibration.add(edges, pose.inverse() * Eigen::Vector2d(3.0, 0.0), 0.1);
    }
    EXPECT_GT(calibration.count, 1500);
    EXPECT_LT(calibration.mean(), 2.2) << noise_m;
    EXPECT_GT(calibration.mean(), 0.5) << noise_m;
  }
}

}  // namespace
}  // namespace ramscout_feature_detector
