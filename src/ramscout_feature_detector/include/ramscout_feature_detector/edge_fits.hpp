// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "ram_slam/sensing/laser_scan.hpp"
#include "ramscout_feature_detector/contour.hpp"
#include "ramscout_feature_detector/edge.hpp"
#include "ramscout_feature_detector/segmentation.hpp"

namespace ramscout_feature_detector {

/// What the beams beside the first (or last) beam of a surface show of its end there.
struct Beside {
  /// The next beam goes past the surface and sees nothing or what is behind it.
  bool in_front = false;
  std::size_t beam = 0;  ///< the surface's own
  std::size_t next = 0;  ///< beside it; only if in_front
};
Beside beside(const Surface& surface, bool first, const ram_slam::LaserScan& scan);

/// A small free-standing thing, at the likeliest place of its middle: depth_share of the width that
/// is seen behind what is seen (a square's is half behind its side, or between two of its corners;
/// that of a round thing between its outermost beams).
///
/// \return nothing if the beams are too far apart
std::optional<Edge> fitObject(const Surface& surface,
                              double increment_rad,
                              const EdgeDetectorParameters& parameters);

/// The first or last end of a surface that the laser sees past: on the line of its last straight
/// leg, between its last beam and the next. So it is uncertain along the beam by the line, and
/// along the line by where between two beams it lies.
///
/// \return nothing if the next beam may see the same line continue, as on a wall at a grazing
///         angle, or if the end is too uncertain
std::optional<Edge> fitEnd(const Contour& contour,
                           bool first,
                           const Beside& beside,
                           const ram_slam::LaserScan& scan,
                           const EdgeDetectorParameters& parameters);

/// Corners of two straight legs (fitCorner()).
std::vector<Edge> findCorners(const Contour& contour, const EdgeDetectorParameters& parameters);

/// The sharpest turns of a contour, whatever its shape.
std::vector<Edge> findBends(const Contour& contour,
                            double increment_rad,
                            const EdgeDetectorParameters& parameters);

}  // namespace ramscout_feature_detector
