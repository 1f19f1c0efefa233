// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "ram_slam/geometry/random.hpp"
#include "ramscout_kinematics/differential_drive.hpp"
#include "ramscout_kinematics/kinematics.hpp"

namespace ramscout_kinematics {

/// A stamp as far from zero as real ones are.
constexpr std::int64_t kStartNs = 1'700'000'000'000'000'000;

inline std::int64_t after(double seconds) {
  return kStartNs + std::llround(seconds * 1e9);
}

/// Odometry of a drive at constant twist (m/s, m/s, rad/s in the base frame), sampled every
/// `period_s`.
inline std::vector<OdometrySample> drive(const Eigen::Vector3d& twist,
                                         double duration_s,
                                         double period_s) {
  std::vector<OdometrySample> samples;
  const int count = static_cast<int>(std::lround(duration_s / period_s));
  for (int i = 0; i <= count; ++i) {
    samples.push_back({after(i * period_s), ram_slam::exponential(i * period_s * twist), twist});
  }
  return samples;
}

/// Odometry of a drive whose speed and turn rate change at every sample; stamps irregular around
/// `period_s`.
inline std::vector<OdometrySample> randomDrive(std::uint64_t seed,
                                               double duration_s,
                                               double period_s) {
  ram_slam::Random random(seed);
  std::vector<OdometrySample> samples;
  ram_slam::Pose2 pose{-3.0, 5.0, 2.0};
  double time_s = 0.0;
  while (time_s < duration_s) {
    const Eigen::Vector3d twist(0.5 + 0.5 * random.gaussian(), 0.0, random.gaussian());
    samples.push_back({after(time_s), pose, twist});
    const double step_s = period_s * (0.5 + random.uniform());
    pose = pose * ram_slam::exponential(step_s * twist);
    time_s += step_s;
  }
  return samples;
}

inline void addAll(Kinematics& kinematics, const std::vector<OdometrySample>& samples) {
  for (const OdometrySample& sample : samples) kinematics.add(sample);
}

/// Parameters under which the closed forms hold: no limit on speed, history or gaps.
inline KinematicsParameters unlimited(const std::shared_ptr<const DriveModel>& model) {
  KinematicsParameters parameters;
  parameters.drive_model = model;
  parameters.buffer.buffer_duration_s = 3600.0;
  parameters.buffer.gap_s = 3600.0;
  parameters.buffer.max_gap_s = 3600.0;
  parameters.buffer.max_speed_mps = 100.0;
  parameters.buffer.max_turn_rate_radps = 100.0;
  return parameters;
}

constexpr double kRoundingOnly = 1e-12;

inline std::shared_ptr<const DriveModel> differential(double separation_m,
                                                      double left,
                                                      double right) {
  DifferentialDriveParameters parameters;
  parameters.wheel_separation_m = separation_m;
  parameters.left_noise_m2_per_m = left;
  parameters.right_noise_m2_per_m = right;
  return std::make_shared<DifferentialDrive>(parameters);
}

inline void expectRelativelyNear(const Eigen::MatrixXd& a,
                                 const Eigen::MatrixXd& b,
                                 double tolerance) {
  EXPECT_LE((a - b).norm(), tolerance * b.norm()) << a << "\n\nwanted\n\n" << b;
}

inline void expectNear(const ram_slam::Pose2& a, const ram_slam::Pose2& b, double tolerance) {
  EXPECT_NEAR(a.x_m, b.x_m, tolerance);
  EXPECT_NEAR(a.y_m, b.y_m, tolerance);
  EXPECT_NEAR(ram_slam::wrapAngle(a.yaw_rad - b.yaw_rad), 0.0, tolerance);
}

inline Eigen::Vector3d toVector(const ram_slam::Pose2& pose) {
  return {pose.x_m, pose.y_m, pose.yaw_rad};
}

}  // namespace ramscout_kinematics
