// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ram_slam/calibration/stamp_offset.hpp"
#include "ram_slam/motion/gap_bridge.hpp"
#include "ram_slam/occupancy/occupancy_mapper.hpp"
#include "ram_slam/scan_matching/laser_odometry.hpp"
#include "ram_slam/smoothing/map_smoother.hpp"
#include "ram_slam/tracking/tracker.hpp"
#include "ramscout_bringup/recording.hpp"
#include "ramscout_bringup/results.hpp"
#include "ramscout_feature_detector/feature_detector.hpp"
#include "ramscout_kinematics/kinematics.hpp"

namespace ramscout_bringup {

/// Parameters of all cores, as the nodes read them, and which of the optional cores take part.
struct SlamParameters {
  ram_slam::LaserOdometryParameters laser_odometry;
  ramscout_feature_detector::FeatureDetectorParameters feature_detector;
  ramscout_kinematics::KinematicsParameters kinematics;
  ram_slam::FastSlamParameters fast_slam;
  ram_slam::RecoveryParameters recovery;
  ram_slam::MapSmootherParameters map_smoother;
  ram_slam::OccupancyMapperParameters occupancy_mapper;
  bool use_laser_odometry = true;  ///< off: the kinematic model is fed by the wheels as they are
  bool use_map_smoother = true;    ///< off: the final trajectory is the estimator's best particle's
};

/// Reads `<node>.yaml` for each node from a folder such as config/.
/// \throws std::runtime_error if a file cannot be read
/// \throws std::invalid_argument if a parameter is refused
SlamParameters readSlamParameters(const std::string& folder);

/// The cores of the ROS graph in one process, fed in the order of the stamps.
///
/// As in the graph the scans set the pace: a scan is dealt with once odometry reaches its stamp, so
/// that the motion up to it is known. Without any odometry the scans alone tell the motion. What a
/// core refuses is left out and counted by reason, as a node would log it.
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
  /// The odometry's pose at a stamp, between the readings around it or that of the last one before
  /// it.
  std::optional<ram_slam::Pose2> wheelsAt(std::int64_t stamp_ns) const;
  void feedKinematics(std::int64_t stamp_ns, const ram_slam::Pose2& odom_from_base);
  void refineOdometry(const ScanReading& reading);
  /// Whether the robot has moved since the filter's last reading so far that it would learn from
  /// another one. The node takes every reading, which costs more and averages their noise.
  bool teachesFilter(std::int64_t stamp_ns) const;
  void updateFilter(const ScanReading& reading);
  /// The filter's estimate, moved on to a stamp.
  ram_slam::Pose2 poseNow(std::int64_t stamp_ns) const;
  bool smooths() const { return parameters_.use_laser_odometry && parameters_.use_map_smoother; }
  /// Lets the filter know of closures that the smoother has found since.
  void followSmoother();
  void smooth(Results& results);
  /// What the drive tells about the laser's mount and the wheels, for the summary.
  nlohmann::ordered_json calibration() const;
  bool isKeyScan(const ram_slam::Pose2& map_from_laser);
  void leaveOut(const std::string& reason) { ++left_out_[reason]; }
  ram_slam::OccupancyGrid renderMap(const Trajectory& trajectory);

  SlamParameters parameters_;
  ram_slam::LaserOdometry laser_odometry_;
  ram_slam::StampOffset stamp_offset_;
  ramscout_feature_detector::FeatureDetector feature_detector_;
  ramscout_kinematics::Kinematics kinematics_;
  ram_slam::GapBridge motion_;
  ram_slam::Tracker fast_slam_;
  ram_slam::MapSmoother map_smoother_;
  std::deque<ScanReading> waiting_;
  std::deque<ram_slam::StampedPose2> wheels_;  ///< the newest readings
  Trajectory all_wheels_;                      ///< as told, thinned
  std::vector<ScanReading> key_scans_;         ///< those that the map is drawn from
  std::optional<ram_slam::Pose2> last_key_;    ///< where the laser was at the newest of them
  Trajectory online_;
  std::size_t feature_count_ = 0;
  std::size_t list_count_ = 0;  ///< of features: readings that the filter was shown
  std::size_t slip_count_ = 0;
  int loop_closures_ = 0;
  int lost_count_ = 0;  ///< how often the estimator lost its place
  std::map<std::string, int> left_out_;
};

}  // namespace ramscout_bringup
