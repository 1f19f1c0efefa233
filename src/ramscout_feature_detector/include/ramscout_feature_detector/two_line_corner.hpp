// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "ramscout_feature_detector/contour.hpp"
#include "ramscout_feature_detector/shared_parameters.hpp"

namespace ramscout_feature_detector {

/// A corner as the crossing of two fitted lines, in the frame of the contour.
struct TwoLineCorner {
  std::size_t split = 0;  ///< last point of the first leg
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Identity();
  double orientation_rad = 0.0;  ///< of the bisector of the two legs, pointing between them
  double orientation_variance_rad2 = 0.0;
  /// Share of the smaller eigenvalue of the legs' normals' tensor, 1/2 (1 - |cos(opening angle)|),
  /// in [0, 1/2].
  double cornerness = 0.0;
  double significance = 0.0;  ///< chi square (1 dof) of "the legs are one straight line"
};

/// A straight run of points of a contour.
struct Leg {
  bool before = false;  ///< the corner, else after it
  std::size_t first = 0;
  std::size_t last = 0;
  LineFit line;
};

/// Variance of a point's distance from a line [m^2]: as measured, with the sensor's range noise at
/// the line's incidence as prior.
double noiseOf(const LineFit& line, const CornerModel& model);

/// The longest straight leg (tuning.leg_lengths_m) that ends (`before`) or begins at a point, if
/// there is any.
std::optional<Leg> longestLeg(const Contour& contour,
                              std::size_t end,
                              bool before,
                              const CornerModel& model);

/// Where the contour bends most, each the last point of the first of two legs: the points where two
/// lines describe the split_window_m on both sides better than one does, by more than at all the
/// points within split_spacing_m.
std::vector<std::size_t> findSplits(const Contour& contour, const TwoLineParameters& tuning);

/// Whether there are legs before and after a split whose directions differ more than noise
/// explains. fitCorner() is several times slower and yields nothing for the others.
///
/// The structure tensor of normals of Li & Olson (ICRA 2011), with the normals from lines fitted to
/// each of leg_lengths_m before and after.
bool isPromising(const Contour& contour, std::size_t split, const CornerModel& model);

/// What becomes of points so close to a corner that noise decided to which leg they were counted,
/// if without them a leg has too few: on a wall at a grazing angle one reading of the other wall
/// moves the crossing by more than the noise of the readings would.
enum class Contested {
  kIfNeeded,  ///< a leg keeps its three farthest points, whatever they are
  kNever,     ///< two certain points are enough for a leg; without them there is no corner
};

/// The corner of two straight legs that meet after the point `split`: the longest legs
/// that are straight, then their crossing with its covariance.
///
/// \return nothing if the contour there does not consist of two straight legs
std::optional<TwoLineCorner> fitCorner(const Contour& contour,
                                       std::size_t split,
                                       const CornerModel& model,
                                       Contested contested = Contested::kIfNeeded);

}  // namespace ramscout_feature_detector
