// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_slam/sensing/laser_scan.hpp"
#include "ramscout_feature_detector/contour.hpp"
#include "ramscout_feature_detector/parameters.hpp"

namespace ramscout_feature_detector {

/// Consecutive hits on one connected surface, in the order of the beams.
struct Surface {
  std::vector<std::size_t> beams;
  std::vector<Eigen::Vector2d> points_m;  ///< one for each beam, in the laser's frame
  bool closed = false;                    ///< goes all around: the last point meets the first
};

/// Whether the beams go all around, so that the last one is next to the first.
bool isFullTurn(const ram_slam::LaserScan& scan);

/// The scan's hits cut into connected surfaces.
///
/// A surface ends where a beam hit nothing or is invalid, and where two neighbours are further
/// apart than max(distance_threshold, r sin(a) / sin(10 deg - a) + 3 range_sigma), a the angle
/// between the beams: neighbours on a wall seen at a grazing angle are far apart too (Borges &
/// Aldon, Line extraction in 2D range images for mobile robotics, J. Intelligent and Robotic
/// Systems 40, 2004). A single reading far from both neighbours (mixed pixel, salt noise) is left
/// out. A full turn is joined at its seam.
std::vector<Surface> splitIntoSurfaces(const ram_slam::LaserScan& scan,
                                       double distance_threshold_m,
                                       double range_sigma_m,
                                       const SegmentationParameters& parameters);

/// The points of a surface of at least two. One that goes all around repeats its first `overlap_m`
/// at its end, so that nothing lies near its seam only.
Contour toContour(Surface surface, double overlap_m, const LineParameters& parameters);

/// The surfaces that corners can lie on: those with fewer than 5 points or shorter than twice
/// occlude_limit are dropped, nothing on them could be accepted.
std::vector<Contour> splitIntoContours(const ram_slam::LaserScan& scan,
                                       const FeatureDetectorParameters& parameters);

}  // namespace ramscout_feature_detector
