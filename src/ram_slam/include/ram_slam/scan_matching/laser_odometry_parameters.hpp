// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/calibration/lidar_calibration.hpp"
#include "ram_slam/calibration/stamp_offset.hpp"
#include "ram_slam/calibration/wheel_bias.hpp"
#include "ram_slam/calibration/wheel_scatter.hpp"
#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/scan_matching/pose_hypotheses.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/scan_matching/surface_scan.hpp"

namespace ram_slam {

/// When scans overrule the wheels.
struct SlipParameters {
  double deviations = 4.0;               ///< beyond so many standard deviations the wheels slip
  double prior_variance_factor = 100.0;  ///< by which the variance of slipping wheels grows
  double probability = 0.01;             ///< of a slip between two scans
  double continued_probability = 0.5;    ///< the same after a slip
  /// Beyond this share of contradicting readings a scan does not belong to the key scans; it is no
  /// key scan until so many in a row do not: then the robot was carried away, or all is new.
  double contradiction = 0.2;
  int contradicting_scans = 3;
  /// Scans that show a motion beyond this and beyond the time at the two greatest speeds, while the
  /// wheels do not: the robot was carried away, or the scan was matched with the wrong walls.
  MotionGate jump{0.05, 0.05};
  double max_speed_mps = 2.0;
  double max_turn_speed_radps = 4.0;
  MotionGate standing{0.001, 0.001};  ///< wheels that move no farther than this stand still
  MotionGate stuck{0.15, 0.15};       ///< the wheels are stuck if the robot moves farther meanwhile

  static const ram_parameters::ParameterTable<SlipParameters>& table();
};

/// Motion that is expected of a robot without wheel odometry: that of the interval before.
struct ConstantSpeedParameters {
  double rest_deviation_m = 0.01;
  double rest_deviation_rad = 0.01;
  double max_interval_ratio =
      3.0;  ///< the motion before is continued over so many of its intervals

  static const ram_parameters::ParameterTable<ConstantSpeedParameters>& table();
};

/// Settings of LaserOdometry.
struct LaserOdometryParameters {
  std::string odom_frame = "odom";       ///< what the node calls the frame of its estimate
  std::string base_frame = "base_link";  ///< and of the robot's base
  bool use_wheels = true;                ///< false: the node does not wait for wheel odometry
  SurfaceParameters surfaces;
  ScanMatcherParameters matcher;
  double key_scan_distance_m = 0.3;    ///< a new key scan after so much motion
  double key_scan_angle_rad = 0.3;     ///< or so much turning
  double key_scan_inlier_ratio = 0.6;  ///< or when so little of the scan is seen in the last ones
  int key_scan_count = 20;             ///< how many key scans are kept
  int reference_count = 3;             ///< with how many of them a scan is matched
  double max_reference_distance_m = 50.0;  ///< from the newest; beyond a jump nothing overlaps
  /// Standard deviation of the wheels' motion: at rest, per metre driven and per radian turned.
  double wheel_rest_deviation_m = 0.01;
  double wheel_rest_deviation_rad = 0.005;
  double wheel_distance_deviation_m_per_m = 0.1;
  double wheel_yaw_deviation_rad_per_m = 0.1;
  double wheel_yaw_deviation_rad_per_rad = 0.1;
  /// Offset between the stamps of wheels and scans that is learned (StampOffset); 0: none.
  double max_stamp_offset_s = 0.3;
  /// Greatest change of speed that is expected of a robot without wheel odometry.
  double acceleration_deviation_m_per_s2 = 1.0;
  double yaw_acceleration_deviation_rad_per_s2 = 2.0;
  /// Where scans are farther apart than twice this, the wheels' poses in between are given, too.
  double between_scans_s = 0.5;
  /// A match below this share of paired points is searched for around the prediction.
  double lost_inlier_ratio = 0.5;
  double search_distance_m = 0.5;
  double search_angle_rad = 0.5;
  SlipParameters slip;
  PoseLikelihoodParameters pose_likelihood;
  PoseSearchParameters pose_search;
  ConstantSpeedParameters constant_speed;
  WheelBiasParameters wheel_bias;
  WheelScatterParameters wheel_scatter;
  LidarCalibrationParameters lidar_calibration;
  StampOffsetParameters stamp_offset;

  static const ram_parameters::ParameterTable<LaserOdometryParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// \throws std::invalid_argument for an unknown key, a wrong type or a value out of bounds
LaserOdometryParameters readLaserOdometryParameters(ram_parameters::ParameterReader& reader);

}  // namespace ram_slam
