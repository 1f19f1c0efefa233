// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/scan_matching/point_to_line.hpp"
#include "ram_slam/scan_matching/surface_scan.hpp"

namespace ram_slam {

/// Settings of the alignment of one scan with others.
struct ScanMatcherParameters {
  double first_gate_m = 0.3;        ///< greatest distance of a pair in the first iteration
  double last_gate_m = 0.1;         ///< and in the last ones
  double min_normal_cosine = 0.8;   ///< of the angle between the normals of a pair
  double robust_scale_m = 0.03;     ///< residual at which a pair counts half (Cauchy)
  double range_deviation_m = 0.02;  ///< standard deviation of a reading across a wall
  double correlated_beams = 2.0;    ///< how many neighbouring readings share their error
  int max_iterations = 8;
  int max_points = 400;  ///< of the scan that are used, evenly spread
  /// A step below this ends the iteration, once the gate is the last one.
  MotionGate converged{1e-3, 3e-4};
  /// A first step below this means that the guess was good: the last gate is used at once.
  MotionGate good_guess{0.01, 0.005};
  double gate_shrink = 0.6;        ///< the gate of an iteration over that of the one before
  double max_search_beams = 12.0;  ///< to each side of a point's beam, among which its partner is

  /// Of the first iteration, all points of the scan.
  PairingLimits firstPairing() const;

  static const ram_parameters::ParameterTable<ScanMatcherParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// A scan that another one is aligned with.
struct ReferenceScan {
  const SurfaceScan* surfaces = nullptr;
  Pose2 map_from_laser;
};

/// What is known of a pose before the scan is used.
struct PosePrior {
  Pose2 map_from_laser;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< of x, y, yaw in the axes of the map
};

struct ScanMatch {
  Pose2 map_from_laser;
  /// Of x, y, yaw in the axes of the map, from the scan alone: (nearly) singular along a corridor.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double inlier_ratio = 0.0;  ///< pairs over points in view, best reference
  double deviation_m = 0.0;   ///< weighted root mean square of the residuals
};

/// The pose of a scan that agrees best with the reference scans and the prior, from a first guess:
/// Gauss-Newton on point-to-line distances with new pairs in each iteration.
ScanMatch matchScan(const SurfaceScan& scan,
                    const std::vector<ReferenceScan>& references,
                    const PosePrior& prior,
                    const Pose2& map_from_laser_guess,
                    const ScanMatcherParameters& parameters);

}  // namespace ram_slam
