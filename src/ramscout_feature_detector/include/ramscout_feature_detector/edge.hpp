// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <Eigen/Core>

#include "ram_parameters/parameter_reader.hpp"

namespace ramscout_feature_detector {

/// The type of the features and the name of their matcher.
inline constexpr const char* kEdgeType = "edge";

/// Settings of the edge detector. The names are the keys of config/edge_detector.yaml, which
/// explains each with unit and range.
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
  /// Only the node uses it: the frame of its features.
  std::string base_frame = "base_link";

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
