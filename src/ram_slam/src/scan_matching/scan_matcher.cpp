// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/scan_matcher.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace ram_slam {
namespace {

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
    const Eigen::Matrix3d turn = reference.map_from_laser.axesRotation();
    equations.information += turn * sum.information * turn.transpose();
    equations.gradient += turn * sum.gradient;
    equations.cost_m2 += sum.cost_m2;
    equations.weight += sum.weight;
    equations.inlier_ratio = std::max(equations.inlier_ratio, sum.inlierRatio());
  }
  return equations;
}

}  // namespace

const ram_parameters::ParameterTable<ScanMatcherParameters>& ScanMatcherParameters::table() {
  using namespace ram_parameters;
  using P = ScanMatcherParameters;
  static const auto table =
      ParameterTable<P>()
          .heading("Alignment of scans")
          .add("first_gate_m", &P::first_gate_m, "m", positive(),
               "Greatest distance of a pair in the first iteration.")
          .add("last_gate_m", &P::last_gate_m, "m", positive(),
               "Greatest distance of a pair in the last iterations.")
          .rule(&P::last_gate_m, "<= first_gate_m",
                [](const P& p) { return p.last_gate_m <= p.first_gate_m; })
          .add("min_normal_cosine", &P::min_normal_cosine, "", within(-1.0, 1.0),
               "Smallest cosine of the angle between the normals of a pair.")
          .add("robust_scale_m", &P::robust_scale_m, "m", positive(),
               "Residual at which a pair counts half.")
          .add("range_deviation_m", &P::range_deviation_m, "m", positive(),
               "Standard deviation of a reading across a wall.")
          .add("correlated_beams", &P::correlated_beams, "", atLeast(1.0),
               "How many neighbouring readings share their error.")
          .add("max_iterations", &P::max_iterations, "", atLeast(1), "Most iterations.")
          .add("max_points", &P::max_points, "", atLeast(10),
               "Points of a scan that are used, evenly spread.")
          .expert("Alignment of scans: details")
          .include(&P::converged, motionGateTable("A step below this ends the iteration."),
                   "converged_")
          .include(&P::good_guess,
                   motionGateTable("After a first step below this the last gate is used at once."),
                   "good_guess_")
          .add("gate_shrink", &P::gate_shrink, "", between(0.0, 1.0),
               "The gate of an iteration divided by that of the iteration before.")
          .add(
              "max_search_beams", &P::max_search_beams, "", atLeast(1.0),
              "Most beams on each side of a point's own beam among which its partner is searched.");
  return table;
}

void ScanMatcherParameters::validate() const {
  table().check(*this);
}

PairingLimits ScanMatcherParameters::firstPairing() const {
  PairingLimits limits;
  limits.max_distance_m = first_gate_m;
  limits.min_normal_cosine = min_normal_cosine;
  limits.robust_scale_m = robust_scale_m;
  limits.max_search_beams = max_search_beams;
  return limits;
}

ScanMatch matchScan(const SurfaceScan& scan,
                    const std::vector<ReferenceScan>& references,
                    const PosePrior& prior,
                    const Pose2& map_from_laser_guess,
                    const ScanMatcherParameters& parameters) {
  PairingLimits limits = parameters.firstPairing();
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
        prior.information * componentDifference(match.map_from_laser, prior.map_from_laser);
    const Eigen::Vector3d step = -information.ldlt().solve(gradient);
    match.map_from_laser.x_m += step.x();
    match.map_from_laser.y_m += step.y();
    match.map_from_laser.yaw_rad = wrapAngle(match.map_from_laser.yaw_rad + step.z());
    const bool gate_is_last = limits.max_distance_m <= parameters.last_gate_m;
    const Pose2 moved{step.x(), step.y(), step.z()};
    if (gate_is_last && !parameters.converged.isReachedBy(moved)) break;
    const bool is_near = !parameters.good_guess.isReachedBy(moved);
    limits.max_distance_m = std::max(
        parameters.last_gate_m, is_near ? 0.0 : parameters.gate_shrink * limits.max_distance_m);
  }
  return match;
}

}  // namespace ram_slam
