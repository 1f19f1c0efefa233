// SPDX-License-Identifier: BSD-3-Clause
// The covariance of a motion against closed forms and against simulated wheels.
#include <gtest/gtest.h>

#include "ram_slam/geometry/random.hpp"
#include "ramscout_kinematics/kinematics.hpp"

#include "drives.hpp"

namespace ramscout_kinematics {
namespace {

using ram_slam::PoseWithCovariance2;

/// Noise densities per metre of path of curvature kappa (algorithm of the differential drive, by
/// hand).
struct Densities {
  Densities(double separation_m, double left, double right, double kappa) {
    const double r = right * std::abs(1.0 + separation_m * kappa / 2.0);
    const double l = left * std::abs(1.0 - separation_m * kappa / 2.0);
    s = (r + l) / 4.0;
    t = (r + l) / (separation_m * separation_m);
    st = (r - l) / (2.0 * separation_m);
  }
  double s, t, st;
};

TEST(Kinematics, StraightDriveHasTheClosedFormNoise) {
  const double length_m = 3.0;
  Kinematics kinematics(unlimited(differential(0.5, 1e-4, 3e-4)));
  addAll(kinematics, drive({1.0, 0.0, 0.0}, length_m, 0.01));
  const PoseWithCovariance2 motion = kinematics.motion(after(0.0), after(length_m));
  expectNear(motion.pose, {length_m, 0.0, 0.0}, 1e-9);

  const Densities q(0.5, 1e-4, 3e-4, 0.0);
  const double l = length_m;
  Eigen::Matrix3d expected;
  expected << q.s * l, q.st * l * l / 2, q.st * l,             //
      q.st * l * l / 2, q.t * l * l * l / 3, q.t * l * l / 2,  //
      q.st * l, q.t * l * l / 2, q.t * l;
  expectRelativelyNear(motion.covariance, expected, 1e-9);
}

TEST(Kinematics, QuarterCircleHasTheClosedFormNoise) {
  const double radius_m = 2.0;
  const double length_m = radius_m * M_PI_2;
  for (const double period_s : {M_PI_2, M_PI_2 / 7.0, M_PI_2 / 1000.0}) {
    Kinematics kinematics(unlimited(differential(0.5, 4e-5, 6e-5)));
    addAll(kinematics, drive({radius_m, 0.0, 1.0}, M_PI_2, period_s));
    const PoseWithCovariance2 motion = kinematics.motion(after(0.0), after(M_PI_2));
    expectNear(motion.pose, {radius_m, radius_m, M_PI_2}, 1e-8);

    const Densities q(0.5, 4e-5, 6e-5, 1.0 / radius_m);
    const double r = radius_m;
    EXPECT_NEAR(motion.covariance(0, 0), M_PI * r / 4 * (q.s + q.t * r * r - 2 * r * q.st), 1e-9);
    EXPECT_NEAR(motion.covariance(1, 1),
                r * (q.s * M_PI_4 + q.t * r * r * (3 * M_PI_4 - 2) + 2 * q.st * r * (1 - M_PI_4)),
                1e-9);
    EXPECT_NEAR(motion.covariance(0, 2), r * (q.st - q.t * r), 1e-9);
    EXPECT_NEAR(motion.covariance(1, 2), r * (q.st + q.t * r * (M_PI_2 - 1)), 1e-9);
    EXPECT_NEAR(motion.covariance(2, 2), q.t * length_m, 1e-9);
  }
}

TEST(Kinematics, QuarterCircleHasTheNoiseThatMonteCarloFound) {
  Kinematics kinematics(unlimited(differential(0.5, 4e-5, 4e-5)));
  addAll(kinematics, drive({2.0, 0.0, 1.0}, M_PI_2, M_PI_2 / 50.0));
  const Eigen::Matrix3d covariance = kinematics.motion(after(0.0), after(M_PI_2)).covariance;
  EXPECT_NEAR(covariance(0, 0), 0.0019792, 1e-7);
  EXPECT_NEAR(covariance(1, 1), 0.00096044, 1e-7);
  EXPECT_NEAR(covariance(0, 2), -0.00126, 4e-6);
  EXPECT_NEAR(covariance(1, 2), 0.0007506, 1e-6);
  EXPECT_NEAR(covariance(2, 2), 0.0010053, 1e-7);
}

/// An independent slow simulation: each wheel draws its error every millimetre, poses are added up
/// by midpoints.
TEST(Kinematics, NoiseAgreesWithWheelsThatErrEveryMillimetre) {
  const double separation_m = 0.4, left = 4e-6, right = 1e-5;
  const double turn_per_metre = 0.8, length_m = 1.5;
  Kinematics kinematics(unlimited(differential(separation_m, left, right)));
  addAll(kinematics, drive({1.0, 0.0, turn_per_metre}, length_m, 0.02));
  const PoseWithCovariance2 motion = kinematics.motion(after(0.0), after(length_m));

  const int runs = 4000, steps = 1500;
  const double step_m = length_m / steps;
  ram_slam::Random random(7);
  Eigen::Matrix3d simulated = Eigen::Matrix3d::Zero();
  for (int run = 0; run < runs; ++run) {
    double x = 0.0, y = 0.0, yaw = 0.0;
    for (int step = 0; step < steps; ++step) {
      const double r = step_m * (1.0 + separation_m * turn_per_metre / 2.0);
      const double l = step_m * (1.0 - separation_m * turn_per_metre / 2.0);
      const double noisy_r = r + std::sqrt(right * r) * random.gaussian();
      const double noisy_l = l + std::sqrt(left * l) * random.gaussian();
      const double turn = (noisy_r - noisy_l) / separation_m;
      x += (noisy_r + noisy_l) / 2.0 * std::cos(yaw + turn / 2.0);
      y += (noisy_r + noisy_l) / 2.0 * std::sin(yaw + turn / 2.0);
      yaw += turn;
    }
    const Eigen::Vector3d error = Eigen::Vector3d(x, y, yaw) - toVector(motion.pose);
    simulated += error * error.transpose() / runs;
  }
  // The standard error of a variance from n runs is sqrt(2 / n) = 2.2 %.
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double scale = std::sqrt(motion.covariance(i, i) * motion.covariance(j, j));
      EXPECT_NEAR(simulated(i, j), motion.covariance(i, j), 3.5 * std::sqrt(2.0 / runs) * scale)
          << i << j;
    }
  }
}

