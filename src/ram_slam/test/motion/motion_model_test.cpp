// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/motion/motion_model.hpp"

#include <cmath>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

/// A quarter of a turn to the left after 2 m, whatever the stamps.
class QuarterTurn : public MotionModel {
public:
  explicit QuarterTurn(const Eigen::Matrix3d& covariance) : covariance_(covariance) {}
  PoseWithCovariance2 motion(std::int64_t, std::int64_t) const override {
    return {{2.0, 0.0, M_PI_2}, covariance_};
  }

private:
  Eigen::Matrix3d covariance_;
};

TEST(MotionModel, MovesEachPoseInItsOwnFrame) {
  const QuarterTurn exact(Eigen::Matrix3d::Zero());
  const auto poses = exact.sample({{0.0, 0.0, 0.0}, {1.0, 1.0, M_PI_2}}, 1, 2, 7);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_NEAR(poses[0].x_m, 2.0, 1e-12);
  EXPECT_NEAR(poses[0].yaw_rad, M_PI_2, 1e-12);
  EXPECT_NEAR(poses[1].x_m, 1.0, 1e-12);
  EXPECT_NEAR(poses[1].y_m, 3.0, 1e-12);
  EXPECT_NEAR(std::abs(poses[1].yaw_rad), M_PI, 1e-12);
}

TEST(MotionModel, PredictsWithoutNoise) {
  const QuarterTurn noisy(Eigen::Matrix3d::Identity());
  const auto poses = noisy.predictEach({{1.0, 1.0, M_PI_2}}, 1, 2);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_NEAR(poses[0].x_m, 1.0, 1e-12);
  EXPECT_NEAR(poses[0].y_m, 3.0, 1e-12);
}

TEST(MotionModel, SamplesHaveTheMeanAndTheCovarianceOfTheMotion) {
  Eigen::Matrix3d covariance;
  covariance << 0.04, 0.01, 0.002, 0.01, 0.01, 0.001, 0.002, 0.001, 0.0025;
  constexpr int kCount = 20000;
  const auto poses = QuarterTurn(covariance).sample(std::vector<Pose2>(kCount), 1, 2, 3);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const Pose2& pose : poses) {
    const Eigen::Vector3d error(pose.x_m - 2.0, pose.y_m, pose.yaw_rad - M_PI_2);
    mean += error / kCount;
    squares += error * error.transpose() / kCount;
  }
  // Three standard deviations of a mean and of a variance of so many samples.
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 3.0 * 0.2 / std::sqrt(kCount));
  EXPECT_LT((squares - covariance).cwiseAbs().maxCoeff(), 3.0 * 0.04 * std::sqrt(2.0 / kCount));
}

TEST(MotionModel, SamplesTheSameFromTheSameSeedOnly) {
  const QuarterTurn model(0.01 * Eigen::Matrix3d::Identity());
  const std::vector<Pose2> start(3);
  const auto first = model.sample(start, 1, 2, 5);
  const auto again = model.sample(start, 1, 2, 5);
  const auto other = model.sample(start, 1, 2, 6);
  for (std::size_t i = 0; i < start.size(); ++i) {
    EXPECT_EQ(first[i].x_m, again[i].x_m);
    EXPECT_NE(first[i].x_m, other[i].x_m);
  }
  EXPECT_NE(first[0].x_m, first[1].x_m);
}

}  // namespace
}  // namespace ram_slam
