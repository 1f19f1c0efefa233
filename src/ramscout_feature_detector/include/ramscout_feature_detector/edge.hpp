// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_feature_detector/shared_parameters.hpp"

namespace ramscout_feature_detector {

/// The type of the features and the name of their matcher.
inline constexpr const char* kEdgeType = "edge";

/// Ends of surfaces.
struct EndParameters {
  double tangent_length_m = 0.2;
  double continuation_sigmas = 4.0;
  int few_points = 6;
  double wall_spacings = 2.0;
  double wall_sigmas = 2.0;
  double corner_reach_m = 0.1;

  static const ram_parameters::ParameterTable<EndParameters>& table();
};

/// Small free-standing things.
struct ObjectParameters {
  int min_points = 2;
  double depth_share = 0.15;
  double depth_sigma_share = 0.1;
  double side_sigma_share = 0.03;

  static const ram_parameters::ParameterTable<ObjectParameters>& table();
};

/// Corners of straight legs and other bends.
struct BendParameters {
  double corner_gain = 12.0;
  double bend_gain = 16.0;
  double max_crossing_m = 0.1;
  double ragged_variance_m2 = 4e-4;
  double ragged_orientation_variance_rad2 = 1e-2;

  static const ram_parameters::ParameterTable<BendParameters>& table();
};

/// Settings of the edge detector; table() explains each with unit and range.
struct EdgeDetectorParameters {
  double laser_range_sigma = 0.02;
  double distance_threshold = 0.15;
  double object_size = 0.3;
  double bend_scale = 0.2;
  double bend_angle = 0.9;
  double significance_min = 16.0;
  double position_sigma_limit = 0.03;
  double feature_distance = 0.05;
  int max_features = 100;
  double corner_threshold = 0.08;
  EndParameters ends;
  ObjectParameters objects;
  BendParameters bends;
  SegmentationParameters segmentation;
  TwoLineParameters two_lines;
  DetectorNodeParameters node;

  static const ram_parameters::ParameterTable<EdgeDetectorParameters>& table();
  /// Valid as long as these parameters.
  CornerModel cornerModel() const {
    return {laser_range_sigma, corner_threshold, significance_min, two_lines};
  }
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// The parameters that the reader has, the others at their defaults.
/// \throws std::invalid_argument for an unknown key, a wrong type or a value out of range
EdgeDetectorParameters readEdgeDetectorParameters(ram_parameters::ParameterReader& reader);

/// A place that stands out on the surfaces of a scan, in the laser's frame.
struct Edge {
  enum class Kind {
    kObject,  ///< middle of a small free-standing thing
    kEnd,     ///< where a surface ends in front of what is behind it
    kBend,    ///< where a surface turns sharply
  };
  Kind kind = Kind::kEnd;
  /// Whether straight legs explain it, so that the covariance is that of lines through noisy
  /// points; else it contains what rounded or ragged things may do.
  bool is_straight = false;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Identity();
  /// End: where the surface was heading. Bend: of the bisector of its legs. Objects have none.
  double orientation_rad = 0.0;
  double orientation_variance_rad2 = 1e6;
};

}  // namespace ramscout_feature_detector
