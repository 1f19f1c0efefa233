// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/feature_detector.hpp"

#include <cmath>
#include <stdexcept>

#include "ramscout_feature_detector/corner_response.hpp"
#include "ramscout_feature_detector/polar_grid.hpp"
#include "ramscout_feature_detector/rasterisation.hpp"
#include "ramscout_feature_detector/segmentation.hpp"
#include "ramscout_feature_detector/two_line_corner.hpp"

namespace ramscout_feature_detector {
namespace {

/// The image function is evaluated only at admissible crossings of two lines, and from the finest
/// level on only until the matter is settled.
std::vector<Corner> cornersOf(const Contour& contour, const FeatureDetectorParameters& parameters) {
  const CornerModel model = parameters.cornerModel();
  std::vector<Eigen::Vector2d> polyline_m;
  std::vector<Corner> corners;
  for (const std::size_t split : findSplits(contour, model.tuning)) {
    if (!isPromising(contour, split, model)) continue;
    const auto lines = fitCorner(contour, split, model);
    if (!lines || !isAdmissible(*lines, contour, parameters)) continue;
    if (polyline_m.empty())
      polyline_m =
          extrapolate(contour, parameters.extrapolation_distance, parameters.tangent_length_m);
    const auto peaks_on = [&](int level) {
      return findResponsePeaks(polyline_m, lines->position_m, level, parameters);
    };
    if (const auto corner = confirm(*lines, peaks_on, parameters)) corners.push_back(*corner);
  }
  return select(std::move(corners), parameters);
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
  feature.delay_ns = scan.delay_ns(std::atan2(lines.position_m.y(), lines.position_m.x()));
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
