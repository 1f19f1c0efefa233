// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/faults.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <gmock/gmock.h>

#include "ramscout_sim/simulation.hpp"

namespace ramscout_sim {
namespace {

SimulationParameters perfect() {
  SimulationParameters p;
  p.odometry.wheel_diameter_ratio = 1.0;
  p.odometry.track_ratio = 1.0;
  p.odometry.ticks_per_turn = 1000000;
  p.odometry.slip_distance_sigma_per_sqrt_m = 0.0;
  p.odometry.slip_yaw_sigma_rad_per_sqrt_m = 0.0;
  p.odometry.slip_yaw_sigma_rad_per_sqrt_rad = 0.0;
  return p;
}

Simulation robotOnFloor() {
  return {perfect(), readRobot(CONFIG_FOLDER "/robots/ramscout.urdf"), World(), std::nullopt};
}

Fault fault(FaultKind kind, double duration_s, double amount = 0.0) {
  Fault f;
  f.kind = kind;
  f.duration_s = duration_s;
  f.amount = amount;
  return f;
}

struct Drive {
  OdometryReading odometry;
  int scans = 0;
  int faults = 0;
};

/// Drives straight at 0.5 m/s.
Drive drive(Simulation& simulation, double duration_s) {
  Drive result;
  const std::int64_t end_ns = simulation.now_ns() + std::llround(duration_s * 1e9);
  while (simulation.now_ns() < end_ns) {
    simulation.command({0.5, 0.0, 0.0});
    const Outputs outputs = simulation.step();
    if (outputs.odometry) result.odometry = *outputs.odometry;
    result.scans += outputs.scan.has_value();
    result.faults += static_cast<int>(outputs.started_faults.size());
  }
  return result;
}

TEST(Faults, SlipMakesTheOdometryRunAheadByItsShare) {
  Simulation simulation = robotOnFloor();
  simulation.inject(fault(FaultKind::kWheelSlip, 100.0, 0.3));
  const Drive result = drive(simulation, 4.0);
  const double true_m = simulation.groundTruth().world_from_base.translation().x();
  EXPECT_GT(true_m, 1.0);
  EXPECT_NEAR(result.odometry.odom_from_base.x_m, 1.3 * true_m, 1e-3);
  EXPECT_EQ(result.faults, 1);
}

TEST(Faults, ADeadEncoderTurnsTheOdometryOnly) {
  Simulation simulation = robotOnFloor();
  simulation.inject(fault(FaultKind::kLeftEncoderDead, 100.0));
  const Drive result = drive(simulation, 2.0);
  EXPECT_NEAR(result.odometry.wheel_angles_rad[0], 0.0, 1e-5);
  EXPECT_GT(result.odometry.wheel_angles_rad[1], 5.0);
  EXPECT_NEAR(toPose2(simulation.groundTruth().world_from_base).yaw_rad, 0.0, 1e-6);
}

TEST(Faults, ADropOutHoldsForItsTime) {
  Simulation simulation = robotOnFloor();
  Fault later = fault(FaultKind::kScanDropout, 1.0);
  later.start_s = 1.0;
  simulation.inject(later);
  EXPECT_EQ(drive(simulation, 1.0).scans, 40);
  EXPECT_LE(drive(simulation, 1.0).scans, 1);
  EXPECT_GE(drive(simulation, 1.0).scans, 39);
}

TEST(Faults, AMaskedSectorReadsTooClose) {
  Simulation simulation = robotOnFloor();
  Fault sector = fault(FaultKind::kScanSector, 10.0);
  sector.angle_min_rad = -0.1;
  sector.angle_max_rad = 0.1;
  simulation.inject(sector);
  std::optional<Scan> scan;
  while (!scan) scan = simulation.step().scan;
  EXPECT_EQ(scan->ranges_m[540], -INFINITY);
  EXPECT_EQ(scan->ranges_m[440], INFINITY);
}

TEST(Faults, DeadMotorsLetTheRobotStand) {
  Simulation simulation = robotOnFloor();
  simulation.inject(fault(FaultKind::kMotorsDead, 2.0));
  drive(simulation, 2.0);
  EXPECT_NEAR(simulation.groundTruth().world_from_base.translation().x(), 0.0, 1e-3);
}

TEST(Faults, APushMovesTheRobotAndAResetOnlyItsOdometry) {
  Simulation simulation = robotOnFloor();
  drive(simulation, 2.0);
  const double before_m = simulation.groundTruth().world_from_base.translation().x();
  simulation.inject(fault(FaultKind::kPush, 0.0, 0.3));
  simulation.inject(fault(FaultKind::kOdometryReset, 0.0));
  const Drive result = drive(simulation, 0.02);
  EXPECT_NEAR(simulation.groundTruth().world_from_base.translation().y(), 0.3, 1e-3);
  EXPECT_NEAR(simulation.groundTruth().world_from_base.translation().x(), before_m, 0.02);
  EXPECT_LT(result.odometry.odom_from_base.x_m, 0.02);
  EXPECT_LT(result.odometry.covariance.norm(), 1e-4);
  EXPECT_EQ(result.faults, 2);
}

TEST(Faults, AreRefusedOutOfBoundsAndByName) {
  Simulation simulation = robotOnFloor();
  EXPECT_THROW(simulation.inject(fault(FaultKind::kWheelSlip, 0.0, 0.3)), std::invalid_argument);
  EXPECT_THROW(simulation.inject(fault(FaultKind::kWheelSlip, 1.0, NAN)), std::invalid_argument);
  EXPECT_THROW(simulation.inject(fault(FaultKind::kScanSector, 1.0)), std::invalid_argument);
  EXPECT_THROW(parseFaultKind("earthquake"), std::invalid_argument);
  EXPECT_EQ(parseFaultKind(toString(FaultKind::kPush)), FaultKind::kPush);
}

TEST(Faults, AreReadFromAFileThatNamesWhatIsWrong) {
  const std::string path = ::testing::TempDir() + "/ramscout_sim_faults_test.yaml";
  std::ofstream(path) << "faults: [{kind: push, start_s: 3, amount: 0.2}]";
  const std::vector<Fault> faults = readFaults(path);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].start_s, 3.0);
  for (const char* text :
       {"faults: 3", "faults: [{kind: quake}]", "faults: [{kind: push, start_s: -1}]",
        "faults: [{kind: push, force: 1}]", "fault: []", "["}) {
    std::ofstream(path) << text;
    EXPECT_ANY_THROW(readFaults(path)) << text;
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace ramscout_sim
