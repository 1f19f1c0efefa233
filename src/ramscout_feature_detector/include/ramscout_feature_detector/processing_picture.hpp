// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ram_slam/sensing/laser_scan.hpp"
#include "ramscout_feature_detector/feature_detector.hpp"

namespace ramscout_feature_detector {

/// An image of 8-bit red, green and blue, row by row from the top.
struct Picture {
  int columns = 0;
  int rows = 0;
  std::vector<std::uint8_t> rgb;

  void set(int row, int column, const std::array<std::uint8_t, 3>& colour);
};

/// What the detector does with a scan, as three pictures side by side: the raster, the corner
/// response, and the result with the regions around surfaces' ends where nothing is accepted (grey)
/// and the corners (red crosses).
///
/// Of the surroundings up to picture.reach_m, x to the right and y up, on the coarsest level of the
/// pyramid; each picture is at most picture.max_pixels wide. Takes tens of milliseconds.
/// \throws std::invalid_argument if the scan is not usable
Picture pictureOfProcessing(const FeatureDetector& detector, const ram_slam::LaserScan& scan);

}  // namespace ramscout_feature_detector
