// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/sensing/laser_scan.hpp"
#include "ramscout_feature_detector/contour.hpp"
#include "ramscout_feature_detector/corner_selection.hpp"
#include "ramscout_feature_detector/parameters.hpp"

namespace ramscout_feature_detector {

/// The type of the features and the name of their matcher.
inline constexpr const char* kCornerType = "corner";

/// Finds corners in scans of a planar lidar: Li & Olson, Extracting general purpose features from
/// LIDAR data (ICRA 2010), with an absolute threshold and a test of significance, so that straight
/// walls yield nothing.
class FeatureDetector {
public:
  /// \throws std::invalid_argument as FeatureDetectorParameters::validate()
  explicit FeatureDetector(const FeatureDetectorParameters& parameters);

  /// The corners with their covariance, orientation and classifier, strongest first, in the base
  /// frame.
  /// \param base_from_laser  mounting; of a laser mounted upside down the scan must be
  ///        ram_slam::mirrored()
  /// \throws std::invalid_argument if the scan is not usable (LaserScan::validate()) or the pose
  ///         not finite
  ram_slam::FeatureList detect(const ram_slam::LaserScan& scan,
                               const ram_slam::Pose2& base_from_laser) const;

  /// What detection went through, in the laser's frame: for pictures and tests.
  struct Analysis {
    std::vector<Contour> contours;
    std::vector<Corner> corners;  ///< strongest first
  };
  /// \throws std::invalid_argument if the scan is not usable
  Analysis analyse(const ram_slam::LaserScan& scan) const;

  const FeatureDetectorParameters& parameters() const { return parameters_; }

private:
  FeatureDetectorParameters parameters_;
};

}  // namespace ramscout_feature_detector
