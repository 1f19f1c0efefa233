// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/segmentation.hpp"

#include <algorithm>
#include <cmath>

namespace ramscout_feature_detector {
namespace {

/// Two legs that have one point in common.
constexpr std::size_t kFewestCornerPoints = 2 * LineFit::kFewestPoints - 1;

struct Hit {
  std::size_t beam;
  double range_m;
  Eigen::Vector2d point_m;
  bool connected;  ///< to the hit before it, by beams: nothing invalid or empty lies between
};

/// Readings far in range from both neighbours lie on no surface: an edge hit by half a beam, or
/// noise.
bool isLone(const ram_slam::LaserScan& scan, std::size_t beam, double lone_reading_m) {
  if (beam == 0 || beam + 1 == scan.ranges_m.size()) return false;
  if (scan.at(beam - 1) != ram_slam::Return::kHit || scan.at(beam + 1) != ram_slam::Return::kHit) {
    return false;
  }
  const float range_m = scan.ranges_m[beam];
  return std::abs(range_m - scan.ranges_m[beam - 1]) > lone_reading_m &&
         std::abs(range_m - scan.ranges_m[beam + 1]) > lone_reading_m;
}

std::vector<Hit> surfaceHits(const ram_slam::LaserScan& scan,
                             const SegmentationParameters& parameters) {
  std::vector<Hit> hits;
  hits.reserve(scan.ranges_m.size());
  bool connected = false;
  int bridged = 0;
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    if (scan.at(beam) != ram_slam::Return::kHit || scan.ranges_m[beam] > parameters.max_range_m) {
      connected = false;
    } else if (isLone(scan, beam, parameters.lone_reading_m)) {
      connected = connected && ++bridged <= parameters.max_bridged_beams;
    } else {
      hits.push_back({beam, scan.ranges_m[beam], scan.end_m(beam), connected});
      connected = true;
      bridged = 0;
    }
  }
  return hits;
}

/// The largest distance between neighbours on one surface.
double largestGap(const Hit& before,
                  double angle_rad,
                  double distance_threshold_m,
                  double range_sigma_m,
                  double least_grazing_rad) {
  const double grazing_rad = std::max(least_grazing_rad, 2.0 * angle_rad);
  const double adaptive_m =
      before.range_m * std::sin(angle_rad) / std::sin(grazing_rad - angle_rad) +
      3.0 * range_sigma_m;
  return std::max(distance_threshold_m, adaptive_m);
}

using Points = std::vector<Eigen::Vector2d>;

/// Repeats the beginning of a surface that goes all around, so that nothing on it lies near an end.
void overlapSeam(Points& points, double overlap_m) {
  const std::size_t count = points.size();
  double length_m = 0.0;
  for (std::size_t i = 0; i < count && length_m < overlap_m; ++i) {
    const Eigen::Vector2d next = points[i];
    length_m += (next - points.back()).norm();
    points.push_back(next);
  }
}

void append(const Surface& surface, Surface& to) {
  to.beams.insert(to.beams.end(), surface.beams.begin(), surface.beams.end());
  to.points_m.insert(to.points_m.end(), surface.points_m.begin(), surface.points_m.end());
}

}  // namespace

bool isFullTurn(const ram_slam::LaserScan& scan) {
  const double increment_rad = std::abs(scan.angle_increment_rad);
  return static_cast<double>(scan.ranges_m.size()) * increment_rad >
         2.0 * M_PI - 1.5 * increment_rad;
}

std::vector<Surface> splitIntoSurfaces(const ram_slam::LaserScan& scan,
                                       double distance_threshold_m,
                                       double range_sigma_m,
                                       const SegmentationParameters& parameters) {
  const std::vector<Hit> hits = surfaceHits(scan, parameters);
  if (hits.empty()) return {};
  const double increment_rad = std::abs(scan.angle_increment_rad);
  const auto onOneSurface = [&](const Hit& before, const Hit& after, double angle_rad) {
    return (after.point_m - before.point_m).norm() <=
           largestGap(before, angle_rad, distance_threshold_m, range_sigma_m,
                      parameters.grazing_angle_rad);
  };
  std::vector<Surface> surfaces;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const bool continues =
        i > 0 && hits[i].connected &&
        onOneSurface(hits[i - 1], hits[i],
                     increment_rad * static_cast<double>(hits[i].beam - hits[i - 1].beam));
    if (!continues) surfaces.emplace_back();
    surfaces.back().beams.push_back(hits[i].beam);
    surfaces.back().points_m.push_back(hits[i].point_m);
  }
  const bool both_ends_hit = hits.front().beam == 0 && hits.back().beam + 1 == scan.ranges_m.size();
  if (isFullTurn(scan) && both_ends_hit && onOneSurface(hits.back(), hits.front(), increment_rad)) {
    if (surfaces.size() == 1) {
      surfaces.front().closed = true;
    } else {
      append(surfaces.front(), surfaces.back());
      surfaces.erase(surfaces.begin());
    }
  }
  return surfaces;
}

Contour toContour(Surface surface, double overlap_m, const LineParameters& parameters) {
  if (surface.closed) overlapSeam(surface.points_m, overlap_m);
  return Contour(std::move(surface.points_m), surface.closed, parameters);
}

std::vector<Contour> splitIntoContours(const ram_slam::LaserScan& scan,
                                       const FeatureDetectorParameters& parameters) {
  std::vector<Contour> contours;
  for (Surface& surface :
       splitIntoSurfaces(scan, parameters.distance_threshold, parameters.laser_range_sigma,
                         parameters.segmentation)) {
    if (surface.points_m.size() < kFewestCornerPoints) continue;
    Contour contour = toContour(std::move(surface), 2.0 * parameters.extrapolation_distance,
                                parameters.two_lines.line);
    if (contour.length_m() >= 2.0 * parameters.occlude_limit) {
      contours.push_back(std::move(contour));
    }
  }
  return contours;
}

}  // namespace ramscout_feature_detector
