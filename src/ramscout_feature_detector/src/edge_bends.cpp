// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "ramscout_feature_detector/edge_fits.hpp"

#include "uncertainty.hpp"

namespace ramscout_feature_detector {
namespace {

Eigen::Vector2d crossing(const LineFit& a, const LineFit& b) {
  Eigen::Matrix2d normals;
  normals << a.normal().transpose(), b.normal().transpose();
  return normals.inverse() *
         Eigen::Vector2d(a.normal().dot(a.centroid_m), b.normal().dot(b.centroid_m));
}

/// The two arms of a bend at a point.
struct Arms {
  LineFit before, after;
  double angle_rad;
  double variance_rad2;  ///< of the angle
};

/// Whether two chords differ in direction by less than half of what a bend asks for: several times
/// faster than fitting lines.
bool isNearlyStraight(const Eigen::Vector2d& a,
                      const Eigen::Vector2d& b,
                      const EdgeDetectorParameters& parameters) {
  const double dot = a.dot(b);
  return dot > 0.0 && square(dot) > square(std::cos(0.5 * parameters.bend_angle)) *
                                        a.squaredNorm() * b.squaredNorm();
}

/// \param first, last  the points within bend_scale before and after the point
std::optional<Arms> armsAt(const Contour& contour,
                           std::size_t first,
                           std::size_t i,
                           std::size_t last,
                           const EdgeDetectorParameters& parameters) {
  if (i + 1 < first + LineFit::kFewestPoints || last + 1 < i + LineFit::kFewestPoints ||
      isNearlyStraight(contour[i] - contour[first], contour[last] - contour[i], parameters)) {
    return std::nullopt;
  }
  Arms arms{contour.fit(first, i), contour.fit(i, last), 0.0, 0.0};
  arms.angle_rad =
      std::acos(std::clamp(arms.before.direction.dot(arms.after.direction), -1.0, 1.0));
  if (arms.angle_rad < parameters.bend_angle) return std::nullopt;
  const double prior_m2 = square(parameters.laser_range_sigma);
  const double prior_points = parameters.two_lines.line.noise_prior_points;
  arms.variance_rad2 =
      arms.before.angleVariance(arms.before.noiseVariance(prior_m2, prior_points)) +
      arms.after.angleVariance(arms.after.noiseVariance(prior_m2, prior_points));
  const double gain_m2 =
      contour.residual_m2(first, last) - arms.before.residual_m2 - arms.after.residual_m2;
  if (square(arms.angle_rad) < parameters.significance_min * arms.variance_rad2 ||
      gain_m2 < parameters.bends.bend_gain * prior_m2) {
    return std::nullopt;
  }
  return arms;
}

std::optional<Edge> bend(const Eigen::Vector2d& turn_m,
                         const Arms& arms,
                         double increment_rad,
                         const EdgeDetectorParameters& parameters) {
  Edge edge;
  edge.kind = Edge::Kind::kBend;
  const Eigen::Vector2d crossing_m = crossing(arms.before, arms.after);
  edge.position_m =
      (crossing_m - turn_m).norm() < parameters.bends.max_crossing_m ? crossing_m : turn_m;
  edge.covariance_m2 = (square(parameters.laser_range_sigma) +
                        samplingVariance(edge.position_m.norm() * increment_rad)) *
                       Eigen::Matrix2d::Identity();
  if (largestVariance(edge.covariance_m2) > square(parameters.position_sigma_limit)) {
    return std::nullopt;
  }
  edge.covariance_m2 += parameters.bends.ragged_variance_m2 * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d bisector = arms.after.direction - arms.before.direction;
  edge.orientation_rad = std::atan2(bisector.y(), bisector.x());
  edge.orientation_variance_rad2 =
      0.25 * arms.variance_rad2 + parameters.bends.ragged_orientation_variance_rad2;
  return edge;
}

}  // namespace

std::vector<Edge> findBends(const Contour& contour,
                            double increment_rad,
                            const EdgeDetectorParameters& parameters) {
  std::vector<std::optional<Arms>> arms(contour.size());
  for (std::size_t i = 0, first = 0, last = 0; i < contour.size(); ++i) {
    while (contour.arc_m(first) < contour.arc_m(i) - parameters.bend_scale) ++first;
    while (last + 1 < contour.size() &&
           contour.arc_m(last + 1) <= contour.arc_m(i) + parameters.bend_scale) {
      ++last;
    }
    arms[i] = armsAt(contour, first, i, last, parameters);
  }
  const auto angle = [&](std::size_t i) { return arms[i] ? arms[i]->angle_rad : 0.0; };
  const double alone_m = 0.5 * parameters.bend_scale;
  std::vector<Edge> bends;
  for (std::size_t i = 0; i < contour.size(); ++i) {
    if (!arms[i]) continue;
    bool is_sharpest = true;
    for (std::size_t j = contour.indexAt(contour.arc_m(i) - alone_m);
         is_sharpest && j < contour.size() && contour.arc_m(j) <= contour.arc_m(i) + alone_m; ++j) {
      is_sharpest = j < i ? angle(j) < angle(i) : angle(j) <= angle(i);
    }
    if (!is_sharpest) continue;
    if (const auto found = bend(contour[i], *arms[i], increment_rad, parameters)) {
      bends.push_back(*found);
    }
  }
  return bends;
}

}  // namespace ramscout_feature_detector
