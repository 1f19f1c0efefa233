// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_feature_detector/shared_parameters.hpp"

namespace ramscout_feature_detector {

/// The picture that shows what detection does.
struct PictureParameters {
  double reach_m = 10.0;
  int max_pixels = 500;
  int cross_pixels = 4;
  double brightest_response = 0.02;

  static const ram_parameters::ParameterTable<PictureParameters>& table();
};

/// Settings of the corner detector; table() explains each with unit and range.
struct FeatureDetectorParameters {
  double ppm = 100.0;
  int kernel_radius = 40;
  int scale_levels = 3;
  double laser_range_sigma = 0.02;
  double laser_angular_sigma = 0.0036;
  double distance_threshold = 0.3;
  double occlude_limit = 0.3;
  double extrapolation_distance = 1.0;
  int max_features = 10;
  bool relative_threshold = false;
  double feature_threshold = 0.9;
  double feature_distance = 0.3;
  double covariance_limit = 0.7;
  double corner_threshold = 0.08;
  double significance_min = 16.0;
  double position_sigma_limit = 0.035;
  double tangent_length_m = 0.2;
  double max_peak_offset_px = 5.0;
  double single_level_significance = 25.0;
  SegmentationParameters segmentation;
  TwoLineParameters two_lines;
  PictureParameters picture;
  DetectorNodeParameters node;

  static const ram_parameters::ParameterTable<FeatureDetectorParameters>& table();
  /// Valid as long as these parameters.
  CornerModel cornerModel() const {
    return {laser_range_sigma, corner_threshold, significance_min, two_lines};
  }
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;

  /// What is allowed but hardly meant, one sentence each: values outside the range that is known to
  /// work, a kernel that does not contain the sensor's noise, a coarsest level with fewer than 10
  /// pixels per metre.
  std::vector<std::string> warnings() const;
};

/// The parameters that the reader has, the others at their defaults.
/// \throws std::invalid_argument for an unknown key, a wrong type or a value out of range
FeatureDetectorParameters readFeatureDetectorParameters(ram_parameters::ParameterReader& reader);

}  // namespace ramscout_feature_detector
