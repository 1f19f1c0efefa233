// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/scan_matching/surface_scan.hpp"

namespace ram_slam {

/// The beam model behind poseLogLikelihood() (Thrun, Burgard, Fox: Probabilistic Robotics, 6.3).
struct PoseLikelihoodParameters {
  double deviation_m = 0.03;    ///< of a reading from a surface that the other scan saw
  double unseen = 0.5;          ///< likelihood of a reading where the other scan saw nothing
  double contradicting = 0.01;  ///< likelihood of one that the other scan saw through
  double margin_m = 0.1;        ///< nearer or farther than the other scan by this: before, behind
  int max_points = 150;         ///< of each scan that are used, evenly spread
  /// How many readings share their error and count as one: moving things cover whole sectors.
  double correlated_beams = 5.0;

  static const ram_parameters::ParameterTable<PoseLikelihoodParameters>& table();
};

/// Natural logarithm of how likely two views are at one pose, up to a constant: that of the scan
/// given the references and that of the references given the scan, averaged. Points on lines are
/// compared with lines, all others with points. The likelihood of a reading, over its greatest, is
/// - exp(-d^2 / 2 s^2) at the distance d from a surface that the other scan saw, at least
/// - `unseen` where the other scan saw nothing: hidden from it, or out of its view. A scan that
///   shows a new place is no evidence against that place,
/// - `contradicting` in front of what the other scan saw: it saw through.
double poseLogLikelihood(const SurfaceScan& scan,
                         const std::vector<ReferenceScan>& references,
                         const Pose2& map_from_laser,
                         const PoseLikelihoodParameters& parameters);

}  // namespace ram_slam
