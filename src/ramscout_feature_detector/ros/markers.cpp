// SPDX-License-Identifier: BSD-3-Clause
#include "markers.hpp"

#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>

namespace ramscout_feature_detector_ros {
namespace {

using ramscout_feature_detector::MarkerParameters;

geometry_msgs::Point toPoint(const Eigen::Vector2d& point_m) {
  geometry_msgs::Point point;
  point.x = point_m.x();
  point.y = point_m.y();
  return point;
}

visualization_msgs::Marker lines(const std_msgs::Header& header,
                                 const std::string& name,
                                 const MarkerParameters& parameters) {
  visualization_msgs::Marker marker;
  marker.header = header;
  marker.ns = name;
  marker.type = visualization_msgs::Marker::LINE_LIST;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = parameters.line_width_m;
  marker.color.a = 1.0F;
  return marker;
}

/// The image of the unit circle under an affine map, as line segments.
void addEllipse(const Eigen::Vector2d& centre_m,
                const Eigen::Matrix2d& axes_m,
                int steps,
                visualization_msgs::Marker& marker) {
  for (int i = 0; i < steps; ++i) {
    for (int end = 0; end < 2; ++end) {
      const double angle_rad = 2.0 * M_PI * (i + end) / steps;
      marker.points.push_back(
          toPoint(centre_m + axes_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad))));
    }
  }
}

/// A marker without points takes the old one away.
visualization_msgs::Marker finished(visualization_msgs::Marker marker) {
  if (marker.points.empty()) marker.action = visualization_msgs::Marker::DELETE;
  return marker;
}

}  // namespace

visualization_msgs::MarkerArray featureMarkers(const ram_slam::FeatureList& list,
                                               const std_msgs::Header& header,
                                               const MarkerParameters& parameters) {
  visualization_msgs::Marker ellipses = lines(header, "one_sigma", parameters);
  ellipses.color.r = 1.0F;
  visualization_msgs::Marker bisectors = lines(header, "bisectors", parameters);
  bisectors.color.g = 1.0F;
  for (const ram_slam::Feature& feature : list.features) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(feature.covariance_m2);
    addEllipse(feature.position_m, solver.operatorSqrt(), parameters.circle_steps, ellipses);
    if (feature.orientation_variance_rad2 > parameters.max_orientation_variance_rad2) continue;
    bisectors.points.push_back(toPoint(feature.position_m));
    bisectors.points.push_back(
        toPoint(feature.position_m +
                parameters.bisector_m * Eigen::Vector2d(std::cos(feature.orientation_rad),
                                                        std::sin(feature.orientation_rad))));
  }
  visualization_msgs::MarkerArray markers;
  markers.markers = {finished(std::move(ellipses)), finished(std::move(bisectors))};
  return markers;
}

visualization_msgs::Marker exclusionMarker(
    const ramscout_feature_detector::FeatureDetector::Analysis& analysis,
    const ram_slam::Pose2& base_from_laser,
    const ramscout_feature_detector::FeatureDetectorParameters& parameters,
    const std_msgs::Header& header) {
  visualization_msgs::Marker excluded = lines(header, "excluded", parameters.node.markers);
  excluded.color.b = 1.0F;
  const Eigen::Matrix2d circle = parameters.occlude_limit * Eigen::Matrix2d::Identity();
  const int steps = parameters.node.markers.circle_steps;
  for (const auto& contour : analysis.contours) {
    if (contour.closed()) continue;
    addEllipse(base_from_laser * contour.front(), circle, steps, excluded);
    addEllipse(base_from_laser * contour.back(), circle, steps, excluded);
  }
  return finished(std::move(excluded));
}

}  // namespace ramscout_feature_detector_ros
