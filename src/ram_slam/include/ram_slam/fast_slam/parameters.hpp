// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_parameters/parameter_reader.hpp"
#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/fast_slam/path.hpp"
#include "ram_slam/geometry/motion_gate.hpp"

namespace ram_slam {

/// Which version of the filter; proposal.hpp has a class for each.
enum class FastSlamMode {
  kFastSlam1,  ///< Montemerlo et al., AAAI 2002
  kFastSlam2,  ///< Montemerlo et al., IJCAI 2003
};

/// Which descriptors and which orientation of a landmark are kept and compared.
struct AppearanceParameters {
  int maximum_descriptors = 6;
  double new_descriptor_below = 1.0;    ///< [nat]
  double sighting_sigma_rad = 0.05;     ///< of the pose from which an orientation was seen
  double orientation_sigma_rad = 0.07;  ///< of things as they are, beyond what detectors state
  double wrong_orientation_share = 0.001;

  static const ram_parameters::ParameterTable<AppearanceParameters>& table();
};

/// Tuning of LandmarkExistence.
struct ExistenceParameters {
  double passed_log_odds = -2.0;
  double overlooked_log_odds = 0.0;
  int sampled_particles = 10;
  double edge_margin_m = 0.1;

  static const ram_parameters::ParameterTable<ExistenceParameters>& table();
};

/// Tuning of SharedError, chosen on simulated tours.
struct SharedErrorParameters {
  double feature_distance_m = 5.0;
  double known_floors = 0.5;  ///< standard deviation on known ground, in pose_noise_floor
  double new_floors = 2.0;    ///< likewise after new_ground_m of new ground
  double new_ground_m = 50.0;
  double known_within_m = 2.0;
  double known_spacing_m = 1.0;

  static const ram_parameters::ParameterTable<SharedErrorParameters>& table();
};

/// Which covariances between landmarks summarise() states.
struct MapSummaryParameters {
  double pair_distance_m = 5.0;
  double least_correlation = 0.1;

  static const ram_parameters::ParameterTable<MapSummaryParameters>& table();
};

/// Settings of FastSlam; table() explains them one by one.
struct FastSlamParameters {
  int particle_amount = 100;
  double feature_match_distance = 0.1;      ///< [m]
  double minimum_feature_separation = 0.3;  ///< [m]
  double future_interpol = 0.1;             ///< [s] for the node
  FastSlamMode mode = FastSlamMode::kFastSlam2;
  int seed = 1;

  double update_distance = 0.1;  ///< [m]
  double update_angle = 0.1;     ///< [rad]

  double association_gate = 9.21;  ///< 99 % of chi2 with 2 degrees of freedom
  double creation_gate = 25.0;     ///< squared Mahalanobis distance
  double duplicate_gate = 9.21;    ///< squared Mahalanobis distance
  double ambiguity_margin = 1.0;   ///< [nat]
  bool draw_jointly = false;
  double unknown_feature_density = 0.05;  ///< [1/m^2]
  double feature_noise_floor = 0.03;      ///< [m]
  double evidence_exponent = 1.0;
  double resample_threshold = 0.5;

  double drift_inflation = 1.0;
  double pose_noise_floor = 0.01;  ///< [m]

  double detection_probability = 0.5;
  double false_detection_probability = 0.05;
  double confirm_log_odds = 2.0;
  double delete_log_odds = -2.0;
  double maximum_log_odds = 8.0;

  int association_passes = 2;
  int maximum_hypotheses = 64;
  double quality_memory = 0.95;
  double drift_yaw_arm_m = 2.0;
  int skipped_ids = 10000;            ///< others may know landmarks newer than a map's file
  MotionGate loaded_frame{3.0, 0.5};  ///< farther off a robot is not found in a loaded map
  PathParameters path;
  AppearanceParameters appearance;
  ExistenceParameters existence;
  SharedErrorParameters shared_error;
  MapSummaryParameters summary;

  static const ram_parameters::ParameterTable<FastSlamParameters>& table();
  /// The rows that matter to every filter of landmarks, with particles or without.
  static const ram_parameters::ParameterTable<FastSlamParameters>& landmarkTable();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// Reads every key of FastSlamParameters; the section `node` is left to the node,
/// `relocalisation` to readRecoveryParameters(). \throws std::invalid_argument for an unknown key,
/// a wrong type or a value out of bounds
FastSlamParameters readFastSlamParameters(ram_parameters::ParameterReader& reader);

}  // namespace ram_slam
