// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/edge_detector.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <Eigen/LU>

#include "ramscout_feature_detector/polar_grid.hpp"
#include "ramscout_feature_detector/segmentation.hpp"

#include "require_within.hpp"

namespace ramscout_feature_detector {
namespace {

constexpr std::size_t kSmallestObjectPoints = 2;
constexpr std::size_t kSmallestLinePoints = 3;
constexpr double kTangentLengthM = 0.2;
constexpr double kSmallestCosIncidence = 0.2;
/// What a round or ragged edge leaves of the model (1 cm).
constexpr double kModelVarianceM2 = 1e-4;
constexpr double kOrientationModelVarianceRad2 = 1e-2;

double square(double x) {
  return x * x;
}

/// Variance of the position of a bound between two beams that hit `spacing_m` apart.
double samplingVariance(double spacing_m) {
  return square(spacing_m) / 12.0;
}

bool isCertain(const Eigen::Matrix2d& covariance_m2, const EdgeDetectorParameters& parameters) {
  const double mean = 0.5 * covariance_m2.trace();
  const double largest = mean + std::sqrt(std::max(mean * mean - covariance_m2.determinant(), 0.0));
  return largest <= square(parameters.position_sigma_limit);
}

/// Whether the laser looks past a surface beside its first (last) beam: the next beam sees nothing
/// or something farther away.
bool endsInFront(const Surface& surface, bool first, const ram_slam::LaserScan& scan) {
  const std::size_t count = scan.ranges_m.size();
  const std::size_t beam = first ? surface.beams.front() : surface.beams.back();
  if (!isFullTurn(scan) && beam == (first ? 0 : count - 1)) return false;
  const std::size_t next = first ? (beam + count - 1) % count : (beam + 1) % count;
  const ram_slam::Return seen = scan.at(next);
  return seen == ram_slam::Return::kNothing ||
         (seen == ram_slam::Return::kHit && scan.ranges_m[next] > scan.ranges_m[beam]);
}

std::optional<Edge> object(const Surface& surface,
                           double increment_rad,
                           const EdgeDetectorParameters& parameters) {
  const Eigen::Vector2d across = surface.points_m.back() - surface.points_m.front();
  if (across.norm() >= parameters.object_size) return std::nullopt;
  Edge edge;
  edge.kind = Edge::Kind::kObject;
  edge.position_m = 0.5 * (surface.points_m.back() + surface.points_m.front());
  const double spacing_m = edge.position_m.norm() * increment_rad;
  edge.covariance_m2 =
      (square(parameters.laser_range_sigma) / static_cast<double>(surface.points_m.size()) +
       samplingVariance(spacing_m) + kModelVarianceM2) *
      Eigen::Matrix2d::Identity();
  return edge;
}

/// The end of a surface lies in the direction of its tangent, between its last beam and the next.
std::optional<Edge> end(const Contour& contour,
                        bool first,
                        double increment_rad,
                        const EdgeDetectorParameters& parameters) {
  const std::size_t other =
      first ? std::max(contour.indexAt(kTangentLengthM), kSmallestLinePoints - 1)
            : std::min(contour.indexAt(contour.length_m() - kTangentLengthM),
                       contour.size() - kSmallestLinePoints);
  const LineFit line = first ? contour.fit(0, other) : contour.fit(other, contour.size() - 1);
  const Eigen::Vector2d outward = first ? Eigen::Vector2d(-line.direction) : line.direction;
  const Eigen::Vector2d& last_m = first ? contour.front() : contour.back();
  const Eigen::Vector2d beam = last_m.normalized();
  const Eigen::Vector2d normal(-outward.y(), outward.x());
  const double cos_incidence = std::max(std::abs(normal.dot(beam)), kSmallestCosIncidence);
  const double spacing_m = last_m.norm() * increment_rad / cos_incidence;

  Edge edge;
  edge.kind = Edge::Kind::kEnd;
  edge.position_m = last_m + 0.5 * spacing_m * outward;
  const double noise_m2 = square(parameters.laser_range_sigma);
  edge.covariance_m2 = samplingVariance(spacing_m) * outward * outward.transpose() +
                       noise_m2 * beam * beam.transpose() +
                       kModelVarianceM2 * Eigen::Matrix2d::Identity();
  if (!isCertain(edge.covariance_m2, parameters)) return std::nullopt;
  edge.orientation_rad = std::atan2(outward.y(), outward.x());
  edge.orientation_variance_rad2 =
      line.angleVariance(line.noiseVariance(noise_m2)) + kOrientationModelVarianceRad2;
  return edge;
}

/// The two arms of a bend at a point.
struct Arms {
  LineFit before, after;
  double angle_rad;
};

std::optional<Arms> armsAt(const Contour& contour,
                           std::size_t i,
                           const EdgeDetectorParameters& parameters) {
  const std::size_t first = contour.indexAt(contour.arc_m(i) - parameters.bend_scale);
  std::size_t last = contour.indexAt(contour.arc_m(i) + parameters.bend_scale);
  if (contour.arc_m(last) > contour.arc_m(i) + parameters.bend_scale) --last;
  if (i + 1 < first + kSmallestLinePoints || last + 1 < i + kSmallestLinePoints)
    return std::nullopt;
  Arms arms{contour.fit(first, i), contour.fit(i, last), 0.0};
  arms.angle_rad =
      std::acos(std::clamp(arms.before.direction.dot(arms.after.direction), -1.0, 1.0));
  if (arms.angle_rad < parameters.bend_angle) return std::nullopt;
  const double prior_m2 = square(parameters.laser_range_sigma);
  const double variance_rad2 = arms.before.angleVariance(arms.before.noiseVariance(prior_m2)) +
                               arms.after.angleVariance(arms.after.noiseVariance(prior_m2));
  if (square(arms.angle_rad) < parameters.significance_min * variance_rad2) return std::nullopt;
  return arms;
}

std::optional<Edge> bend(const Eigen::Vector2d& place_m,
                         const Arms& arms,
                         double increment_rad,
                         const EdgeDetectorParameters& parameters) {
  Edge edge;
  edge.kind = Edge::Kind::kBend;
  edge.position_m = place_m;
  const double prior_m2 = square(parameters.laser_range_sigma);
  const double spacing_m = place_m.norm() * increment_rad;
  edge.covariance_m2 =
      (prior_m2 + samplingVariance(spacing_m) + kModelVarianceM2) * Eigen::Matrix2d::Identity();
  if (!isCertain(edge.covariance_m2, parameters)) return std::nullopt;
  const Eigen::Vector2d bisector = arms.after.direction - arms.before.direction;
  edge.orientation_rad = std::atan2(bisector.y(), bisector.x());
  edge.orientation_variance_rad2 =
      0.25 * (arms.before.angleVariance(arms.before.noiseVariance(prior_m2)) +
              arms.after.angleVariance(arms.after.noiseVariance(prior_m2))) +
      kOrientationModelVarianceRad2;
  return edge;
}

/// The sharpest turns of a contour, one within bend_scale.
void addBends(const Contour& contour,
              double increment_rad,
              const EdgeDetectorParameters& parameters,
              std::vector<Edge>& bends) {
  std::vector<std::optional<Arms>> arms(contour.size());
  for (std::size_t i = 0; i < contour.size(); ++i) arms[i] = armsAt(contour, i, parameters);
  const auto angle = [&](std::size_t i) { return arms[i] ? arms[i]->angle_rad : 0.0; };
  for (std::size_t i = 0; i < contour.size(); ++i) {
    if (!arms[i]) continue;
    bool is_sharpest = true;
    for (std::size_t j = contour.indexAt(contour.arc_m(i) - parameters.bend_scale);
         is_sharpest && j < contour.size() &&
         contour.arc_m(j) <= contour.arc_m(i) + parameters.bend_scale;
         ++j) {
      is_sharpest = j < i ? angle(j) < angle(i) : angle(j) <= angle(i);
    }
    if (!is_sharpest) continue;
    if (const auto found = bend(contour[i], *arms[i], increment_rad, parameters)) {
      bends.push_back(*found);
    }
  }
}

}  // namespace

void EdgeDetectorParameters::validate() const {
  requireWithin("laser_range_sigma", laser_range_sigma, 1e-4, 1.0);
  requireWithin("distance_threshold", distance_threshold, 0.01, 10.0);
  requireWithin("object_size", object_size, 0.0, 2.0);
  requireWithin("bend_scale", bend_scale, 0.02, 2.0);
  requireWithin("bend_angle", bend_angle, 0.1, M_PI);
  requireWithin("significance_min", significance_min, 0.0, 1e6);
  requireWithin("position_sigma_limit", position_sigma_limit, 1e-4, 10.0);
  requireWithin("feature_distance", feature_distance, 0.01, 10.0);
  requireWithin("max_features", max_features, 1, 1000);
  requireFrame("base_frame", base_frame);
}

EdgeDetectorParameters readEdgeDetectorParameters(ram_parameters::ParameterReader& reader) {
  EdgeDetectorParameters parameters;
  reader.read("laser_range_sigma", parameters.laser_range_sigma);
  reader.read("distance_threshold", parameters.distance_threshold);
  reader.read("object_size", parameters.object_size);
  reader.read("bend_scale", parameters.bend_scale);
  reader.read("bend_angle", parameters.bend_angle);
  reader.read("significance_min", parameters.significance_min);
  reader.read("position_sigma_limit", parameters.position_sigma_limit);
  reader.read("feature_distance", parameters.feature_distance);
  reader.read("max_features", parameters.max_features);
  reader.read("base_frame", parameters.base_frame);
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
}

EdgeDetector::EdgeDetector(const EdgeDetectorParameters& parameters) : parameters_(parameters) {
  parameters_.validate();
}

std::vector<Edge> EdgeDetector::edges(const ram_slam::LaserScan& scan) const {
  scan.validate();
  const double increment_rad = std::abs(scan.angle_increment_rad);
  std::vector<Edge> objects, ends, bends;
  for (Surface& surface :
       splitIntoSurfaces(scan, parameters_.distance_threshold, parameters_.laser_range_sigma)) {
    if (surface.points_m.size() < kSmallestObjectPoints) continue;
    const bool open_first = !surface.closed && endsInFront(surface, true, scan);
    const bool open_last = !surface.closed && endsInFront(surface, false, scan);
    if (open_first && open_last) {
      if (const auto found = object(surface, increment_rad, parameters_)) {
        if (isCertain(found->covariance_m2, parameters_)) objects.push_back(*found);
        continue;
      }
    }
    if (surface.points_m.size() < kSmallestLinePoints) continue;
    const Contour contour = toContour(std::move(surface), 2.0 * parameters_.bend_scale);
    for (const bool first : {true, false}) {
      if (!(first ? open_first : open_last)) continue;
      if (const auto found = end(contour, first, increment_rad, parameters_))
        ends.push_back(*found);
    }
    addBends(contour, increment_rad, parameters_, bends);
  }
  std::vector<Edge> kept;
  for (const std::vector<Edge>* kind : {&objects, &ends, &bends}) {
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
      feature.classifier =
          PolarGrid::around(edge.position_m, edge.orientation_rad, scan).toString();
    }
    feature.position_m = base_from_laser * edge.position_m;
    feature.covariance_m2 = rotation * edge.covariance_m2 * rotation.transpose();
    feature.orientation_rad = ram_slam::wrapAngle(edge.orientation_rad + base_from_laser.yaw_rad);
    feature.orientation_variance_rad2 = edge.orientation_variance_rad2;
    list.features.push_back(std::move(feature));
  }
  return list;
}

}  // namespace ramscout_feature_detector
