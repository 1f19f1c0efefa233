// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <vector>

#include "ram_slam/calibration/lidar_calibration.hpp"
#include "ram_slam/calibration/wheel_bias.hpp"
#include "ram_slam/calibration/wheel_scatter.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/motion/motion_noise.hpp"
#include "ram_slam/scan_matching/laser_odometry_parameters.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/scan_matching/surface_scan.hpp"
#include "ram_slam/sensing/laser_scan.hpp"

namespace ram_slam {

/// One step of laser odometry.
struct LaserOdometryEstimate {
  std::int64_t stamp_ns = 0;
  /// The base in the odometry frame; the covariance is that of all motion since the first scan.
  PoseWithCovariance2 odom_from_base;
  /// The base seen from where it was at the scan before, with the covariance of this motion alone.
  PoseWithCovariance2 motion;
  double inlier_ratio =
      0.0;  ///< share of the scan's points that met a surface of the last key scans
  /// The wheels stand still while the scans show a motion: their turns are not counted any more.
  bool wheels_stuck = false;
  bool wheels_slipped = false;  ///< the scans contradict the wheels beyond their deviation
  /// The scan contradicts the key scans wherever it is placed; the motion is that of the wheels.
  bool contradicts = false;
  bool searched = false;  ///< the scan's pose was searched for: its information counts little
  /// Standard deviations along the robot's heading and of the yaw by the scan alone; infinite if it
  /// shows nothing.
  double scan_deviation_m = std::numeric_limits<double>::infinity();
  double scan_deviation_rad = std::numeric_limits<double>::infinity();
  /// The scans show a motion that no robot makes, as when it is carried away: the motion is that of
  /// the wheels, and later scans are matched with this one and its followers.
  bool jumped = false;
};

/// Refines wheel odometry by scans, or replaces it: each scan is aligned with the last key scans.
///
/// Where the scan gives no information (along a corridor, in an empty hall) the wheels, or constant
/// speed, carry the pose on and the covariance grows. Where the scan contradicts the wheels (slip),
/// the scan wins. What the wheels get wrong again and again is learned (WheelBias) and taken out
/// before.
class LaserOdometry {
public:
  /// \throws std::invalid_argument as LaserOdometryParameters::validate()
  explicit LaserOdometry(const LaserOdometryParameters& parameters);

  /// \param odom_from_base  the pose by the wheels at the scan's stamp, if there are wheels
  /// \throws std::invalid_argument, the state untouched, if the scan cannot be used, a pose is not
  /// finite or the stamp
  ///         is not later than that of the scan before
  LaserOdometryEstimate update(const LaserScan& scan,
                               const Pose2& base_from_laser,
                               const std::optional<Pose2>& odom_from_base);

  /// What was learned about the lidar: the next scan is to be corrected by it.
  const LidarCalibration& lidarCalibration() const { return lidar_calibration_; }

  /// The wheels' pose at the last scan, if it is another than the one that came with it: the next
  /// motion of the wheels begins there.
  void replaceWheels(const std::optional<Pose2>& odom_from_base);

private:
  struct KeyScan {
    SurfaceScan surfaces;
    Pose2 odom_from_laser;
    std::optional<Eigen::Vector3d> velocity = {};  ///< of the laser [m/s, m/s, rad/s], in its axes
    double added_mirror_turn_s = 0.0;              ///< by which the scan was corrected
    LidarCalibration::Timing timing = {};          ///< known if the velocity is
  };
  /// Where a motion began that both wheels and scans measure.
  struct Interval {
    Pose2 wheels;
    Pose2 observed;
  };
  struct Prediction {
    Pose2 motion;
    /// As stated, in the axes of the base before the motion.
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    /// With the scatter that was learned; as stated if the scan contradicts that.
    Eigen::Matrix3d believed = Eigen::Matrix3d::Zero();
  };

  LaserOdometryEstimate begin(const LaserScan& scan,
                              const Pose2& base_from_laser,
                              const std::optional<Pose2>& odom_from_base);
  Prediction predict(std::int64_t stamp_ns, const std::optional<Pose2>& odom_from_base) const;
  MotionNoise wheelNoise() const;
  ScanMatch match(const SurfaceScan& surfaces,
                  const Pose2& base_from_laser,
                  Prediction& prediction,
                  LaserOdometryEstimate& estimate) const;
  /// Whether the scan was matched where no robot can be by now, given where the wheels lead.
  bool isJump(const Pose2& odom_from_base,
              const Prediction& prediction,
              std::int64_t stamp_ns) const;
  /// Fuses the match with the prediction into the motion and the pose of `estimate`.
  void fuse(const ScanMatch& found,
            const Pose2& base_from_laser,
            const Prediction& prediction,
            LaserOdometryEstimate& estimate) const;
  /// Teaches the errors of the lidar by the scan and the key scans that it was aligned with.
  void learnLidar(const KeyScan& scan);
  void keepIfKeyScan(KeyScan scan, double inlier_ratio);
  /// Teaches bias and scatter of the wheels, once the robot has moved far enough since the last
  /// time.
  void learnWheels(const LaserOdometryEstimate& estimate, const std::optional<Pose2>& wheels);
  /// Of the readings of the wheels: true while they repeat one that they reached in motion.
  bool repeatsReading(const Pose2& odom_from_base) const;
  bool areStuck(const std::optional<Pose2>& wheels, const Pose2& odom_from_base);
  /// The key scans that a scan is aligned with, the newest first.
  std::vector<const KeyScan*> references() const;
  bool isKeyScan(const Pose2& odom_from_laser, double inlier_ratio) const;

  LaserOdometryParameters parameters_;
  PoseHypotheses::Settings hypotheses_;
  std::deque<KeyScan> key_scans_;
  std::optional<Pose2> last_wheels_;
  WheelBias wheel_bias_;
  WheelScatter wheel_scatter_;
  LidarCalibration lidar_calibration_;
  std::optional<Interval> interval_;  ///< the current one
  std::optional<Interval> standing_;  ///< since the wheels stand still
  LaserOdometryEstimate last_;
  double last_interval_s_ = 0.0;
  bool wheels_repeat_ = false;   ///< they moved, and now show the same pose again
  int contradicting_count_ = 0;  ///< scans in a row
  std::int64_t placed_ns_ = 0;   ///< of the last scan that contradicted nothing
};

}  // namespace ram_slam
