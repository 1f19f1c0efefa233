// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/scan_matcher.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "ram_parameters/require.hpp"

namespace ram_slam {
namespace {

constexpr double kConvergedM = 2e-4;
constexpr double kConvergedRad = 5e-5;
// A first step as small as this says that the guess was good: the last gate can be used at once.
constexpr double kNearM = 0.01;
constexpr double kNearRad = 0.005;

using ram_parameters::require;

struct Equations {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double cost_m2 = 0.0;
  double weight = 0.0;
  double inlier_ratio = 0.0;
};

/// The pairs with all references, summed in the axes of the map.
Equations sumReferences(const SurfaceScan& scan,
                        const std::vector<ReferenceScan>& references,
                        const Pose2& map_from_laser,
                        const PairingLimits& limits) {
  Equations equations;
  for (const ReferenceScan& reference : references) {
    const Pose2 reference_from_laser = reference.map_from_laser.inverse() * map_from_laser;
    const PointToLineSum sum =
        sumPointToLine(*reference.surfaces, scan, reference_from_laser, limits);
    Eigen::Matrix3d reference_from_map_axes = Eigen::Matrix3d::Identity();
    reference_from_map_axes.topLeftCorner<2, 2>() = reference.map_from_laser.rotation().transpose();
    equations.information +=
        reference_from_map_axes.transpose() * sum.information * reference_from_map_axes;
    equations.gradient += reference_from_map_axes.transpose() * sum.gradient;
    equations.cost_m2 += sum.cost_m2;
    equations.weight += sum.weight;
    const auto visible = static_cast<double>(std::max<std::size_t>(sum.visible_count, 1));
    const double ratio = static_cast<double>(sum.pair_count) / visible;
    equations.inlier_ratio = std::max(equations.inlier_ratio, ratio);
  }
  return equations;
}

Eigen::Vector3d difference(const Pose2& a, const Pose2& b) {
  return {a.x_m - b.x_m, a.y_m - b.y_m, wrapAngle(a.yaw_rad - b.yaw_rad)};
}

}  // namespace

void ScanMatcherParameters::validate() const {
  require(first_gate_m > 0.0, "first_gate_m", first_gate_m, "> 0");
  require(last_gate_m > 0.0 && last_gate_m <= first_gate_m, "last_gate_m", last_gate_m,
          "in (0, first_gate_m]");
  require(min_normal_cosine >= -1.0 && min_normal_cosine <= 1.0, "min_normal_cosine",
          min_normal_cosine, "in [-1, 1]");
  require(robust_scale_m > 0.0, "robust_scale_m", robust_scale_m, "> 0");
  require(range_deviation_m > 0.0, "range_deviation_m", range_deviation_m, "> 0");
  require(correlated_beams >= 1.0, "correlated_beams", correlated_beams, ">= 1");
  require(max_iterations >= 1, "max_iterations", max_iterations, ">= 1");
  require(max_points >= 10, "max_points", max_points, ">= 10");
}

void readScanMatching(ram_parameters::ParameterReader& reader,
                      SurfaceParameters& surfaces,
                      ScanMatcherParameters& matcher) {
  reader.read("neighbour_count", surfaces.neighbour_count);
  reader.read("max_gap_m", surfaces.max_gap_m);
  reader.read("max_line_deviation_m", surfaces.max_line_deviation_m);
  reader.read("max_range_m", surfaces.max_range_m);
  reader.read("first_gate_m", matcher.first_gate_m);
  reader.read("last_gate_m", matcher.last_gate_m);
  reader.read("min_normal_cosine", matcher.min_normal_cosine);
  reader.read("robust_scale_m", matcher.robust_scale_m);
  reader.read("range_deviation_m", matcher.range_deviation_m);
  reader.read("correlated_beams", matcher.correlated_beams);
  reader.read("max_iterations", matcher.max_iterations);
  reader.read("max_points", matcher.max_points);
}

ScanMatch matchScan(const SurfaceScan& scan,
                    const std::vector<ReferenceScan>& references,
                    const PosePrior& prior,
                    const Pose2& map_from_laser_guess,
                    const ScanMatcherParameters& parameters) {
  PairingLimits limits;
  limits.max_distance_m = parameters.first_gate_m;
  limits.min_normal_cosine = parameters.min_normal_cosine;
  limits.robust_scale_m = parameters.robust_scale_m;
  const auto max_points = static_cast<std::size_t>(parameters.max_points);
  limits.point_stride =
      std::max<std::size_t>(1, (scan.points.size() + max_points - 1) / max_points);

  // A point seen from several references counts once.
  const auto reference_count = static_cast<double>(std::max<std::size_t>(references.size(), 1));
  const double variance_m2 = parameters.range_deviation_m * parameters.range_deviation_m;
  const double scale = 1.0 / (variance_m2 * parameters.correlated_beams * reference_count);

  ScanMatch match;
  match.map_from_laser = map_from_laser_guess;
  for (int iteration = 0;; ++iteration) {
    const Equations equations = sumReferences(scan, references, match.map_from_laser, limits);
    match.information = scale * equations.information;
    match.inlier_ratio = equations.inlier_ratio;
    match.deviation_m = std::sqrt(equations.cost_m2 / std::max(equations.weight, 1e-9));
    if (iteration == parameters.max_iterations) break;

    const Eigen::Matrix3d information =
        match.information + prior.information + 1e-6 * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d gradient =
        scale * equations.gradient +
        prior.information * difference(match.map_from_laser, prior.map_from_laser);
    const Eigen::Vector3d step = -information.ldlt().solve(gradient);
    match.map_from_laser.x_m += step.x();
    match.map_from_laser.y_m += step.y();
    match.map_from_laser.yaw_rad = wrapAngle(match.map_from_laser.yaw_rad + step.z());
    const bool gate_is_last = limits.max_distance_m <= parameters.last_gate_m;
    if (gate_is_last && step.head<2>().norm() < kConvergedM && std::abs(step.z()) < kConvergedRad)
      break;
    const bool is_near = step.head<2>().norm() < kNearM && std::abs(step.z()) < kNearRad;
    limits.max_distance_m =
        std::max(parameters.last_gate_m, is_near ? 0.0 : 0.6 * limits.max_distance_m);
  }
  return match;
}

}  // namespace ram_slam
