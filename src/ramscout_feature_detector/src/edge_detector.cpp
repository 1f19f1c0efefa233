// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/edge_detector.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ramscout_feature_detector/edge_fits.hpp"
#include "ramscout_feature_detector/segmentation.hpp"
#include "ramscout_feature_detector/view_grid.hpp"

namespace ramscout_feature_detector {
namespace {

/// What was found, the most certain kind first.
struct Found {
  std::vector<Edge> objects, corners, ends, bends;
};

void append(const std::vector<Edge>& edges, std::vector<Edge>& to) {
  to.insert(to.end(), edges.begin(), edges.end());
}

/// Not only from end to end: those of a wall all around that one beam misses are close together.
bool isSmall(const Surface& surface, double size_m) {
  return std::all_of(surface.points_m.begin(), surface.points_m.end(), [&](const auto& point_m) {
    return (point_m - surface.points_m.front()).norm() < size_m;
  });
}

void search(Surface surface,
            const ram_slam::LaserScan& scan,
            const EdgeDetectorParameters& parameters,
            Found& found) {
  if (surface.points_m.size() < static_cast<std::size_t>(parameters.objects.min_points)) return;
  const double increment_rad = std::abs(scan.angle_increment_rad);
  Beside before, after;
  if (!surface.closed) {
    before = beside(surface, true, scan);
    after = beside(surface, false, scan);
  }
  if (before.in_front && after.in_front && isSmall(surface, parameters.object_size)) {
    if (const auto object = fitObject(surface, increment_rad, parameters)) {
      found.objects.push_back(*object);
    }
    return;
  }
  if (surface.points_m.size() < LineFit::kFewestPoints) return;
  const Contour contour =
      toContour(std::move(surface), 2.0 * parameters.bend_scale, parameters.two_lines.line);
  for (const bool first : {true, false}) {
    const Beside& end = first ? before : after;
    if (!end.in_front) continue;
    if (const auto edge = fitEnd(contour, first, end, scan, parameters)) {
      found.ends.push_back(*edge);
    }
  }
  append(findCorners(contour, parameters), found.corners);
  append(findBends(contour, increment_rad, parameters), found.bends);
}

}  // namespace

EdgeDetector::EdgeDetector(const EdgeDetectorParameters& parameters) : parameters_(parameters) {
  parameters_.validate();
}

std::vector<Edge> EdgeDetector::edges(const ram_slam::LaserScan& scan) const {
  scan.validate();
  Found found;
  for (Surface& surface :
       splitIntoSurfaces(scan, parameters_.distance_threshold, parameters_.laser_range_sigma,
                         parameters_.segmentation)) {
    search(std::move(surface), scan, parameters_, found);
  }
  // Close to a corner that is seen whole, an end is a worse description of the same thing.
  const auto isOfCorner = [&](const Edge& end) {
    return std::any_of(found.corners.begin(), found.corners.end(), [&](const Edge& corner) {
      return (corner.position_m - end.position_m).norm() < parameters_.ends.corner_reach_m;
    });
  };
  found.ends.erase(std::remove_if(found.ends.begin(), found.ends.end(), isOfCorner),
                   found.ends.end());
  std::vector<Edge> kept;
  for (const std::vector<Edge>* kind :
       {&found.objects, &found.corners, &found.ends, &found.bends}) {
    for (const Edge& edge : *kind) {
      if (kept.size() >= static_cast<std::size_t>(parameters_.max_features)) return kept;
      const bool is_free = std::none_of(kept.begin(), kept.end(), [&](const Edge& other) {
        return (other.position_m - edge.position_m).norm() < parameters_.feature_distance;
      });
      if (is_free) kept.push_back(edge);
    }
  }
  return kept;
}

ram_slam::FeatureList EdgeDetector::detect(const ram_slam::LaserScan& scan,
                                           const ram_slam::Pose2& base_from_laser) const {
  if (!base_from_laser.isFinite()) throw std::invalid_argument("pose of the laser is not finite");
  const Eigen::Matrix2d rotation = base_from_laser.rotation();
  ram_slam::FeatureList list;
  list.stamp_ns = scan.stamp_ns;
  for (const Edge& edge : edges(scan)) {
    ram_slam::Feature feature;
    feature.type = kEdgeType;
    if (edge.kind != Edge::Kind::kObject) {
      feature.classifier = ViewGrid::around(edge.position_m, scan).toString();
    }
    feature.position_m = base_from_laser * edge.position_m;
    feature.covariance_m2 = rotation * edge.covariance_m2 * rotation.transpose();
    feature.orientation_rad = ram_slam::wrapAngle(edge.orientation_rad + base_from_laser.yaw_rad);
    feature.orientation_variance_rad2 = edge.orientation_variance_rad2;
    feature.delay_ns = scan.delay_ns(std::atan2(edge.position_m.y(), edge.position_m.x()));
    list.features.push_back(std::move(feature));
  }
  return list;
}

}  // namespace ramscout_feature_detector
