// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/slam_pipeline.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "ramscout_bringup/evaluation.hpp"

#include "synthetic_drive.hpp"

namespace ramscout_bringup {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const SyntheticDrive& drive() {
  static const SyntheticDrive drive = driveAroundThePillar();
  return drive;
}

/// A folder of parameter files, each empty unless written to.
class ParameterFolder {
public:
  ParameterFolder() {
    fs::create_directory(path_);
    for (const char* node : {"laser_odometry", "feature_detector", "kinematics", "fast_slam",
                             "map_smoother", "occupancy_mapper"}) {
      write(node, "{}\n");
    }
  }
  ~ParameterFolder() { fs::remove_all(path_); }
  ParameterFolder(const ParameterFolder&) = delete;
  ParameterFolder& operator=(const ParameterFolder&) = delete;

  void write(const std::string& node, const std::string& yaml) const {
    std::ofstream(file(node)) << yaml;
  }
  std::string file(const std::string& node) const { return path_ + "/" + node + ".yaml"; }
  const std::string& path() const { return path_; }

private:
  std::string path_ = testing::TempDir() + "slam_pipeline_test";
};

SlamParameters defaults() {
  const ParameterFolder folder;
  SlamParameters parameters = readSlamParameters(folder.path());
  parameters.useBatchSettings();
  return parameters;
}

enum class Wheels { kUsed, kAbsent };

Results run(const SlamParameters& parameters, Wheels wheels, const SyntheticDrive& input) {
  SlamPipeline pipeline(parameters);
  for (std::size_t i = 0; i < input.scans.size(); ++i) {
    if (wheels == Wheels::kUsed) pipeline.add(input.wheels[i]);
    pipeline.add(input.scans[i]);
  }
  return pipeline.finish();
}

/// One run with the defaults, for the tests that look at different parts of it.
const Results& usualRun() {
  static const Results results = run(defaults(), Wheels::kUsed, drive());
  return results;
}

double positionRms(const Trajectory& trajectory) {
  return compareWithTruth(trajectory, drive().truth).position_m.rms;
}

/// How often a stage of a summary dropped something for a reason.
int dropCount(const Results& results, const std::string& stage, ram_slam::DropReason reason) {
  for (const auto& row : results.summary["left_out"][stage])
    if (row["reason"] == toText(reason)) return row["count"];
  return 0;
}

TEST(SlamPipeline, FindsTheWayAroundAPillarInSpiteOfWrongWheels) {
  const double wheels_m = positionRms(drive().wheels);
  EXPECT_GT(wheels_m, 0.05) << "the wheels shall need a correction";
  EXPECT_LT(positionRms(usualRun().trajectory), 0.02);
  EXPECT_LT(positionRms(usualRun().trajectory_online), 0.05);
  EXPECT_EQ(usualRun().trajectory.size(), drive().truth.size());
}

TEST(SlamPipeline, TheSummaryStatesWhatWasDriven) {
  const nlohmann::ordered_json& summary = usualRun().summary;
  EXPECT_EQ(summary["motion_from"], "odometry and scans");
  EXPECT_EQ(summary["poses"], drive().truth.size());
  EXPECT_NEAR(summary["duration_s"].get<double>(), 24.0, 1e-9);
  EXPECT_NEAR(summary["distance_m"].get<double>(), pathLength(drive().truth), 0.2);
  EXPECT_GT(summary["features_per_scan"].get<double>(), 1.0);
  EXPECT_EQ(summary["landmarks"], usualRun().landmarks.size());
  EXPECT_EQ(summary["clock_resets"], 0);
  EXPECT_EQ(summary["lidar"]["added_turn_time_s"]["value"], 0.0) << "it is as stated";
  EXPECT_EQ(summary["times_lost"], 0);
  EXPECT_EQ(summary["losses"].size(), 0U);
  EXPECT_EQ(summary["times_carried"], 0);
}

TEST(SlamPipeline, LeavesTheMapToContinueIt) {
  const ram_slam::WorldMap& world = usualRun().world;
  EXPECT_EQ(world.trajectory().size(), usualRun().trajectory.size());
  EXPECT_EQ(world.landmarks().landmarks.size(), usualRun().landmarks.size());
  EXPECT_EQ(world.occupancies().at("map")->grid.cells, usualRun().map.cells);
  // In the frame of the grid, and where the final trajectory has them.
  ASSERT_FALSE(world.scans().empty());
  for (const ram_slam::PlacedScan& placed : world.scans()) {
    const auto pose = ram_slam::poseAt(usualRun().trajectory, placed.scan.stamp_ns);
    ASSERT_TRUE(pose);
    EXPECT_NEAR(placed.map_from_base().x_m, pose->x_m, 1e-9);
    EXPECT_NEAR(placed.map_from_base().y_m, pose->y_m, 1e-9);
  }
}

TEST(SlamPipeline, MeasuresRatesMatchesFeaturesAndUncertaintyOverTheWholeDrive) {
  std::vector<std::string> names;
  for (const Measurement& measurement : usualRun().measurements) {
    names.push_back(measurement.name);
    const double covered_s = 1e-9 * static_cast<double>(measurement.samples.back().stamp_ns -
                                                        measurement.samples.front().stamp_ns);
    EXPECT_GT(covered_s, 20.0) << measurement.name;
    for (const Sample& sample : measurement.samples) EXPECT_GE(sample.value, 0.0) << names.back();
  }
  EXPECT_EQ(names, (std::vector<std::string>{"scans", "odometry", "scan points on known walls",
                                             "features per scan", "uncertainty of the position"}));
}

TEST(SlamPipeline, ClosuresAreAmongTheRunsPoses) {
  const Trajectory& poses = usualRun().trajectory;
  for (const ClosureRecord& closure : usualRun().closures) {
    EXPECT_TRUE(ram_slam::poseAt(poses, closure.old_stamp_ns)) << closure.old_stamp_ns;
    EXPECT_TRUE(ram_slam::poseAt(poses, closure.new_stamp_ns)) << closure.new_stamp_ns;
    EXPECT_GT(closure.new_stamp_ns, closure.old_stamp_ns);
  }
  const auto accepted =
      std::count_if(usualRun().closures.begin(), usualRun().closures.end(),
                    [](const ClosureRecord& closure) { return closure.is_accepted; });
  EXPECT_EQ(usualRun().summary["loop_closures"], accepted);
}

TEST(SlamPipeline, TheMapHasWallsWhereTheRoomHasThem) {
  const ram_slam::OccupancyGrid& map = usualRun().map;
  const ram_slam::Pose2 map_from_room =
      compareWithTruth(usualRun().trajectory, drive().truth).truth_from_map.inverse();
  const auto cellAt = [&](double x_m, double y_m) {
    const Eigen::Vector2d cell = map.map_from_grid.inverse() *
                                 Eigen::Vector2d(map_from_room * Eigen::Vector2d(x_m, y_m)) /
                                 map.resolution_m;
    return map.cells[map.index(static_cast<int>(cell.x()), static_cast<int>(cell.y()))];
  };
  EXPECT_EQ(cellAt(2.0, 0.0), ram_slam::kFreeCell);
  EXPECT_EQ(cellAt(-3.0, -2.0), ram_slam::kFreeCell);
  EXPECT_EQ(cellAt(0.05, 0.0), ram_slam::kUnknownCell) << "inside the pillar";
  int occupied = 0;
  for (double x_m = -3.5; x_m <= 3.5; x_m += 0.1) {
    int nearby = 0;
    for (const double off_m : {-0.05, 0.0, 0.05})
      nearby += cellAt(x_m, -3.0 + off_m) == ram_slam::kOccupiedCell ? 1 : 0;
    occupied += nearby > 0 ? 1 : 0;
  }
  EXPECT_GE(occupied, 68) << "of 71 places along the lower wall";
}

TEST(SlamPipeline, LandmarksLieAtCornersOfTheRoom) {
  const ram_slam::Pose2 room_from_map =
      compareWithTruth(usualRun().trajectory, drive().truth).truth_from_map;
  std::size_t near = 0;
  for (const MapLandmark& landmark : usualRun().landmarks) {
    const Eigen::Vector2d at = room_from_map * landmark.position_m;
    double nearest_m = 100.0;
    for (const Segment& wall : roomWithPillar())
      nearest_m = std::min(nearest_m, (wall.from_m - at).norm());
    near += nearest_m < 0.2 ? 1 : 0;
  }
  EXPECT_GE(usualRun().landmarks.size(), 4u);
  EXPECT_GE(10 * near, 8 * usualRun().landmarks.size());
}

TEST(SlamPipeline, TwoRunsGiveTheSameBytes) {
  const Results again = run(defaults(), Wheels::kUsed, drive());
  EXPECT_EQ(toTum(again.trajectory), toTum(usualRun().trajectory));
  EXPECT_EQ(toTum(again.trajectory_online), toTum(usualRun().trajectory_online));
  EXPECT_EQ(again.summary.dump(), usualRun().summary.dump());
  EXPECT_EQ(toYaml(again.landmarks), toYaml(usualRun().landmarks));
  EXPECT_EQ(again.pose_graph_g2o, usualRun().pose_graph_g2o);
  EXPECT_EQ(again.map.cells, usualRun().map.cells);
}

TEST(SlamPipeline, WithoutWheelsScansAloneGiveTheWay) {
  const Results results = run(defaults(), Wheels::kAbsent, drive());
  EXPECT_EQ(results.summary["motion_from"], "scans alone: there is no odometry");
  EXPECT_LT(positionRms(results.trajectory), 0.03);
  EXPECT_FALSE(results.summary.contains("calibration"));
}

TEST(SlamPipeline, WheelsAloneWithoutLaserOdometryGiveASmootherlessTrajectory) {
  SlamParameters parameters = defaults();
  parameters.use_laser_odometry = false;
  const Results results = run(parameters, Wheels::kUsed, drive());
  EXPECT_EQ(results.summary["motion_from"], "odometry alone");
  EXPECT_EQ(results.pose_graph_g2o, "");
  EXPECT_EQ(results.summary["loop_closures"], 0);
  EXPECT_LT(positionRms(results.trajectory), positionRms(drive().wheels));
}

TEST(SlamPipeline, WithoutSmoothingTheEstimatorsOwnTrajectoryIsTheFinalOne) {
  SlamParameters parameters = defaults();
  parameters.use_map_smoother = false;
  const Results results = run(parameters, Wheels::kUsed, drive());
  EXPECT_EQ(toTum(results.trajectory), toTum(results.trajectory_filter));
  EXPECT_EQ(results.pose_graph_g2o, "");
  EXPECT_LT(positionRms(results.trajectory), 0.05);
}

TEST(SlamPipeline, ScansOutOfOrderAreCountedAndLeaveTheResultAsItWas) {
  SlamPipeline pipeline(defaults());
  for (std::size_t i = 0; i < drive().scans.size(); ++i) {
    pipeline.add(drive().wheels[i]);
    pipeline.add(drive().scans[i]);
    if (i > 0 && i % 40 == 0) pipeline.add(drive().scans[i - 1]);
  }
  const Results results = pipeline.finish();
  EXPECT_EQ(dropCount(results, "odometry", ram_slam::DropReason::kNotLater), 3);
  EXPECT_EQ(toTum(results.trajectory), toTum(usualRun().trajectory));
}

TEST(SlamPipeline, UnusableReadingsAreCountedByReason) {
  SlamPipeline pipeline(defaults());
  for (std::size_t i = 0; i < 40; ++i) {
    ram_slam::StampedPose2 wheels = drive().wheels[i];
    if (i == 10) wheels.pose.x_m = std::nan("");
    pipeline.add(wheels);
    ram_slam::MountedScan scan = drive().scans[i];
    if (i == 20) scan.scan.ranges_m.clear();
    if (i == 30) scan.base_from_laser.yaw_rad = std::nan("");
    pipeline.add(std::move(scan));
  }
  const Results results = pipeline.finish();
  EXPECT_EQ(dropCount(results, "odometry", ram_slam::DropReason::kInvalidOdometry), 1);
  EXPECT_EQ(dropCount(results, "odometry", ram_slam::DropReason::kInvalidScan), 2);
  EXPECT_EQ(results.trajectory_online.size(), 38u);
}

TEST(SlamPipeline, AScanWithoutAnyOtherIsEnoughForAMap) {
  SlamPipeline pipeline(defaults());
  pipeline.add(drive().scans.front());
  const Results results = pipeline.finish();
  EXPECT_EQ(results.trajectory.size(), 1u);
  EXPECT_GT(results.map.width, 0);
  EXPECT_EQ(results.summary["distance_m"], 0.0);
}

TEST(SlamPipeline, ARecordingWithoutUsableScansIsAnErrorThatStatesWhy) {
  const auto refusalOf = [](SlamPipeline& pipeline) -> std::string {
    try {
      pipeline.finish();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "accepted";
  };
  SlamPipeline nothing(defaults());
  EXPECT_EQ(refusalOf(nothing), "the recording has no scan");
  SlamPipeline wheels_only(defaults());
  wheels_only.add(drive().wheels.front());
  EXPECT_EQ(refusalOf(wheels_only), "the recording has no scan");
  SlamPipeline empty_scans(defaults());
  ram_slam::MountedScan empty = drive().scans.front();
  empty.scan.ranges_m.clear();
  empty_scans.add(empty);
  EXPECT_THAT(refusalOf(empty_scans), HasSubstr("no scan could be used: unusable scan: "));
}

TEST(SlamPipeline, AClockThatIsSetBackIsCountedAndTheSecondDriveIsMapped) {
  SlamPipeline pipeline(defaults());
  for (std::size_t i = 60; i < 90; ++i) {
    pipeline.add(drive().wheels[i]);
    pipeline.add(drive().scans[i]);
  }
  for (std::size_t i = 0; i < 30; ++i) {
    pipeline.add(drive().wheels[i]);
    pipeline.add(drive().scans[i]);
  }
  const Results results = pipeline.finish();
  EXPECT_EQ(results.summary["clock_resets"], 1);
  EXPECT_EQ(results.trajectory.front().stamp_ns, drive().truth.front().stamp_ns);
  EXPECT_EQ(results.trajectory.size(), 30u);
}

TEST(ReadSlamParameters, EmptyFilesGiveTheDefaults) {
  const SlamParameters parameters = defaults();
  EXPECT_EQ(parameters.laser_odometry.use_wheels, ram_slam::LaserOdometryParameters{}.use_wheels);
  EXPECT_EQ(parameters.map_smoother.optimize_period_s, 0.0) << "a batch setting";
  EXPECT_EQ(parameters.occupancy_mapper.max_scan_count, 10'000'000);
}

TEST(ChangedParametersOfAFolder, AreThoseOfTheFilesThatARunReads) {
  const ParameterFolder folder;
  EXPECT_TRUE(changedParameters(folder.path(), "fast_slam").empty());
  folder.write("fast_slam", "{particle_amount: 11}");
  folder.write("laser_odometry", "{use_wheels: true}");
  const auto changed = changedParameters(folder.path(), "fast_slam");
  ASSERT_EQ(changed.size(), 1U);
  EXPECT_EQ(changed[0].file, "fast_slam.yaml");
  EXPECT_EQ(changed[0].key, "particle_amount");
  EXPECT_EQ(changed[0].value, "11");
}

TEST(ReadSlamParameters, NamesTheFileThatIsMissingAndTheParameterThatIsRefused) {
  const ParameterFolder folder;
  const auto messageOf = [&](const std::string& estimator) -> std::string {
    try {
      readSlamParameters(folder.path(), estimator);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(messageOf("fast_slam"), "accepted");
  folder.write("kalman", "{}");
  EXPECT_THAT(messageOf("kalman"), HasSubstr("fast_slam")) << "the estimator that is known";
  folder.write("kinematics", "{modle: 1}");
  EXPECT_THAT(messageOf("fast_slam"), HasSubstr(folder.file("kinematics") + ": unknown parameter"));
  fs::remove(folder.file("kinematics"));
  EXPECT_THAT(messageOf("fast_slam"), HasSubstr("cannot read " + folder.file("kinematics")));
}

}  // namespace
}  // namespace ramscout_bringup
