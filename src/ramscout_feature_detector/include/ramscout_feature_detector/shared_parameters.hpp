// SPDX-License-Identifier: BSD-3-Clause
// Parameters that the detectors of corners and of edges have in common.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "ram_parameters/parameter_table.hpp"

namespace ramscout_feature_detector {

/// How a scan is cut into surfaces.
struct SegmentationParameters {
  int max_bridged_beams = 2;
  double grazing_angle_rad = 10.0 * M_PI / 180.0;
  double lone_reading_m = 0.3;
  double max_range_m = 1000.0;

  static const ram_parameters::ParameterTable<SegmentationParameters>& table();
};

/// How lines are fitted to runs of points.
struct LineParameters {
  double noise_prior_points = 8.0;
  int smoothing_half_width = 4;
  int refinements = 2;
  double min_cos_incidence = 0.05;

  static const ram_parameters::ParameterTable<LineParameters>& table();
};

/// How two straight legs are found and crossed.
struct TwoLineParameters {
  double split_window_m = 0.2;
  double split_spacing_m = 0.1;
  std::vector<double> leg_lengths_m{0.1, 0.2, 0.4, 0.8};
  double shortest_leg_sigmas = 10.0;
  double straight_sigma_ratio = 1.2;
  double straight_sigmas = 4.0;
  int bent_splits = 8;
  double bent_significance = 14.0;
  double cornerness_share = 0.6;
  double significance_share = 0.5;
  double unseen_spacings = 2.0;
  double unseen_sigmas = 4.0;
  double margin_sigmas = 3.0;
  double min_sin_opening = 0.1;
  double min_cos_incidence = 0.3;
  double model_variance_m2 = 2.5e-7;
  double orientation_model_variance_rad2 = 1e-5;
  LineParameters line;

  static const ram_parameters::ParameterTable<TwoLineParameters>& table();
};

/// A sensor, what makes a corner of two lines, and the tuning of their fits.
struct CornerModel {
  double range_sigma_m;
  double corner_threshold;
  double significance_min;
  const TwoLineParameters& tuning;  ///< must outlive this
};

/// How features are drawn for rviz.
struct MarkerParameters {
  int circle_steps = 24;
  double line_width_m = 0.02;
  double bisector_m = 0.3;
  double max_orientation_variance_rad2 = 10.0;

  static const ram_parameters::ParameterTable<MarkerParameters>& table();
};

/// What only the nodes use.
struct DetectorNodeParameters {
  std::string base_frame = "base_link";
  int max_lasers = 32;
  double log_period_s = 5.0;
  MarkerParameters markers;

  static const ram_parameters::ParameterTable<DetectorNodeParameters>& table();
};

}  // namespace ramscout_feature_detector
