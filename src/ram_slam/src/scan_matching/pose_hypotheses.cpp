// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/pose_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

namespace ram_slam {
namespace {

std::vector<Eigen::Vector2f> spread(const std::vector<SurfacePoint>& points,
                                    const PoseSearchParameters& settings) {
  const auto max_count = static_cast<std::size_t>(settings.max_points);
  const std::size_t stride = std::max<std::size_t>(1, (points.size() + max_count - 1) / max_count);
  std::vector<Eigen::Vector2f> some;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const Eigen::Vector2f point(points[i].x_m, points[i].y_m);
    if (point.norm() <= settings.max_range_m) some.push_back(point);
  }
  return some;
}

/// The points of the references in the map, and between neighbours on one line so many more that
/// no cell of the line is empty.
std::vector<Eigen::Vector2f> densePoints(const std::vector<ReferenceScan>& references,
                                         const PoseSearchParameters& settings) {
  const double spacing_m = settings.resolution_m;
  std::vector<Eigen::Vector2f> points_in_map;
  for (const ReferenceScan& reference : references) {
    const Eigen::Matrix2f rotation = reference.map_from_laser.rotation().cast<float>();
    const Eigen::Vector2f shift = reference.map_from_laser.translation().cast<float>();
    const std::vector<SurfacePoint>& points = reference.surfaces->points;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2f here(points[i].x_m, points[i].y_m);
      if (here.norm() > settings.max_range_m) continue;
      points_in_map.push_back(rotation * here + shift);
      if (i + 1 == points.size() || !lieOnOneLine(points[i], points[i + 1], spacing_m)) continue;
      const Eigen::Vector2f step = Eigen::Vector2f(points[i + 1].x_m, points[i + 1].y_m) - here;
      const int parts = static_cast<int>(step.norm() / static_cast<float>(spacing_m));
      for (int part = 1; part <= parts; ++part) {
        const float share = static_cast<float>(part) / static_cast<float>(parts + 1);
        points_in_map.push_back(rotation * (here + share * step) + shift);
      }
    }
  }
  return points_in_map;
}

}  // namespace

const ram_parameters::ParameterTable<PoseSearchParameters>& PoseSearchParameters::table() {
  using namespace ram_parameters;
  using P = PoseSearchParameters;
  static const auto table =
      ParameterTable<P>()
          .add("resolution_m", &P::resolution_m, "m", positive(),
               "Side of a cell of the likelihood grid.")
          .add("deviation_m", &P::deviation_m, "m", positive(),
               "Standard deviation of the readings in the likelihood grid.")
          .add("levels", &P::levels, "", within(1, 8),
               "Levels of the grid pyramid, each half as fine as the one before.")
          .add("max_points", &P::max_points, "", atLeast(1),
               "Points of a scan that are used, evenly spread.")
          .add("min_points", &P::min_points, "", atLeast(1),
               "A scan with fewer points within max_range_m is not searched for.")
          .add("max_range_m", &P::max_range_m, "m", positive(), "Readings beyond are not used.")
          .add("min_score", &P::min_score, "", within(0.0, 1.0),
               "Mean likelihood that a pose needs.")
          .add("angle_step_rad", &P::angle_step_rad, "rad", positive(),
               "Between the angles that are tried.")
          .add("wide_angle_rad", &P::wide_angle_rad, "rad", positive(),
               "Angle to each side of a second search, when the first has found nothing.")
          .include(&P::distinct,
                   motionGateTable("Poses farther apart than this are different places."),
                   "distinct_")
          .add("min_odds", &P::min_odds, "", atLeast(1.0),
               "A place is taken only if it is so many times as likely as the second best, ...")
          .add("uniqueness", &P::uniqueness, "", within(0.0, 1.0),
               "... and by this share of the logarithm by which it is likelier than the wheels.");
  return table;
}

PoseHypotheses::PoseHypotheses(const SurfaceScan& surfaces,
                               std::vector<ReferenceScan> references,
                               const Wheels& wheels,
                               const Settings& settings)
    : surfaces_(surfaces),
      references_(std::move(references)),
      wheels_(wheels),
      settings_(settings) {
  // V: the square and the full turn that are searched.
  const double volume = 4.0 * settings.search_distance_m * settings.search_distance_m * 2.0 * M_PI;
  const double determinant = wheels.prior.information.determinant();
  const double peak = std::pow(2.0 * M_PI, -1.5) * std::sqrt(determinant);
  const double slip = settings.slip_probability;
  slip_weight_ = slip * std::sqrt(wheels.slip_information.determinant() / determinant);
  anywhere_weight_ = slip * settings.anywhere_probability / (volume * peak);
  best_ = weighed(unaligned(wheels.prior.map_from_laser), false);
}

ScanMatch PoseHypotheses::unaligned(const Pose2& map_from_laser) const {
  ScanMatcherParameters matcher = settings_.matcher;
  matcher.first_gate_m = matcher.last_gate_m;
  matcher.max_iterations = 0;
  ScanMatch match = matchScan(surfaces_, references_, {}, map_from_laser, matcher);
  match.information.setZero();
  return match;
}

