// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/contour.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ramscout_feature_detector {
namespace {

/// (1 um)^2, far below any sensor's noise: keeps divisions by the spread finite.
constexpr double kSmallestSpreadM2 = 1e-12;

}  // namespace

double LineFit::noiseVariance(double prior_m2, double prior_points) const {
  const double freedom = std::max(count - 2, 0);
  const double all = prior_points + freedom;
  // Second order: the mean of 1 / estimate is that of 1 / variance.
  return (prior_points * prior_m2 + residual_m2) / all * (1.0 + 2.0 * freedom / (all * all));
}

double LineFit::offsetVariance(double noise_m2, const Eigen::Vector2d& point_m) const {
  const double along_m = direction.dot(point_m - centroid_m);
  return noise_m2 * (1.0 / count + along_m * along_m / spread_m2);
}

Contour::Contour(std::vector<Eigen::Vector2d> points_m,
                 bool closed,
                 const LineParameters& parameters)
    : points_m_(std::move(points_m)),
      sums_(points_m_.size() + 1),
      arcs_m_(points_m_.size()),
      closed_(closed),
      parameters_(parameters) {
  for (std::size_t i = 0; i < size(); ++i) {
    const Eigen::Vector2d p = points_m_[i] - points_m_[0];
    const Sums& s = sums_[i];
    sums_[i + 1] = {s.x + p.x(), s.y + p.y(), s.xx + p.x() * p.x(), s.xy + p.x() * p.y(),
                    s.yy + p.y() * p.y()};
  }
  const auto smoothed = [this](std::size_t i) -> Eigen::Vector2d {
    const std::size_t half =
        std::min({static_cast<std::size_t>(parameters_.smoothing_half_width), i, size() - 1 - i});
    const Sums& from = sums_[i - half];
    const Sums& to = sums_[i + half + 1];
    return Eigen::Vector2d(to.x - from.x, to.y - from.y) / static_cast<double>(2 * half + 1);
  };
  Eigen::Vector2d previous = smoothed(0);
  for (std::size_t i = 1; i < size(); ++i) {
    const Eigen::Vector2d current = smoothed(i);
    arcs_m_[i] = arcs_m_[i - 1] + (current - previous).norm();
    previous = current;
  }
}

std::size_t Contour::indexAt(double arc_m) const {
  const auto found = std::lower_bound(arcs_m_.begin(), arcs_m_.end(), arc_m);
  return std::min(static_cast<std::size_t>(found - arcs_m_.begin()), size() - 1);
}

std::size_t Contour::nearest(const Eigen::Vector2d& place_m) const {
  std::size_t best = 0;
  double best_m2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < size(); ++i) {
    const double m2 = (points_m_[i] - place_m).squaredNorm();
    if (m2 < best_m2) {
      best_m2 = m2;
      best = i;
    }
  }
  return best;
}

Contour::Sums Contour::moments(std::size_t first, std::size_t last) const {
  const Sums& from = sums_[first];
  const Sums& to = sums_[last + 1];
  const auto n = static_cast<double>(last - first + 1);
  const double share = 1.0 / n;
  const double x = (to.x - from.x) * share;
  const double y = (to.y - from.y) * share;
  return {x, y, to.xx - from.xx - n * x * x, to.xy - from.xy - n * x * y,
          to.yy - from.yy - n * y * y};
}

double Contour::residual_m2(std::size_t first, std::size_t last) const {
  const Sums m = moments(first, last);
  const double difference = std::sqrt((m.xx - m.yy) * (m.xx - m.yy) + 4.0 * m.xy * m.xy);
  return std::max(0.5 * (m.xx + m.yy - difference), 0.0);
}

LineFit Contour::fit(std::size_t first, std::size_t last) const {
  const Sums m = moments(first, last);
  const double difference = std::sqrt((m.xx - m.yy) * (m.xx - m.yy) + 4.0 * m.xy * m.xy);
  LineFit line;
  line.count = static_cast<int>(last - first + 1);
  line.centroid_m = points_m_[0] + Eigen::Vector2d(m.x, m.y);
  line.spread_m2 = std::max(0.5 * (m.xx + m.yy + difference), kSmallestSpreadM2);
  line.residual_m2 = std::max(0.5 * (m.xx + m.yy - difference), 0.0);
  Eigen::Vector2d axis = m.xx >= m.yy ? Eigen::Vector2d(m.xx - m.yy + difference, 2.0 * m.xy)
                                      : Eigen::Vector2d(2.0 * m.xy, m.yy - m.xx + difference);
  if (axis.dot(points_m_[last] - points_m_[first]) < 0.0) axis = -axis;
  const double norm = axis.norm();
  if (norm > 0.0) line.direction = axis / norm;
  return line;
}

bool Contour::bendsAt(std::size_t first,
                      std::size_t middle,
                      std::size_t last,
                      double cos_twice) const {
  // (xx - yy, 2 xy) points to twice the angle of the line's direction.
  const Sums a = moments(first, middle);
  const Sums b = moments(middle, last);
  const double ax = a.xx - a.yy, ay = 2.0 * a.xy, bx = b.xx - b.yy, by = 2.0 * b.xy;
  const double dot = ax * bx + ay * by;
  const double bound = cos_twice * std::abs(cos_twice) * (ax * ax + ay * ay) * (bx * bx + by * by);
  return dot * std::abs(dot) <= bound;
}

LineFit Contour::refine(LineFit line, std::size_t first, std::size_t last) const {
  for (int i = 0; i < parameters_.refinements; ++i) {
    const Eigen::Vector2d normal = line.normal();
    const double distance_m = normal.dot(line.centroid_m);
    double w = 0.0, wt = 0.0, wtt = 0.0, we = 0.0, wte = 0.0, wee = 0.0;
    for (std::size_t j = first; j <= last; ++j) {
      const Eigen::Vector2d beam = points_m_[j].normalized();
      const double incidence = normal.dot(beam);
      const double cos_incidence =
          std::copysign(std::max(std::abs(incidence), parameters_.min_cos_incidence), incidence);
      const double along_m =
          line.direction.dot(distance_m / cos_incidence * beam - line.centroid_m);
      const double across_m = normal.dot(points_m_[j]) - distance_m;
      const double weight = 1.0 / (cos_incidence * cos_incidence);
      w += weight;
      wt += weight * along_m;
      wtt += weight * along_m * along_m;
      we += weight * across_m;
      wte += weight * along_m * across_m;
      wee += weight * across_m * across_m;
    }
    const double mean_along_m = wt / w;
    const double mean_across_m = we / w;
    const double spread = std::max(wtt - wt * mean_along_m, kSmallestSpreadM2 * w);
    const double slope = (wte - wt * mean_across_m) / spread;
    const double points_per_weight = line.count / w;
    line.centroid_m += mean_along_m * line.direction + mean_across_m * normal;
    line.direction = (line.direction + slope * normal).normalized();
    line.spread_m2 = spread * points_per_weight;
    line.residual_m2 =
        std::max(wee - we * mean_across_m - slope * slope * spread, 0.0) * points_per_weight;
  }
  return line;
}

}  // namespace ramscout_feature_detector
