// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/stages/estimator_stage.hpp"

namespace ram_slam {

/// Names of the frames between which the node publishes poses.
struct Frames {
  std::string map = "map";
  std::string odom = "odom";
  std::string base = "base_link";

  static const ram_parameters::ParameterTable<Frames>& table();
};

/// When tf map -> odom is published, and which motion of odom -> base is believed.
struct MapToOdomParameters {
  double period_s = 0.04;          ///< at least so often
  double tick_s = 0.004;           ///< between checks whether it is due
  double maximum_speed_mps = 3.0;  ///< a faster motion is a jump of the odometry's origin

  static const ram_parameters::ParameterTable<MapToOdomParameters>& table();
};

/// How long what arrives waits, in wall time.
struct WaitingParameters {
  int queue_size = 500;          ///< lists of features, and scans
  double motion_s = 1.0;         ///< of a list for the motion up to it
  double interrupted_s = 0.02;   ///< the same while the odometry is known to be interrupted
  double first_retry_s = 0.002;  ///< between requests for the motion; each pause is twice as long
  double longest_retry_s = 0.1;  ///< up to this
  double service_s = 0.2;        ///< of a service call for the estimator

  static const ram_parameters::ParameterTable<WaitingParameters>& table();
};

/// How landmarks appear in rviz: as flat ellipses.
struct LandmarkMarkerParameters {
  double ellipse_sigmas = 2.0;
  double least_diameter_m = 0.05;
  double height_m = 0.02;

  static const ram_parameters::ParameterTable<LandmarkMarkerParameters>& table();
};

/// What only the node of an estimator needs; the section `node` of config/fast_slam.yaml.
struct FastSlamNodeParameters {
  std::string estimator = "fast_slam";
  Frames frames;
  std::vector<std::string> feature_topics = {"features"};
  bool use_scan = true;
  double output_period = 1.0;      ///< [s]
  int max_published_poses = 5000;  ///< of trajectory
  std::string initial_map;         ///< folder or file of a saved map; empty: none
  bool localise_only = false;      ///< in the initial map
  std::string checkpoint_file;     ///< empty: no checkpoints
  double checkpoint_period = 2.0;  ///< [s]
  EstimatorStageParameters readings;
  double initial_sigma_m = 0.01;  ///< least standard deviations of an initial pose
  double initial_sigma_rad = 0.005;
  MotionGate logged_correction{0.2, 0.1};
  WaitingParameters waiting;
  MapToOdomParameters map_to_odom;
  LandmarkMarkerParameters markers;

  static const ram_parameters::ParameterTable<FastSlamNodeParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// Reads the section `node`. \throws std::invalid_argument for an unknown key, a wrong type or a
/// value out of bounds
FastSlamNodeParameters readFastSlamNodeParameters(ram_parameters::ParameterReader& all);

}  // namespace ram_slam
