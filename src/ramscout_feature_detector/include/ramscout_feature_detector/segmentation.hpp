// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_slam/laser_scan.hpp"
#include "ramscout_feature_detector/contour.hpp"
#include "ramscout_feature_detector/parameters.hpp"

namespace ramscout_feature_detector {

/// The scan's hits cut into connected surfaces, in the laser's frame.
///
/// A surface ends where a beam hit nothing or is invalid, and where two neighbours are further
/// apart than max(distance_threshold, r sin(a) / sin(10 deg - a) + 3 laser_range_sigma), a the
/// angle between the beams: neighbours on a wall seen at a grazing angle are far apart too (Borges
/// & Aldon, Line extraction in 2D range images for mobile robotics, J. Intelligent and Robotic
/// Systems 40, 2004). A single reading far from both neighbours (mixed pixel, salt noise) is left
/// out. Surfaces with fewer than 5 points or shorter than twice occlude_limit are dropped: nothing
/// on them could be accepted. A full turn is joined at its seam; a surface all around repeats its
/// beginning at its end.
std::vector<Contour> splitIntoContours(const ram_slam::LaserScan& scan,
                                       const FeatureDetectorParameters& parameters);

}  // namespace ramscout_feature_detector
