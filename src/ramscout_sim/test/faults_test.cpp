// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/faults.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <gmock/gmock.h>

#include "ramscout_sim/simulation.hpp"

#include "shared.hpp"
#include "temporary_folder.hpp"

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

/// In a room of 8 x 5 m, in its middle.
Simulation robotInRoom(std::vector<Door> doors = {}) {
  World room = testing::makeRoom(8.0, 5.0);
  room.doors = std::move(doors);
  SimulationParameters p = perfect();
  p.lidar.range_sigma_m = 0.0;
  p.lidar.far_range_sigma_m = 0.0;
  return {p, testing::shippedRobot(), room, std::nullopt};
}

Scan nextScan(Simulation& simulation) {
  while (true) {
    const Outputs outputs = simulation.step();
    if (outputs.scan) return *outputs.scan;
  }
}

std::string refusalOf(Simulation& simulation, const Fault& f) {
  try {
    simulation.inject(f);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Faults, AKidnappingIsSeenByTheLidarAndNotByTheOdometry) {
  Simulation simulation = robotInRoom();
  drive(simulation, 0.5);
  Fault kidnap = fault(FaultKind::kKidnap, 1.0);
  kidnap.pose = {2.0, 1.5, M_PI};
  const OdometryReading before = drive(simulation, 0.02).odometry;
  simulation.inject(kidnap);
  const Drive after = drive(simulation, 0.05);
  EXPECT_NEAR(toPose2(simulation.groundTruth().world_from_base).x_m, 2.0, 0.01);
  EXPECT_NEAR(after.odometry.odom_from_base.x_m, before.odom_from_base.x_m, 0.03);
  EXPECT_EQ(after.faults, 1);
  Fault into_wall = kidnap;
  into_wall.pose = {8.0, 2.5, 0.0};
  EXPECT_THAT(refusalOf(simulation, into_wall), ::testing::HasSubstr("solid"));
}

TEST(Faults, AnImpossibleOneOfATimelineIsReportedAndTheRunGoesOn) {
  Simulation simulation = robotInRoom();
  Fault kidnap = fault(FaultKind::kKidnap, 1.0);
  kidnap.start_s = 0.1;
  kidnap.pose = {8.0, 2.5, 0.0};
  simulation.inject(kidnap);
  std::vector<RefusedFault> refused;
  for (int i = 0; i < 300; ++i) {
    const Outputs outputs = simulation.step();
    refused.insert(refused.end(), outputs.refused_faults.begin(), outputs.refused_faults.end());
    EXPECT_TRUE(outputs.started_faults.empty());
  }
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_THAT(refused[0].reason, ::testing::HasSubstr("solid"));
}

TEST(Faults, ALiftedRobotFindsItselfElsewhereWithoutHavingDriven) {
  Simulation simulation = robotInRoom();
  drive(simulation, 0.2);
  Fault lift = fault(FaultKind::kLift, 1.0, 0.3);
  lift.pose = {2.0, 1.5, M_PI_2};
  simulation.inject(lift);
  const OdometryReading start = drive(simulation, 0.1).odometry;
  const OdometryReading end = drive(simulation, 0.8).odometry;
  EXPECT_NEAR(end.odom_from_base.x_m, start.odom_from_base.x_m, 1e-3) << "the wheels stand";
  drive(simulation, 0.2);
  const Pose2 pose = toPose2(simulation.groundTruth().world_from_base);
  EXPECT_NEAR(pose.x_m, 2.0, 0.02);
  EXPECT_NEAR(pose.yaw_rad, M_PI_2, 0.02);
}

TEST(Faults, AClockOffsetIsInTheStampsOfTheScansOnly) {
  Simulation simulation = robotInRoom();
  const std::int64_t before_ns = nextScan(simulation).stamp_ns;
  simulation.inject(fault(FaultKind::kClockOffset, 0.1, 0.25));
  EXPECT_EQ(nextScan(simulation).stamp_ns - before_ns, 25'000'000 + 250'000'000);
  drive(simulation, 0.2);
  const std::int64_t after_ns = nextScan(simulation).stamp_ns;
  EXPECT_EQ((after_ns - before_ns) % 25'000'000, 0);
  EXPECT_LT(after_ns, simulation.now_ns());
}

TEST(Faults, ATiltedLidarSeesTheFloor) {
  Simulation simulation = robotInRoom();
  simulation.inject(fault(FaultKind::kLidarTilt, 1.0, 0.2));
  nextScan(simulation);
  const Scan scan = nextScan(simulation);
  EXPECT_NEAR(scan.ranges_m[540], 0.37 / std::sin(0.2), 0.02);
}

TEST(Faults, ABlockedWheelMakesTheRobotTurnAboutIt) {
  Simulation simulation = robotOnFloor();
  simulation.inject(fault(FaultKind::kLeftWheelBlocked, 100.0));
  drive(simulation, 1.0);
  EXPECT_GT(toPose2(simulation.groundTruth().world_from_base).yaw_rad, 0.3);
}

TEST(Faults, SlipOfOneWheelTurnsTheOdometryOnly) {
  Simulation simulation = robotOnFloor();
  simulation.inject(fault(FaultKind::kRightWheelSlip, 100.0, 0.3));
  const Drive result = drive(simulation, 2.0);
  EXPECT_GT(result.odometry.odom_from_base.yaw_rad, 0.1);
  EXPECT_NEAR(toPose2(simulation.groundTruth().world_from_base).yaw_rad, 0.0, 1e-6);
}

TEST(Faults, OnIceTheWheelsSpinAndAfterwardsTheyGripAgain) {
  Simulation simulation = robotOnFloor();
  simulation.inject(fault(FaultKind::kFloorFriction, 1.0, 0.0));
  const Drive on_ice = drive(simulation, 0.9);
  EXPECT_NEAR(simulation.groundTruth().world_from_base.translation().x(), 0.0, 0.01);
  EXPECT_GT(on_ice.odometry.odom_from_base.x_m, 0.2);
  drive(simulation, 1.0);
  EXPECT_GT(simulation.groundTruth().world_from_base.translation().x(), 0.2);
}

TEST(Faults, APayloadIsFeltByTheMotorsAndGoesAgain) {
  Simulation simulation = robotOnFloor();
  simulation.inject(fault(FaultKind::kPayload, 1.0, 500.0));
  drive(simulation, 1.0);
  // Two motors of 5 Nm on wheels of 0.1 m push 522 kg and 1 kg of spinning wheels.
  const double loaded_m = 0.5 * 100.0 / 523.0;
  EXPECT_NEAR(simulation.groundTruth().world_from_base.translation().x(), loaded_m,
              0.05 * loaded_m);
  drive(simulation, 2.0);
  EXPECT_NEAR(simulation.groundTruth().linear_velocity_mps.x(), 0.5, 1e-3);
}

TEST(Faults, APayloadBesideTheRobotOrOfNegativeMassIsRefused) {
  Fault payload = fault(FaultKind::kPayload, 1.0, 10.0);
  EXPECT_NO_THROW(payload.validate());
  payload.pose.x_m = 6.0;
  EXPECT_THROW(payload.validate(), std::invalid_argument);
  payload.pose.x_m = 0.0;
  payload.amount = -1.0;
  EXPECT_THROW(payload.validate(), std::invalid_argument);
}

TEST(Faults, AShoveMovesTheRobotSidewaysOnceItBeatsTheFriction) {
  Simulation simulation = robotOnFloor();
  simulation.inject(fault(FaultKind::kShove, 0.5, 50.0));
  drive(simulation, 0.6);
  EXPECT_NEAR(simulation.groundTruth().world_from_base.translation().y(), 0.0, 0.01);
  simulation.inject(fault(FaultKind::kShove, 0.5, 400.0));
  drive(simulation, 0.6);
  EXPECT_GT(simulation.groundTruth().world_from_base.translation().y(), 0.1);
}

TEST(Faults, AnImpossibleForceEndsTheRunAndPublishesNothing) {
  Simulation simulation = robotOnFloor();
  drive(simulation, 0.1);
  simulation.inject(fault(FaultKind::kShove, 1.0, 1e300));
  EXPECT_THROW(
      {
        for (int i = 0; i < 1000; ++i) {
          const Outputs outputs = simulation.step();
          if (outputs.ground_truth) {
            ASSERT_TRUE(outputs.ground_truth->world_from_base.matrix().allFinite());
          }
        }
      },
      std::runtime_error);
}

TEST(Faults, APersonAppearsWalksAndVanishes) {
  Simulation simulation = robotInRoom();
  const float free_m = nextScan(simulation).ranges_m[540];
  Fault person = fault(FaultKind::kPerson, 0.5, 1.0);
  person.pose = {6.0, 2.5, 0.0};
  simulation.inject(person);
  nextScan(simulation);
  const Scan seen = nextScan(simulation);
  EXPECT_LT(*std::min_element(seen.ranges_m.begin() + 500, seen.ranges_m.begin() + 580), 2.0F);
  for (int i = 0; i < 600; ++i) simulation.step();
  nextScan(simulation);
  EXPECT_NEAR(nextScan(simulation).ranges_m[540], free_m, 0.1);
}

TEST(Faults, ADoorClosesOnCommandIsSeenAndStopsTheRobot) {
  Door door;
  door.name = "middle";
  door.hinge_m = {6.0, 2.0};
  door.closed_yaw_rad = M_PI_2;
  door.open_angle_rad = -M_PI_2;
  door.turn_speed_radps = 3.0;
  door.openness = 1.0;
  Simulation simulation = robotInRoom({door});
  const float open_m = nextScan(simulation).ranges_m[540];
  Fault close = fault(FaultKind::kDoor, 1.0, 0.0);
  close.target = "middle";
  simulation.inject(close);
  for (int i = 0; i < 800; ++i) simulation.step();
  EXPECT_NEAR(open_m, 8.0 - 4.2, 0.01);
  EXPECT_NEAR(nextScan(simulation).ranges_m[540], 6.0 - 4.2 - 0.02, 0.01);
  drive(simulation, 6.0);
  EXPECT_NEAR(toPose2(simulation.groundTruth().world_from_base).x_m, 6.0 - 0.02 - 0.3, 0.01);
  EXPECT_TRUE(simulation.inCollision());
  close.target = "other";
  EXPECT_THAT(refusalOf(simulation, close), ::testing::HasSubstr("there are: middle"));
}

TEST(Faults, AreWrittenAsTheLineThatAFileCanHold) {
  const testing::TemporaryFolder folder;
  Fault f = fault(FaultKind::kLift, 2.5, 0.3);
  f.start_s = 12.25;
  f.pose = {1.5, -2.0, 0.25};
  Fault door = fault(FaultKind::kDoor, 1.0, 0.5);
  door.target = "a: b";
  const std::vector<Fault> copies = readFaults(
      folder.write("f.yaml", "faults:\n  - " + toYaml(f) + "\n  - " + toYaml(door) + "\n"));
  ASSERT_EQ(copies.size(), 2u);
  EXPECT_EQ(toYaml(copies[0]), toYaml(f));
  EXPECT_EQ(copies[0].pose.x_m, 1.5);
  EXPECT_EQ(copies[1].target, "a: b");
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
