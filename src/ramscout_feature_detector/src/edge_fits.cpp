// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/edge_fits.hpp"

#include <algorithm>
#include <cmath>

#include "ramscout_feature_detector/two_line_corner.hpp"

#include "uncertainty.hpp"

namespace ramscout_feature_detector {
namespace {

/// Grazing beams meet a line at any distance: bounds how far that makes an end uncertain.
constexpr double kSmallestCosIncidence = 1e-3;

bool isCertain(const Edge& edge, const EdgeDetectorParameters& parameters) {
  return largestVariance(edge.covariance_m2) <= square(parameters.position_sigma_limit);
}

/// The run of a surface up to its end and the noise across it.
struct EndLine {
  bool first = true;  ///< end, else the last
  LineFit line;
  double noise_m2 = 0.0;
  bool is_straight = false;

  double offsetVariance(const Eigen::Vector2d& point_m) const {
    return line.offsetVariance(noise_m2, point_m);
  }
};

EndLine endLine(const Contour& contour, bool first, const EdgeDetectorParameters& parameters) {
  const std::size_t end = first ? 0 : contour.size() - 1;
  const CornerModel model = parameters.cornerModel();
  const double tangent_m = parameters.ends.tangent_length_m;
  EndLine result;
  result.first = first;
  if (const auto leg = longestLeg(contour, end, !first, model)) {
    result.line = contour.refine(leg->line, leg->first, leg->last);
    result.is_straight = true;
  } else if (first) {
    result.line = contour.fit(0, std::max(contour.indexAt(tangent_m), LineFit::kFewestPoints - 1));
  } else {
    result.line = contour.fit(std::min(contour.indexAt(contour.length_m() - tangent_m),
                                       contour.size() - LineFit::kFewestPoints),
                              end);
  }
  result.noise_m2 = noiseOf(result.line, model);
  return result;
}

bool mayContinueAt(const EndLine& end, const Eigen::Vector2d& reading_m, double sigmas) {
  const double off_m = end.line.normal().dot(reading_m - end.line.centroid_m);
  return square(off_m) < square(sigmas) * (end.offsetVariance(reading_m) + end.noise_m2);
}

/// Whether the next two readings lead back to the end: a wall that leaves at a grazing angle meets
/// it, so it is a corner, of which the last readings may belong to either side.
///
/// \param reach_m  how far from the end is still at it
bool isMetByWall(const EndLine& end,
                 const Eigen::Vector2d& end_m,
                 double reach_m,
                 const Beside& beside,
                 const ram_slam::LaserScan& scan) {
  const std::size_t count = scan.ranges_m.size();
  if (!isFullTurn(scan) && beside.next == (end.first ? 0 : count - 1)) return false;
  const std::size_t after_next = (beside.next + (end.first ? count - 1 : 1)) % count;
  if (scan.at(beside.next) != ram_slam::Return::kHit ||
      scan.at(after_next) != ram_slam::Return::kHit) {
    return false;
  }
  const Eigen::Vector2d next_m = scan.end_m(beside.next);
  const Eigen::Vector2d back_m = next_m - scan.end_m(after_next);
  const Eigen::Vector2d normal = end.line.normal();
  const double steps = normal.dot(end.line.centroid_m - next_m) / normal.dot(back_m);
  return steps > 0.0 && (next_m + steps * back_m - end_m).norm() < reach_m;
}

/// Where a beam meets a line.
std::optional<Eigen::Vector2d> crossing(const LineFit& line,
                                        double bearing_rad,
                                        double farthest_m) {
  const Eigen::Vector2d ray(std::cos(bearing_rad), std::sin(bearing_rad));
  const double range_m = line.normal().dot(line.centroid_m) / line.normal().dot(ray);
  if (!(range_m > 0.0 && range_m < farthest_m)) return std::nullopt;
  return range_m * ray;
}

/// By how much two lines describe the surroundings of a split better than one does.
double gainAt(const Contour& contour, std::size_t split, double window_m) {
  const std::size_t first = contour.indexAt(contour.arc_m(split) - window_m);
  const std::size_t last = contour.indexAt(contour.arc_m(split) + window_m);
  return contour.residual_m2(first, last) - contour.residual_m2(first, split) -
         contour.residual_m2(split + 1, last);
}

Edge toEdge(const TwoLineCorner& corner) {
  Edge edge;
  edge.kind = Edge::Kind::kBend;
  edge.is_straight = true;
  edge.position_m = corner.position_m;
  edge.covariance_m2 = corner.covariance_m2;
  edge.orientation_rad = corner.orientation_rad;
  edge.orientation_variance_rad2 = corner.orientation_variance_rad2;
  return edge;
}

}  // namespace

Beside beside(const Surface& surface, bool first, const ram_slam::LaserScan& scan) {
  const std::size_t count = scan.ranges_m.size();
  Beside result;
  result.beam = first ? surface.beams.front() : surface.beams.back();
  if (!isFullTurn(scan) && result.beam == (first ? 0 : count - 1)) return result;
  result.next = (result.beam + (first ? count - 1 : 1)) % count;
  const ram_slam::Return seen = scan.at(result.next);
  result.in_front =
      seen == ram_slam::Return::kNothing ||
      (seen == ram_slam::Return::kHit && scan.ranges_m[result.next] > scan.ranges_m[result.beam]);
  return result;
}

std::optional<Edge> fitObject(const Surface& surface,
                              double increment_rad,
                              const EdgeDetectorParameters& parameters) {
  const double across_m = (surface.points_m.back() - surface.points_m.front()).norm();
  const Eigen::Vector2d seen_m = 0.5 * (surface.points_m.back() + surface.points_m.front());
  const Eigen::Vector2d ray = seen_m.normalized();
  const Eigen::Vector2d side(-ray.y(), ray.x());
  const double spacing_m = seen_m.norm() * increment_rad;
  const double width_m = across_m + spacing_m;
  Edge edge;
  edge.kind = Edge::Kind::kObject;
  edge.covariance_m2 =
      (square(parameters.laser_range_sigma) / static_cast<double>(surface.points_m.size()) +
       0.5 * samplingVariance(spacing_m) + parameters.two_lines.model_variance_m2) *
      Eigen::Matrix2d::Identity();
  if (!isCertain(edge, parameters)) return std::nullopt;
  const ObjectParameters& shape = parameters.objects;
  edge.position_m = seen_m + shape.depth_share * width_m * ray;
  edge.covariance_m2 += square(shape.depth_sigma_share * width_m) * ray * ray.transpose() +
                        square(shape.side_sigma_share * width_m) * side * side.transpose();
  return edge;
}

std::optional<Edge> fitEnd(const Contour& contour,
                           bool first,
                           const Beside& beside,
                           const ram_slam::LaserScan& scan,
                           const EdgeDetectorParameters& parameters) {
  const EndLine found = endLine(contour, first, parameters);
  if (scan.at(beside.next) == ram_slam::Return::kHit &&
      mayContinueAt(found, scan.end_m(beside.next), parameters.ends.continuation_sigmas)) {
    return std::nullopt;
  }
  const double bearing_rad = scan.bearing_rad(beside.beam);
  const double turn_rad = first ? -scan.angle_increment_rad : scan.angle_increment_rad;
  const auto last_m = crossing(found.line, bearing_rad, scan.range_max_m);
  const auto beyond_m = crossing(found.line, bearing_rad + turn_rad, scan.range_max_m);
  if (!last_m || !beyond_m) return std::nullopt;

  Edge edge;
  edge.kind = Edge::Kind::kEnd;
  edge.position_m = 0.5 * (*last_m + *beyond_m);
  const Eigen::Vector2d step_m = *beyond_m - *last_m;
  const double reach_m = parameters.ends.wall_spacings * step_m.norm() +
                         parameters.ends.wall_sigmas * parameters.laser_range_sigma;
  edge.is_straight =
      found.is_straight && !isMetByWall(found, edge.position_m, reach_m, beside, scan);
  const Eigen::Vector2d ray = edge.position_m.normalized();
  const double cos_incidence =
      std::max(std::abs(found.line.normal().dot(ray)), kSmallestCosIncidence);
  edge.covariance_m2 =
      (found.line.count <= parameters.ends.few_points ? 2.0 : 1.0) / 12.0 * step_m *
          step_m.transpose() +
      found.offsetVariance(edge.position_m) / square(cos_incidence) * ray * ray.transpose();
  if (!isCertain(edge, parameters)) return std::nullopt;
  edge.covariance_m2 += (edge.is_straight ? parameters.two_lines.model_variance_m2
                                          : parameters.bends.ragged_variance_m2) *
                        Eigen::Matrix2d::Identity();
  const Eigen::Vector2d outward =
      first ? Eigen::Vector2d(-found.line.direction) : found.line.direction;
  edge.orientation_rad = std::atan2(outward.y(), outward.x());
  edge.orientation_variance_rad2 =
      found.line.angleVariance(found.noise_m2) +
      (edge.is_straight ? parameters.two_lines.orientation_model_variance_rad2
                        : parameters.bends.ragged_orientation_variance_rad2);
  return edge;
}

std::vector<Edge> findCorners(const Contour& contour, const EdgeDetectorParameters& parameters) {
  const CornerModel model = parameters.cornerModel();
  std::vector<Edge> corners;
  for (const std::size_t split : findSplits(contour, model.tuning)) {
    if (gainAt(contour, split, model.tuning.split_window_m) <
            parameters.bends.corner_gain * square(parameters.laser_range_sigma) ||
        !isPromising(contour, split, model)) {
      continue;
    }
    const auto corner = fitCorner(contour, split, model, Contested::kNever);
    if (!corner || corner->cornerness < model.corner_threshold ||
        corner->significance < model.significance_min) {
      continue;
    }
    const Edge edge = toEdge(*corner);
    if (isCertain(edge, parameters)) corners.push_back(edge);
  }
  return corners;
}

}  // namespace ramscout_feature_detector