TEST(Kinematics, BackwardDriveHasTheNoiseOfTheForwardDriveMirrored) {
  Kinematics forward(unlimited(differential(0.4, 1e-4, 1e-4)));
  Kinematics backward(unlimited(differential(0.4, 1e-4, 1e-4)));
  addAll(forward, drive({1.0, 0.0, 0.3}, 2.0, 0.02));
  addAll(backward, drive({-1.0, 0.0, -0.3}, 2.0, 0.02));
  const PoseWithCovariance2 there = forward.motion(after(0.0), after(2.0));
  const PoseWithCovariance2 back = backward.motion(after(0.0), after(2.0));
  EXPECT_NEAR(back.covariance(1, 1), there.covariance(1, 1), kRoundingOnly);
  EXPECT_NEAR(back.covariance(2, 2), there.covariance(2, 2), kRoundingOnly);
  EXPECT_NEAR(back.covariance(1, 2), -there.covariance(1, 2), kRoundingOnly);
}

TEST(Kinematics, StandingStillSpreadsWithTheRootOfTheTime) {
  KinematicsParameters parameters = unlimited(differential(0.4, 1e-4, 1e-4));
  parameters.standing_sigma_m = 0.002;
  parameters.standing_sigma_rad = 0.003;
  Kinematics kinematics(parameters);
  addAll(kinematics, drive({0.0, 0.0, 0.0}, 4.0, 0.02));
  const Eigen::Matrix3d covariance = kinematics.motion(after(0.0), after(4.0)).covariance;
  EXPECT_NEAR(covariance(0, 0), 4.0 * 0.002 * 0.002, kRoundingOnly);
  EXPECT_NEAR(covariance(2, 2), 4.0 * 0.003 * 0.003, kRoundingOnly);
}

TEST(Kinematics, CrawlingIsNotStandingStill) {
  KinematicsParameters parameters = unlimited(differential(0.4, 0.0, 0.0));
  const auto spreadAt = [&](const Eigen::Vector3d& twist) {
    Kinematics kinematics(parameters);
    addAll(kinematics, drive(twist, 2.0, 0.02));
    return kinematics.motion(after(0.0), after(2.0)).covariance(2, 2);
  };
  EXPECT_GT(spreadAt({0.004, 0.0, 0.004}), 0.0);
  EXPECT_EQ(spreadAt({0.006, 0.0, 0.0}), 0.0);
  EXPECT_EQ(spreadAt({0.0, 0.0, 0.006}), 0.0);
  parameters.standing_speed_mps = 0.01;
  EXPECT_GT(spreadAt({0.006, 0.0, 0.0}), 0.0);
  EXPECT_EQ(spreadAt({0.0, 0.0, 0.006}), 0.0);
}

}  // namespace
}  // namespace ramscout_kinematics
