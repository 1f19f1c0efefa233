// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/tracking/discontinuity_detector.hpp"
#include "ram_slam/tracking/map_views.hpp"
#include "ram_slam/tracking/pose_monitor.hpp"
#include "ram_slam/tracking/relocaliser.hpp"

namespace ram_slam {

/// When a copy of the filter is put aside, and how uncertain a newly set pose is.
struct TrackingParameters {
  double copy_period_s = 2.0;
  double copy_age_s = 3.0;
  double probation_m = 15.0;
  double known_motion_sigma_m = 0.1;
  double known_motion_sigma_rad = 0.05;
  double resumed_sigma_m = 0.1;
  double resumed_sigma_rad = 0.05;
  double restored_sigma_m = 0.02;
  double restored_sigma_rad = 0.004;
  double lost_sigma_m = 100.0;  ///< anywhere around; callers compare with it
  double lost_sigma_rad = M_PI;
  MotionGate checkpoint_step{0.1, 0.1};  ///< between two poses of the path

  static const ram_parameters::ParameterTable<TrackingParameters>& table();
};

/// When a lost robot whose odometry was never interrupted is where odometry leads, after all.
struct OdometryTrustParameters {
  double contradicted_m = 20.0;
  double carried_m = 40.0;
  double walls_agree_s = 1.0;
  double sigma_m = 0.3;
  double sigma_rad = 0.05;

  static const ram_parameters::ParameterTable<OdometryTrustParameters>& table();
};

/// Settings of Tracker: the section `relocalisation` of config/fast_slam.yaml.
struct RecoveryParameters {
  /// False: the filter alone; it is never lost and never recovers.
  bool enabled = true;
  PoseMonitorParameters monitor;
  RelocaliserParameters relocaliser;
  TrackingParameters tracking;
  OdometryTrustParameters odometry_trust;
  DisturbanceParameters disturbance;
  MapViewsParameters map_views;

  static const ram_parameters::ParameterTable<RecoveryParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// Reads the section `relocalisation`. \throws std::invalid_argument for an unknown key, a wrong
/// type or a value out of bounds
RecoveryParameters readRecoveryParameters(ram_parameters::ParameterReader& all);

}  // namespace ram_slam
