// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/mount_calibration.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

const Pose2 kMount{0.25, -0.06, 0.12};
constexpr double kDistanceRatio = 1.03;
constexpr double kTurnRatio = 0.96;

/// The base of a robot that drives bends to both sides.
Pose2 baseAt(double time_s) {
  constexpr double kStepS = 0.001;
  static std::vector<Pose2> poses{Pose2{}};
  while (static_cast<double>(poses.size()) * kStepS <= time_s) {
    const double now_s = static_cast<double>(poses.size()) * kStepS;
    poses.push_back(poses.back() * Pose2{0.5 * kStepS, 0.0, 0.8 * std::sin(0.3 * now_s) * kStepS});
  }
  return poses[static_cast<std::size_t>(time_s / kStepS)];
}

std::int64_t toNs(double time_s) {
  return static_cast<std::int64_t>(std::llround(time_s * 1e9));
}

struct Drive {
  Trajectory odometry;
  Trajectory laser;
};

/// Scans at 10 Hz whose stamps are too early by `offset_s`, odometry at 50 Hz with scale errors.
Drive drive(double duration_s, double offset_s, double noise_m) {
  Drive drive;
  Pose2 measured;
  for (double time_s = 0.0; time_s < duration_s; time_s += 0.02) {
    if (!drive.odometry.empty()) {
      const Pose2 motion = baseAt(time_s - 0.02).inverse() * baseAt(time_s);
      measured = measured * Pose2{motion.x_m / kDistanceRatio, motion.y_m / kDistanceRatio,
                                  motion.yaw_rad / kTurnRatio};
    }
    drive.odometry.push_back({toNs(100.0 + time_s), measured});
  }
  Random random(5);
  for (double time_s = 1.0; time_s < duration_s - 1.0; time_s += 0.1) {
    Pose2 pose = baseAt(time_s) * kMount;
    pose.x_m += noise_m * random.gaussian();
    pose.y_m += noise_m * random.gaussian();
    drive.laser.push_back({toNs(100.0 + time_s - offset_s), pose});
  }
  return drive;
}

TEST(MountCalibration, FindsMountScalesAndOffset) {
  const Drive exact = drive(200.0, 0.13, 0.0);
  const auto found = calibrateMount(exact.odometry, exact.laser);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->base_from_laser.x_m, kMount.x_m, 2e-3);
  EXPECT_NEAR(found->base_from_laser.y_m, kMount.y_m, 2e-3);
  EXPECT_NEAR(found->base_from_laser.yaw_rad, kMount.yaw_rad, 2e-3);
  EXPECT_NEAR(found->distance_ratio, kDistanceRatio, 2e-3);
  EXPECT_NEAR(found->turn_ratio, kTurnRatio, 2e-3);
  EXPECT_NEAR(found->stamp_offset_s, 0.13, 5e-3);
}

TEST(MountCalibration, ReportsItsUncertainty) {
  const Drive noisy = drive(200.0, 0.0, 0.005);
  const auto found = calibrateMount(noisy.odometry, noisy.laser);
  ASSERT_TRUE(found);
  const Eigen::Vector3d error(found->base_from_laser.x_m - kMount.x_m,
                              found->base_from_laser.y_m - kMount.y_m,
                              found->base_from_laser.yaw_rad - kMount.yaw_rad);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs(error[i]), 4.0 * found->mount_sigma[i]);
    EXPECT_GT(found->mount_sigma[i], 0.0);
    EXPECT_LT(found->mount_sigma[i], 0.01);
  }
}

TEST(MountCalibration, LeavesOutWhereTheWheelsSlip) {
  Drive slipping = drive(200.0, 0.0, 0.0);
  for (std::size_t i = 0; i < slipping.odometry.size(); ++i) {
    if (i >= 3000) slipping.odometry[i].pose = Pose2{1.5, 0.4, 0.6} * slipping.odometry[i].pose;
    if (i >= 6000) slipping.odometry[i].pose = Pose2{-0.5, 0.2, 0.9} * slipping.odometry[i].pose;
  }
  const auto found = calibrateMount(slipping.odometry, slipping.laser);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->base_from_laser.x_m, kMount.x_m, 2e-3);
  EXPECT_NEAR(found->base_from_laser.yaw_rad, kMount.yaw_rad, 2e-3);
  EXPECT_NEAR(found->distance_ratio, kDistanceRatio, 2e-3);
  EXPECT_GE(found->slip_count, 2U);
}

TEST(MountCalibration, IsNoneOfARobotThatHardlyMoves) {
  const Drive brief = drive(4.0, 0.0, 0.0);
  EXPECT_FALSE(calibrateMount(brief.odometry, brief.laser));
  EXPECT_FALSE(calibrateMount({}, {}));
}

}  // namespace
}  // namespace ram_slam
