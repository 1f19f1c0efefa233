// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/geometry/trajectory.hpp"

namespace ram_slam {

/// Settings of calibrateMount().
struct MountCalibrationParameters {
  MotionGate interval{0.5, 0.3};  ///< motion over which wheels and scans are compared
  double max_interval_s = 5.0;    ///< a motion that takes longer is not used
  int min_intervals = 20;         ///< fewer motions give no calibration
  int min_turns = 10;             ///< nor do fewer turns
  double turn_rad = 0.1;          ///< a motion with this angle is a turn
  double max_offset_s = 0.5;      ///< of the stamps, to each side
  double offset_step_s = 0.02;    ///< between the offsets that are tried
  double outlier_deviations =
      4.0;  ///< robust standard deviations beyond which a motion is left out
  /// Least robust standard deviation [m, rad]: motions that agree exactly have no outliers.
  double min_deviation = 1e-4;
  int rounds = 3;  ///< of a least squares fit, each without the outliers of the round before

  static const ram_parameters::ParameterTable<MountCalibrationParameters>& table();
};

/// The laser's mount and the scale errors of the wheels, as one drive shows them. Standard
/// deviations follow from how well the wheels' and the scans' motions agree; a large one means that
/// the drive did not show the quantity (a robot that never turns does not show where on it the
/// laser sits).
struct MountCalibration {
  Pose2 base_from_laser;
  /// True over measured distance, and true over measured turn, of the odometry.
  double distance_ratio = 1.0;
  double turn_ratio = 1.0;
  /// To be added to a scan's stamp to have the odometry's.
  double stamp_offset_s = 0.0;
  /// Of base_from_laser's x [m], y [m], yaw [rad].
  Eigen::Vector3d mount_sigma = Eigen::Vector3d::Zero();
  double distance_ratio_sigma = 0.0;
  double turn_ratio_sigma = 0.0;
  std::size_t interval_count = 0;  ///< motions that were compared
  std::size_t slip_count = 0;      ///< motions left out, as they do not fit the others
};

/// Finds the laser's mount, the odometry's scale errors and the offset between their stamps from
/// one drive: for each motion o of the odometry and l of the laser over the same time,
/// o' X = X l, where X = base_from_laser and o' is o with its scales corrected.
///
/// The turn ratio and the stamp offset come from the yaws alone; the rest is linear in the
/// translation of X, the distance ratio and (cos, sin) of X's yaw, and the norm of the latter is 1:
/// the smallest eigenvector of a 2 x 2 matrix (Censi, Franchi, Marchionni and Oriolo, IEEE
/// Transactions on Robotics 29(2), 2013). Motions that contradict the rest are left out.
///
/// \param odom_from_base   by the odometry, at stamps of its own
/// \param map_from_laser   the laser's way by its scans, such as the map smoother's
/// \return nothing if there are too few motions
/// \throws std::invalid_argument as validate(Trajectory)
std::optional<MountCalibration> calibrateMount(const Trajectory& odom_from_base,
                                               const Trajectory& map_from_laser,
                                               const MountCalibrationParameters& parameters = {});

}  // namespace ram_slam
