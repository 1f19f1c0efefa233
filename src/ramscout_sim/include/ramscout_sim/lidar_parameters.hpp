// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ram_parameters/parameter_table.hpp"

namespace ramscout_sim {

/// How the light of a beam is followed and detected.
struct LightParameters {
  /// Reflectivity of the wall that half_detection_range_m is stated for: white paper.
  double white_reflectivity = 0.9;
  /// Chance of an answer: 1 / (1 + (half strength / strength)^steepness).
  double detection_steepness = 4.0;
  /// Neighbouring readings that differ more have an edge between them.
  double edge_m = 0.2;
  /// How far beyond range_max_m surfaces can still make an edge.
  double beyond_range_m = 1.0;
  /// Rays that stand for the footprint of a beam at an edge.
  int footprint_rays = 5;
  /// Most surfaces that one beam passes or is mirrored by.
  int max_surfaces = 16;
  /// How far behind a surface light continues, so that it does not meet it again.
  double behind_surface_m = 1e-4;

  static const ram_parameters::ParameterTable<LightParameters>& table();
};

/// A planar lidar; defaults are a Hokuyo UTM-30LX.
struct LidarParameters {
  /// Which lidar the other values belong to unless they are set themselves; see lidarPreset.
  std::string preset = "utm_30lx";
  int beams = 1081;
  double angle_min_rad = -2.35619449;
  double angle_max_rad = 2.35619449;
  double scan_rate_hz = 40.0;
  /// From one beam to the next; 0: all beams at once.
  double time_increment_s = 1.7361111e-5;
  double range_min_m = 0.1;
  double range_max_m = 30.0;
  /// Standard deviation of a range: the largest of the three.
  double range_sigma_m = 0.01;
  double range_sigma_per_m = 0.0;
  double far_range_sigma_m = 0.03;  ///< holds from far_range_m on
  double far_range_m = 10.0;
  /// Standard deviation of an error that all beams share and that stays for a run.
  double range_bias_sigma_m = 0.0;
  /// Of a lidar that was switched on when the simulation began: all ranges are this much too long,
  /// and the error decays with the time constant.
  double warm_up_drift_m = 0.0;
  double warm_up_time_s = 600.0;
  /// Ranges are multiples of it; 0: not rounded.
  double range_resolution_m = 0.001;
  /// Chance of a reading anywhere before the surface.
  double outlier_probability = 0.0;
  /// At which a white wall (reflectivity 0.9) that is hit head-on answers every other time; the
  /// chance depends on reflectivity * cos(incidence) / range^2. 0: every surface always answers.
  double half_detection_range_m = 0.0;
  /// Half the angle that the beam's footprint covers along the scan; 0: beams are lines.
  double beam_divergence_rad = 0.0;
  /// Echoes of one beam that are less apart merge into one between them (a mixed pixel); of others
  /// the strongest counts.
  double pulse_length_m = 0.3;
  LightParameters light;

  static const ram_parameters::ParameterTable<LidarParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
  double angleIncrement_rad() const { return (angle_max_rad - angle_min_rad) / (beams - 1); }
  /// From the first to the last beam.
  double sweep_s() const { return time_increment_s * (beams - 1); }
};

/// The largest number of beams that a lidar can have; separates the random numbers of scans.
constexpr int kMaxBeams = 20000;

/// The values of a sensor on the market: utm_30lx, urg_04lx, sick_lms, sick_lms_180 or rplidar_a2.
/// \throws std::invalid_argument for any other name
LidarParameters lidarPreset(const std::string& name);

/// Reads key `preset`, then every other key of the table, which overrides the preset.
LidarParameters readLidarParameters(ram_parameters::ParameterReader& reader);

}  // namespace ramscout_sim
