// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/sensing/laser_scan.hpp"
#include "ramscout_feature_detector/edge.hpp"

namespace ramscout_feature_detector {

/// Finds the edges of things in scans of a planar lidar: where a surface ends in front of others,
/// where it turns sharply, and small things as a whole. Unlike FeatureDetector it does not insist
/// on two straight legs, so it finds places in clutter, too.
///
/// The far side of a gap is a shadow that moves with the laser: never an edge.
class EdgeDetector {
public:
  /// \throws std::invalid_argument as EdgeDetectorParameters::validate()
  explicit EdgeDetector(const EdgeDetectorParameters& parameters);

  /// The edges with covariance, orientation and classifier (ViewGrid; objects have none) in the
  /// base frame.
  /// \param base_from_laser  mounting; of a laser mounted upside down the scan must be
  ///        ram_slam::mirrored()
  /// \throws std::invalid_argument if the scan is not usable (LaserScan::validate()) or the pose
  ///         not finite
  ram_slam::FeatureList detect(const ram_slam::LaserScan& scan,
                               const ram_slam::Pose2& base_from_laser) const;

  /// The edges in the laser's frame: objects, corners of straight legs, ends, other bends. At most
  /// max_features, none closer than
  /// feature_distance to one before it.
  /// \throws std::invalid_argument if the scan is not usable
  std::vector<Edge> edges(const ram_slam::LaserScan& scan) const;

  const EdgeDetectorParameters& parameters() const { return parameters_; }

private:
  EdgeDetectorParameters parameters_;
};

}  // namespace ramscout_feature_detector
