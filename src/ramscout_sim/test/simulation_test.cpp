// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "shared.hpp"
#include "spoiled_parameters.hpp"

namespace ramscout_sim {
namespace {

using testing::makeRoom;
using testing::shippedRobot;

/// A robot whose odometry is right, but for its ticks.
SimulationParameters withoutErrors() {
  SimulationParameters p;
  p.odometry.wheel_diameter_ratio = 1.0;
  p.odometry.track_ratio = 1.0;
  p.odometry.slip_distance_sigma_per_sqrt_m = 0.0;
  p.odometry.slip_yaw_sigma_rad_per_sqrt_m = 0.0;
  p.odometry.slip_yaw_sigma_rad_per_sqrt_rad = 0.0;
  return p;
}

Simulation inRoom(const SimulationParameters& parameters) {
  return {parameters, shippedRobot(), makeRoom(20.0, 10.0), std::nullopt};
}

/// Steps for a while, with the command renewed at each step.
void obey(Simulation& simulation, const Twist2& twist, double duration_s) {
  for (int i = 0; i < std::lround(duration_s * 1000.0); ++i) {
    simulation.command(twist);
    simulation.step();
  }
}

template <typename T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// Every bit that came out in `duration_s` of a tour.
std::string record(int seed, double duration_s) {
  SimulationParameters parameters;
  parameters.seed = seed;
  Tour tour;
  tour.waypoints_m = {{10.0, 5.0}, {15.0, 5.0}, {15.0, 8.0}, {5.0, 8.0}};
  Simulation simulation(parameters, shippedRobot(), makeRoom(20.0, 10.0), tour);
  std::string bytes;
  for (int i = 0; i < std::lround(duration_s * 1000.0); ++i) {
    const Outputs outputs = simulation.step();
    if (outputs.odometry) {
      append(bytes, outputs.odometry->stamp_ns);
      append(bytes, outputs.odometry->odom_from_base);
      append(bytes, outputs.odometry->twist);
      append(bytes, outputs.odometry->wheel_angles_rad);
      for (const double value : outputs.odometry->covariance.reshaped()) append(bytes, value);
    }
    if (outputs.ground_truth) {
      append(bytes, outputs.ground_truth->stamp_ns);
      for (const double value : outputs.ground_truth->world_from_base.matrix().reshaped())
        append(bytes, value);
    }
    if (outputs.scan) {
      append(bytes, outputs.scan->stamp_ns);
      for (const float range : outputs.scan->ranges_m) append(bytes, range);
    }
  }
  return bytes;
}

TEST(Simulation, SameSeedGivesTheSameBytes) {
  const std::string first = record(1, 5.0);
  EXPECT_GT(first.size(), 500'000U);
  EXPECT_TRUE(first == record(1, 5.0));
  EXPECT_FALSE(first == record(2, 5.0));
}

TEST(Simulation, OutputsComeAtTheirRatesWithRisingStamps) {
  Simulation simulation = inRoom({});
  std::vector<std::int64_t> odometry;
  std::vector<std::int64_t> scans;
  while (simulation.now_ns() < Simulation::kStart_ns + 1'000'000'000) {
    const Outputs outputs = simulation.step();
    EXPECT_EQ(outputs.odometry.has_value(), outputs.ground_truth.has_value());
    if (outputs.odometry) odometry.push_back(outputs.odometry->stamp_ns);
    if (outputs.scan) {
      scans.push_back(outputs.scan->stamp_ns);
      EXPECT_GE(simulation.now_ns(), scans.back() + 18'750'000);  // not before its last beam
    }
  }
  ASSERT_EQ(odometry.size(), 101U);
  for (std::size_t i = 0; i < odometry.size(); ++i)
    EXPECT_EQ(odometry[i], Simulation::kStart_ns + 10'000'000 * static_cast<std::int64_t>(i));
  ASSERT_EQ(scans.size(), 40U);
  for (std::size_t i = 0; i < scans.size(); ++i)
    EXPECT_EQ(scans[i], Simulation::kStart_ns + 25'000'000 * static_cast<std::int64_t>(i));
}

TEST(Simulation, DrivesAsCommanded) {
  Simulation simulation = inRoom(withoutErrors());
  obey(simulation, {0.5, 0.0, 0.2}, 3.0);
  EXPECT_NEAR(simulation.groundTruth().linear_velocity_mps.x(), 0.5, 1e-3);
  EXPECT_NEAR(simulation.groundTruth().angular_velocity_radps.z(), 0.2, 1e-3);
}

TEST(Simulation, ARunningCommandStopsAfterItsTimeout) {
  Simulation simulation = inRoom(withoutErrors());
  obey(simulation, {0.5, 0.0, 0.0}, 2.0);
  for (int i = 0; i < 450; ++i) simulation.step();
  EXPECT_NEAR(simulation.groundTruth().linear_velocity_mps.x(), 0.5, 1e-2);
  for (int i = 0; i < 700; ++i) simulation.step();
  EXPECT_NEAR(simulation.groundTruth().linear_velocity_mps.x(), 0.0, 1e-3);
}

TEST(Simulation, CommandsAreClampedToSpeedAndAcceleration) {
  Simulation simulation = inRoom(withoutErrors());
  obey(simulation, {1e9, 0.0, 0.0}, 0.5);
  EXPECT_NEAR(simulation.groundTruth().linear_velocity_mps.x(), 0.5, 0.02);  // 1 m/s^2
  obey(simulation, {1e9, 0.0, 0.0}, 2.0);
  EXPECT_NEAR(simulation.groundTruth().linear_velocity_mps.x(), 1.5, 0.01);
  obey(simulation, {0.0, 0.0, -1e9}, 3.0);
  EXPECT_NEAR(simulation.groundTruth().angular_velocity_radps.z(), -3.0, 0.02);
}

TEST(Simulation, ACommandThatIsNotFiniteIsRefusedAndStopsTheRobot) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const Twist2& bad : {Twist2{kNan, 0, 0}, Twist2{0, 0, kNan}, Twist2{kInfinity, 0, 0}}) {
    Simulation simulation = inRoom(withoutErrors());
    obey(simulation, {0.4, 0.0, 0.0}, 1.0);
    EXPECT_THROW(simulation.command(bad), std::invalid_argument);
    for (int i = 0; i < 480; ++i) simulation.step();
    EXPECT_NEAR(simulation.groundTruth().linear_velocity_mps.norm(), 0.0, 0.01);
  }
}

TEST(Simulation, OdometryWithoutErrorsIsTheTruthToATick) {
  SimulationParameters parameters = withoutErrors();
  parameters.odometry.ticks_per_turn = 100000;
  Simulation simulation = inRoom(parameters);
  const Pose2 start = toPose2(simulation.groundTruth().world_from_base);
  Outputs last;
  for (int i = 0; i < 8000; ++i) {
    simulation.command({0.6, 0.0, 0.5});
    const Outputs outputs = simulation.step();
    if (outputs.odometry) last = outputs;
  }
  ASSERT_EQ(last.ground_truth->stamp_ns, last.odometry->stamp_ns);
  const Pose2 truth = toPose2(last.ground_truth->world_from_base);
  const Pose2 estimate = start * last.odometry->odom_from_base;
  EXPECT_NEAR(estimate.x_m, truth.x_m, 1e-3);
  EXPECT_NEAR(estimate.y_m, truth.y_m, 1e-3);
  EXPECT_NEAR(wrapAngle(estimate.yaw_rad - truth.yaw_rad), 0.0, 1e-3);
}

TEST(Simulation, ATeleportIsSeenByTheLidarAndNotByTheOdometry) {
  SimulationParameters parameters = withoutErrors();
  parameters.lidar.range_sigma_m = parameters.lidar.far_range_sigma_m = 0.0;
  Simulation simulation = inRoom(parameters);
  obey(simulation, {}, 0.1);
  simulation.setPose({4.0, 5.0, 0.0});
  Outputs last;
  for (int i = 0; i < 200; ++i) {
    const Outputs outputs = simulation.step();
    if (outputs.scan) last.scan = outputs.scan;
    if (outputs.odometry) last.odometry = outputs.odometry;
  }
  EXPECT_NEAR(last.odometry->odom_from_base.x_m, 0.0, 1e-6);
  EXPECT_NEAR(last.scan->ranges_m[540], 20.0 - 4.0 - 0.2, 2e-3);  // the laser sits 0.2 m ahead
}

TEST(Simulation, NothingThatIsPublishedIsNan) {
  Simulation simulation = inRoom({});
  for (int i = 0; i < 20000; ++i) {
    simulation.command({(i / 4000) % 2 == 0 ? 1.5 : -1.5, 0.0, (i / 3000) % 3 - 1.0});
    const Outputs outputs = simulation.step();
    if (outputs.odometry) {
      ASSERT_TRUE(
          std::isfinite(outputs.odometry->odom_from_base.x_m + outputs.odometry->twist.turn_radps));
      ASSERT_TRUE(outputs.odometry->covariance.allFinite());
      ASSERT_TRUE(outputs.ground_truth->world_from_base.matrix().allFinite());
    }
    if (outputs.scan) {
      ASSERT_EQ(outputs.scan->ranges_m.size(), 1081U);
      for (const float range : outputs.scan->ranges_m) ASSERT_FALSE(std::isnan(range));
    }
  }
}

TEST(Simulation, FinishesATourAndSaysSo) {
  Tour tour;
  tour.waypoints_m = {{10.0, 5.0}, {13.0, 5.0}, {13.0, 7.0}};
  Simulation simulation({}, shippedRobot(), makeRoom(20.0, 10.0), tour);
  for (int i = 0; i < 30000 && simulation.tourProgress() < 1.0; ++i) simulation.step();
  EXPECT_EQ(simulation.tourProgress(), 1.0);
  const Pose2 end = toPose2(simulation.groundTruth().world_from_base);
  EXPECT_NEAR(std::hypot(end.x_m - 13.0, end.y_m - 7.0), 0.0, 0.1);
}

TEST(Simulation, RefusesBadParametersByName) {
  const auto refusal = &testing::refusalOfSpoiled<SimulationParameters>;
  using ::testing::HasSubstr;
  EXPECT_THAT(refusal([](SimulationParameters& p) { p.seed = -1; }), HasSubstr("seed"));
  EXPECT_THAT(refusal([](SimulationParameters& p) { p.physics_rate_hz = 10; }),
              HasSubstr("physics_rate_hz"));
  EXPECT_THAT(refusal([](SimulationParameters& p) { p.odometry_rate_hz = 0; }),
              HasSubstr("odometry_rate_hz"));
  EXPECT_THAT(refusal([](SimulationParameters& p) { p.drive.command_timeout_s = 0; }),
              HasSubstr("drive/command_timeout_s"));
  EXPECT_THAT(refusal([](SimulationParameters& p) { p.drive.max_speed_mps = std::nan(""); }),
              HasSubstr("drive/max_speed_mps"));
}

}  // namespace
}  // namespace ramscout_sim
