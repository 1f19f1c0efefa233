// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/calibration/wheel_bias.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/scan_matching/surface_scan.hpp"
#include "ram_slam/sensing/laser_scan.hpp"

namespace ram_slam {

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
  /// A match below this share of paired points is searched for around the prediction.
  double lost_inlier_ratio = 0.5;
  double search_distance_m = 0.5;
  double search_angle_rad = 0.5;

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// \throws std::invalid_argument for an unknown key, a wrong type or a value out of bounds
LaserOdometryParameters readLaserOdometryParameters(ram_parameters::ParameterReader& reader);

/// One step of laser odometry.
struct LaserOdometryEstimate {
  std::int64_t stamp_ns = 0;
  /// The base in the odometry frame; the covariance is that of all motion since the first scan.
  PoseWithCovariance2 odom_from_base;
  /// The base seen from where it was at the scan before, with the covariance of this motion alone.
  PoseWithCovariance2 motion;
  double inlier_ratio =
      0.0;  ///< share of the scan's points that met a surface of the last key scans
  /// The wheels stand still while the scans show a motion: nobody counts their turns any more.
  bool wheels_stuck = false;
  bool wheels_slipped = false;  ///< the scans contradict the wheels beyond their deviation
  /// And tell of a motion that no robot makes, as one that is carried away: the motion is that of
  /// the wheels, and later scans are matched with this one and its followers.
  bool jumped = false;
};

/// Refines wheel odometry by scans, or replaces it: each scan is aligned with the last key scans.
///
/// Where the scan says nothing (along a corridor, in an empty hall) the wheels, or constant speed,
/// carry the pose on and the covariance says so. Where the scan contradicts the wheels (slip), the
/// scan wins. What the wheels get wrong again and again is learned (WheelBias) and taken out
/// before.
class LaserOdometry {
public:
  /// \throws std::invalid_argument as LaserOdometryParameters::validate()
  explicit LaserOdometry(const LaserOdometryParameters& parameters);

  /// \param odom_from_base  what the wheels say at the scan's stamp, if there are wheels
  /// \throws std::invalid_argument, the state untouched, if the scan cannot be used, a pose is not
  /// finite or the stamp
  ///         is not later than that of the scan before
  LaserOdometryEstimate update(const LaserScan& scan,
                               const Pose2& base_from_laser,
                               const std::optional<Pose2>& odom_from_base);

private:
  struct KeyScan {
    SurfaceScan surfaces;
    Pose2 odom_from_laser;
  };
  /// A motion of which both wheels and scans tell, from where it began.
  struct Interval {
    Pose2 wheels;
    Pose2 observed;
  };
  struct Prediction {
    Pose2 motion;
    Eigen::Matrix3d covariance =
        Eigen::Matrix3d::Zero();  ///< in the axes of the base before the motion
  };

  Prediction predict(std::int64_t stamp_ns, const std::optional<Pose2>& odom_from_base) const;
  ScanMatch match(const SurfaceScan& surfaces,
                  const Pose2& base_from_laser,
                  const Prediction& prediction,
                  bool& slipped) const;
  std::optional<Pose2> search(const SurfaceScan& surfaces,
                              const Pose2& odom_from_laser,
                              double angle_rad) const;
  /// Teaches the bias of the wheels, once the robot has moved far enough since the last time.
  void learnBias(const LaserOdometryEstimate& estimate, const std::optional<Pose2>& wheels);
  bool areStuck(const std::optional<Pose2>& wheels, const Pose2& odom_from_base);
  std::vector<ReferenceScan> references() const;
  bool isKeyScan(const Pose2& odom_from_laser, double inlier_ratio) const;

  LaserOdometryParameters parameters_;
  std::deque<KeyScan> key_scans_;
  std::optional<Pose2> last_wheels_;
  WheelBias wheel_bias_;
  std::optional<Interval> interval_;  ///< that goes on
  std::optional<Interval> standing_;  ///< since the wheels stand still
  LaserOdometryEstimate last_;
  double last_interval_s_ = 0.0;
};

}  // namespace ram_slam
