// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/feature_detector.hpp"

#include <algorithm>
#include <stdexcept>

#include "ramscout_feature_detector/corner_response.hpp"
#include "ramscout_feature_detector/polar_grid.hpp"
#include "ramscout_feature_detector/rasterisation.hpp"
#include "ramscout_feature_detector/segmentation.hpp"
#include "ramscout_feature_detector/two_line_corner.hpp"

namespace ramscout_feature_detector {
namespace {

/// The places on a contour where the image function is worth evaluating: admissible crossings of
/// two lines.
std::vector<Eigen::Vector2d> promisingPlaces(const Contour& contour,
                                             const FeatureDetectorParameters& parameters) {
  std::vector<Eigen::Vector2d> places_m;
  std::vector<std::size_t> splits;
  for (const std::size_t candidate : findCandidates(contour, parameters)) {
    const auto lines = fitCorner(contour, candidate, parameters);
    if (!lines || !isAdmissible(*lines, contour, parameters)) continue;
    if (std::find(splits.begin(), splits.end(), lines->split) != splits.end()) continue;
    splits.push_back(lines->split);
    places_m.push_back(lines->position_m);
  }
  return places_m;
}

std::vector<Corner> cornersOf(const Contour& contour, const FeatureDetectorParameters& parameters) {
  const std::vector<Eigen::Vector2d> places_m = promisingPlaces(contour, parameters);
  if (places_m.empty()) return {};
  const auto polyline_m = extrapolate(contour, parameters.extrapolation_distance);
  std::vector<ResponsePeak> peaks;
  for (const Eigen::Vector2d& place_m : places_m) {
    for (int level = 0; level < parameters.scale_levels; ++level) {
      const auto found = findResponsePeaks(polyline_m, place_m, level, parameters);
      peaks.insert(peaks.end(), found.begin(), found.end());
    }
  }
  return selectCorners(contour, peaks, parameters);
}

ram_slam::Feature toFeature(const Corner& corner,
                            const ram_slam::LaserScan& scan,
                            const ram_slam::Pose2& base_from_laser) {
  const TwoLineCorner& lines = corner.lines;
  const Eigen::Matrix2d rotation = base_from_laser.rotation();
  ram_slam::Feature feature;
  feature.type = kCornerType;
  feature.classifier = PolarGrid::around(lines.position_m, lines.orientation_rad, scan).toString();
  feature.position_m = base_from_laser * lines.position_m;
  feature.covariance_m2 = rotation * lines.covariance_m2 * rotation.transpose();
  feature.orientation_rad = ram_slam::wrapAngle(lines.orientation_rad + base_from_laser.yaw_rad);
  feature.orientation_variance_rad2 = lines.orientation_variance_rad2;
  return feature;
}

}  // namespace

FeatureDetector::FeatureDetector(const FeatureDetectorParameters& parameters)
    : parameters_(parameters) {
  parameters_.validate();
}

ram_slam::FeatureList FeatureDetector::detect(const ram_slam::LaserScan& scan,
                                              const ram_slam::Pose2& base_from_laser) const {
  if (!base_from_laser.isFinite()) throw std::invalid_argument("pose of the laser is not finite");
  ram_slam::FeatureList list;
  list.stamp_ns = scan.stamp_ns;
  for (const Corner& corner : analyse(scan).corners) {
    list.features.push_back(toFeature(corner, scan, base_from_laser));
  }
  return list;
}

FeatureDetector::Analysis FeatureDetector::analyse(const ram_slam::LaserScan& scan) const {
  scan.validate();
  Analysis analysis;
  analysis.contours = splitIntoContours(scan, parameters_);
  for (const Contour& contour : analysis.contours) {
    const std::vector<Corner> corners = cornersOf(contour, parameters_);
    analysis.corners.insert(analysis.corners.end(), corners.begin(), corners.end());
  }
  analysis.corners = suppressNeighbours(std::move(analysis.corners), parameters_.feature_distance);
  return analysis;
}

}  // namespace ramscout_feature_detector
