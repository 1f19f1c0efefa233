// SPDX-License-Identifier: BSD-3-Clause
// Recordings, trajectories and relations.
#include <ramscout_bringup/evaluation.hpp>
#include <ramscout_bringup/trajectory_file.hpp>
#include <rosbag/bag.h>

#include "ram_slam/io/atomic_file.hpp"

#include "../../ros/ros_recording.hpp"
#include "../recorded_bytes.hpp"
#include "../recorded_drive.hpp"
#include "fuzz_target.hpp"

namespace ramscout_bringup_ros {
namespace {

void readRecording(const std::string& path) {
  const auto recording = openRecording(path, {});
  while (recording->next()) continue;
}

std::string bagSeed(rosbag::CompressionType compression) {
  const std::string path = fuzzPath("seed.bag");
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  bag.setCompression(compression);
  bag.write("/tf_static", time(0.0), transform("base_link", "laser", 0.0, 0.2));
  for (int i = 0; i < 3; ++i) {
    bag.write("/odom", time(i), odometry(i, 0.5 * i));
    bag.write("/scan", time(i), scan(i));
  }
  bag.close();
  return ram_slam::readWholeFile(path);
}

std::vector<std::string> mcapSeeds() {
  const Bytes third = messageRecord(3, scanBytes(3));
  const Bytes plain =
      beginning() + messageRecord(1, scanBytes(1)) +
      chunk("", messageRecord(2, scanBytes(2)), messageRecord(2, scanBytes(2)).size());
  return {plain + record(15, Bytes(4, '\0')), plain + chunk("zstd", zstd(third), third.size()),
          plain + chunk("lz4", lz4(third), third.size())};
}

std::string databaseSeed() {
  const std::string path = fuzzPath("seed.db3");
  writeDatabase(path, {{2, 50, scanBytes(6)},
                       {1, 100, odometryBytes()},
                       {2, 150, scanBytes(7)},
                       {2, 200, scanBytes(8)}});
  return ram_slam::readWholeFile(path);
}

const char* const kCarmenLog =
    "# a comment\nPARAM robot_frontlaser_offset 0.1\nODOM 9 9 9 0 0 0 1.0 host 0.1\n"
    "FLASER 4 1.0 1.1 81.9 0.9 2.0 0.0 1.0 1.9 0.0 1.0 1.0 host 0.5\n"
    "FLASER 4 1.0 1.2 81.9 0.8 2.1 0.0 1.0 2.0 0.0 1.0 1.2 host 0.7\n"
    "ROBOTLASER1 0 -1.57 3.14 1.57 10.0 0.01 0 3 1.0 2.0 1.5 0 2.2 0.0 1.0 2.1 0.0 1.0 0 0 0 0 0 "
    "1.4 host 0.9\n";

}  // namespace

std::vector<FuzzTarget> recordingTargets() {
  using namespace ramscout_bringup;
  const Trajectory trajectory = {{1'000'000'000, {0.0, 1.0, 0.5}},
                                 {2'000'000'000, {0.5, 1.0, 3.1}}};
  return {
      fileTarget("drive.bag",
                 {bagSeed(rosbag::compression::Uncompressed), bagSeed(rosbag::compression::LZ4),
                  bagSeed(rosbag::compression::BZ2)},
                 readRecording),
      fileTarget("drive.mcap", mcapSeeds(), readRecording),
      fileTarget("drive.db3", {databaseSeed()}, readRecording),
      fileTarget("drive.log", {kCarmenLog}, readRecording),
      fileTarget("trajectory.tum", {"# stamp x y z qx qy qz qw\n" + toTum(trajectory)},
                 [](const std::string& path) { readTrajectory(path); }),
      fileTarget("drive.relations", {"# t1 t2\n1.5 20.25 1.0 2.0 0 0 0 1.5\n2 3 -1 0 0 0 0 -3.1\n"},
                 [](const std::string& path) { readRelations(path); }),
  };
}

}  // namespace ramscout_bringup_ros
