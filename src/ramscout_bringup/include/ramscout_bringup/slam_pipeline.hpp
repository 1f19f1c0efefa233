// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ram_slam/fast_slam/fast_slam.hpp"
#include "ram_slam/occupancy/occupancy_mapper.hpp"
#include "ramscout_bringup/recording.hpp"
#include "ramscout_bringup/results.hpp"
#include "ramscout_feature_detector/feature_detector.hpp"
#include "ramscout_kinematics/kinematics.hpp"

namespace ramscout_bringup {

/// Parameters of all cores, as the nodes read them.
struct SlamParameters {
  ramscout_feature_detector::FeatureDetectorParameters feature_detector;
  ramscout_kinematics::KinematicsParameters kinematics;
  ram_slam::FastSlamParameters fast_slam;
  ram_slam::OccupancyMapperParameters occupancy_mapper;
};

/// Reads `<node>.yaml` for each node from a folder such as config/.
/// \throws std::runtime_error if a file cannot be read
/// \throws std::invalid_argument if a parameter is refused
SlamParameters readSlamParameters(const std::string& folder);

/// The cores of the ROS graph in one process, fed in the order of the stamps.
///
/// As in the graph the scans set the pace: a scan is dealt with once odometry reaches its stamp, so
/// that the motion up to it is known. What a core refuses is left out and counted by reason, as a
/// node would log it.
class SlamPipeline {
public:
  /// \throws std::invalid_argument if a core refuses its parameters
  explicit SlamPipeline(const SlamParameters& parameters);

  void add(const OdometryReading& reading);
  void add(ScanReading reading);

  /// Deals with what is still waiting, and gives the final estimate and the map drawn from it. Call
  /// it once. \throws std::runtime_error if no scan could be used at all; the message says why
  Results finish();

private:
  void process(const ScanReading& reading);
  bool isKeyScan(const ram_slam::Pose2& map_from_laser);
  void leaveOut(const std::string& reason) { ++left_out_[reason]; }
  ram_slam::OccupancyGrid renderMap(const Trajectory& trajectory);

  SlamParameters parameters_;
  ramscout_feature_detector::FeatureDetector feature_detector_;
  ramscout_kinematics::Kinematics kinematics_;
  ram_slam::FastSlam fast_slam_;
  std::deque<ScanReading> waiting_;
  std::optional<std::int64_t> odometry_ns_;  ///< newest odometry
  std::vector<ScanReading> key_scans_;       ///< those that the map is drawn from
  std::optional<ram_slam::Pose2> last_key_;  ///< where the laser was at the newest of them
  Trajectory online_;
  std::size_t feature_count_ = 0;
  std::map<std::string, int> left_out_;
};

}  // namespace ramscout_bringup