double PoseHypotheses::logPrior(const Pose2& map_from_laser) const {
  const Eigen::Vector3d away = componentDifference(map_from_laser, wheels_.prior.map_from_laser);
  return std::log(std::exp(-0.5 * away.dot(wheels_.prior.information * away)) +
                  slip_weight_ * std::exp(-0.5 * away.dot(wheels_.slip_information * away)) +
                  anywhere_weight_);
}

PoseHypotheses::Hypothesis PoseHypotheses::weighed(const ScanMatch& match, bool searched) const {
  const double by_scan =
      poseLogLikelihood(surfaces_, references_, match.map_from_laser, settings_.likelihood);
  const auto reading_count = static_cast<double>(
      std::min(surfaces_.points.size(), static_cast<std::size_t>(settings_.likelihood.max_points)));
  const double worst = std::log(settings_.likelihood.contradicting) * std::max(reading_count, 1.0) /
                       settings_.likelihood.correlated_beams;
  return {match, logPrior(match.map_from_laser) + by_scan, searched, by_scan / worst};
}

void PoseHypotheses::add(const ScanMatch& match, bool searched) {
  const Hypothesis other = weighed(match, searched);
  if (other.log_likelihood > best_.log_likelihood) best_ = other;
}

void PoseHypotheses::alignFrom(const Pose2& guess, const PosePrior& prior) {
  add(matchScan(surfaces_, references_, prior, guess, settings_.matcher));
}

std::optional<PoseHypotheses::Hypothesis> PoseHypotheses::found(const LikelihoodPyramid& pyramid,
                                                                const SearchWindow& window) const {
  const auto place = searchPose(pyramid, spread(surfaces_.points, settings_.search),
                                wheels_.prior.map_from_laser, window, settings_.search.min_score);
  if (!place) return std::nullopt;
  const PosePrior weak{place->map_from_laser, Eigen::Matrix3d::Identity()};
  return weighed(matchScan(surfaces_, references_, weak, place->map_from_laser, settings_.matcher),
                 true);
}

void PoseHypotheses::search(double angle_rad) {
  const PoseSearchParameters& settings = settings_.search;
  if (spread(surfaces_.points, settings).size() < static_cast<std::size_t>(settings.min_points))
    return;
  const std::vector<Eigen::Vector2f> points = densePoints(references_, settings);
  if (points.empty()) return;
  const LikelihoodPyramid pyramid(points, settings.resolution_m, settings.deviation_m,
                                  settings.levels);
  SearchWindow window;
  window.angle_step_rad = settings.angle_step_rad;
  window.distance_m = settings_.search_distance_m;
  window.angle_rad = angle_rad;
  const std::optional<Hypothesis> first = found(pyramid, window);
  if (!first) return;
  if (!settings.distinct.isExceededBy(best_.match.map_from_laser.inverse() *
                                      first->match.map_from_laser)) {
    if (first->log_likelihood > best_.log_likelihood) best_ = *first;
    return;
  }
  window.excluded = first->match.map_from_laser;
  window.excluded_gate = settings.distinct;
  const std::optional<Hypothesis> second = found(pyramid, window);
  const bool second_is_better = second && second->log_likelihood > first->log_likelihood;
  const Hypothesis& best = second_is_better ? *second : *first;
  const double gain = best.log_likelihood - best_.log_likelihood;
  if (gain <= 0.0) return;
  if (second) {
    const Hypothesis& other = second_is_better ? *first : *second;
    const Pose2 between = best.match.map_from_laser.inverse() * other.match.map_from_laser;
    const double lead = best.log_likelihood - other.log_likelihood;
    if (settings.distinct.isExceededBy(between) &&
        lead < std::max(std::log(settings.min_odds), settings.uniqueness * gain)) {
      if (best_.contradiction > settings_.contradiction &&
          std::abs(between.yaw_rad) <= settings.distinct.angle_rad)
        best_ = nearerOf(best, other);
      return;
    }
  }
  best_ = best;
}

PoseHypotheses::Hypothesis PoseHypotheses::nearerOf(const Hypothesis& a,
                                                    const Hypothesis& b) const {
  const Eigen::Vector2d predicted_m = wheels_.prior.map_from_laser.translation();
  const Eigen::Vector2d a_m = a.match.map_from_laser.translation();
  const Eigen::Vector2d b_m = b.match.map_from_laser.translation();
  Hypothesis nearer = (a_m - predicted_m).norm() <= (b_m - predicted_m).norm() ? a : b;
  Eigen::Matrix3d& information = nearer.match.information;
  const Eigen::Vector3d open(a_m.x() - b_m.x(), a_m.y() - b_m.y(), 0.0);
  const Eigen::Vector3d column = information * open;
  if (open.dot(column) > 0.0) information -= column * column.transpose() / open.dot(column);
  return nearer;
}

}  // namespace ram_slam
