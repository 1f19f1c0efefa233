// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/fast_slam.hpp"

#include <gmock/gmock.h>

#include "synthetic_world.hpp"

namespace ram_slam {
namespace {

SyntheticDrive office(std::uint64_t seed, const SyntheticNoise& noise = {}) {
  return syntheticDrive(rectangleTour(16.0, 8.0, 2),
                        scatteredLandmarks({-4.0, -4.0}, {22.0, 15.0}, 60, 1.0, seed), 6.0, noise,
                        seed);
}

struct Errors {
  double position_m = 0.0;  ///< root mean square
  double yaw_rad = 0.0;
  double final_m = 0.0;
};

Errors errorsOf(const std::vector<StampedPose2>& trajectory, const std::vector<Pose2>& truth) {
  Errors errors;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const Pose2 error = truth[i].inverse() * trajectory[i].pose;
    errors.position_m += error.translation().squaredNorm();
    errors.yaw_rad += error.yaw_rad * error.yaw_rad;
    errors.final_m = error.translation().norm();
  }
  errors.position_m = std::sqrt(errors.position_m / static_cast<double>(trajectory.size()));
  errors.yaw_rad = std::sqrt(errors.yaw_rad / static_cast<double>(trajectory.size()));
  return errors;
}

FastSlam run(const SyntheticDrive& drive, const FastSlamParameters& parameters) {
  FastSlam filter(parameters);
  for (const FeatureList& list : drive.lists) filter.update(list, drive.odometry);
  return filter;
}

TEST(FastSlam, TourOfTwoRoundsStaysNearTheTruthAndFindsItsLandmarksAgain) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const SyntheticDrive drive = office(seed);
    const FastSlam filter = run(drive, {});
    const Errors errors = errorsOf(filter.trajectory(), drive.truth);
    EXPECT_LT(errors.position_m, 0.1);
    EXPECT_LT(errors.yaw_rad, 0.02);
    EXPECT_NEAR(static_cast<double>(filter.landmarks().landmarks.size()),
                static_cast<double>(drive.landmarks_m.size()), 3.0);
  }
}

}  // namespace
}  // namespace ram_slam
