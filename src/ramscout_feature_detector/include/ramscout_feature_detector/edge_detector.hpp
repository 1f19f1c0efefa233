// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/feature.hpp"
#include "ram_slam/laser_scan.hpp"
#include "ram_slam/pose2.hpp"

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
  double bend_angle = 0.8;
  double significance_min = 16.0;
  double position_sigma_limit = 0.04;
  double feature_distance = 0.15;
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
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Identity();
  /// End: where the surface was heading. Bend: of the bisector of its legs. Objects have none.
  double orientation_rad = 0.0;
  double orientation_variance_rad2 = 1e6;
};

/// Finds the edges of things in scans of a planar lidar: where a surface ends in front of others,
/// where it turns sharply, and small things as a whole. Unlike FeatureDetector it does not ask for
/// two straight legs, so it finds places in clutter, too: many more, less certain and less telling
/// ones.
///
/// The far side of a gap is a shadow that moves with the laser: never an edge.
class EdgeDetector {
public:
  /// \throws std::invalid_argument as EdgeDetectorParameters::validate()
  explicit EdgeDetector(const EdgeDetectorParameters& parameters);

  /// The edges with covariance, orientation and classifier (PolarGrid; objects have none) in the
  /// base frame.
  /// \param base_from_laser  mounting; of a laser mounted upside down the scan must be
  ///        ram_slam::mirrored()
  /// \throws std::invalid_argument if the scan is not usable (LaserScan::validate()) or the pose
  ///         not finite
  ram_slam::FeatureList detect(const ram_slam::LaserScan& scan,
                               const ram_slam::Pose2& base_from_laser) const;

  /// The edges in the laser's frame: objects, ends, bends. At most max_features, none closer than
  /// feature_distance to one before it.
  /// \throws std::invalid_argument if the scan is not usable
  std::vector<Edge> edges(const ram_slam::LaserScan& scan) const;

  const EdgeDetectorParameters& parameters() const { return parameters_; }

private:
  EdgeDetectorParameters parameters_;
};

}  // namespace ramscout_feature_detector
