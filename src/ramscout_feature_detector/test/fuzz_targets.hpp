// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

#include <Eigen/LU>

#include "ramscout_feature_detector/corner_matcher.hpp"
#include "ramscout_feature_detector/edge_detector.hpp"
#include "ramscout_feature_detector/edge_matcher.hpp"
#include "ramscout_feature_detector/feature_detector.hpp"
#include "ramscout_feature_detector/polar_grid.hpp"
#include "ramscout_feature_detector/view_grid.hpp"

// What the fuzzers try with any bytes, and a test with a fixed sequence of them. Aborts on a
// finding.
namespace ramscout_feature_detector {

inline void requireFinite(const ram_slam::FeatureList& list) {
  for (const ram_slam::Feature& feature : list.features) {
    if (!feature.position_m.allFinite() || !feature.covariance_m2.allFinite() ||
        !std::isfinite(feature.orientation_rad) || !(feature.orientation_variance_rad2 > 0.0) ||
        !(feature.covariance_m2.determinant() > 0.0)) {
      std::abort();
    }
  }
}

/// The distance to the walls of a room around the laser, 2.2 m by 1.6 m.
inline float roomRange_m(double bearing_rad) {
  const double x = std::max(std::abs(std::cos(bearing_rad)), 1e-9);
  const double y = std::max(std::abs(std::sin(bearing_rad)), 1e-9);
  return static_cast<float>(std::min(1.1 / x, 0.8 / y));
}

/// The first byte chooses among scans of a room and scans of any geometry and limits, given by four
/// floats. Then one byte for each range, at most `max_beams` and in a room at most a turn: what a
/// lidar sees is mostly smooth, so that the bytes are steps of the distance from the room's walls;
/// the highest ones are values without meaning.
inline ram_slam::LaserScan scanOfBytes(const std::uint8_t* data,
                                       std::size_t size,
                                       std::size_t max_beams) {
  struct Geometry {
    float angle_min_rad, angle_increment_rad, range_min_m, range_max_m;
  };
  static constexpr Geometry kRooms[] = {{-0.2F, 0.025F, 0.05F, 30.0F},
                                        {1.5F, -0.04F, 0.0F, 2.0F},
                                        {-3.14159265F, 0.09817477F, 0.1F, 8.0F}};
  ram_slam::LaserScan scan;
  if (size == 0) return scan;
  const std::size_t kind = data[0] % 4;
  std::size_t next = 1;
  Geometry geometry{};
  if (kind < 3) {
    geometry = kRooms[kind];
    const double turn = 2.0 * M_PI / std::abs(static_cast<double>(geometry.angle_increment_rad));
    max_beams = std::min(max_beams, static_cast<std::size_t>(turn));
  } else {
    std::memcpy(&geometry, data + 1, std::min(size - 1, sizeof(geometry)));
    next += sizeof(geometry);
  }
  scan.angle_min_rad = geometry.angle_min_rad;
  scan.angle_increment_rad = geometry.angle_increment_rad;
  scan.range_min_m = geometry.range_min_m;
  scan.range_max_m = geometry.range_max_m;
  const float odd[] = {NAN, INFINITY, -INFINITY, 0.0F, -1.0F, 1e30F, 1e-40F, geometry.range_max_m};
  float off_m = 0.0F;
  for (; next < size && scan.ranges_m.size() < max_beams; ++next) {
    if (data[next] >= 248) {
      scan.ranges_m.push_back(odd[data[next] - 248]);
      continue;
    }
    const float step = (static_cast<float>(data[next]) - 124.0F) / 124.0F;
    off_m += step * step * step * 2.0F;
    scan.ranges_m.push_back(off_m + roomRange_m(scan.bearing_rad(scan.ranges_m.size())));
  }
  return scan;
}

/// \tparam Detector  FeatureDetector or EdgeDetector
template <typename Detector>
void tryScan(const Detector& detector, const ram_slam::LaserScan& scan) {
  try {
    requireFinite(detector.detect(scan, {}));
  } catch (const std::invalid_argument&) {
  }
}

template <typename Matcher, typename Grid>
void tryText(const std::string& text) {
  static const Matcher matcher;
  const auto descriptor = matcher.parse(text);
  const auto grid = Grid::parse(text);
  if ((descriptor != nullptr) != grid.has_value()) std::abort();
  if (!grid) return;
  if (grid->toString() != text) std::abort();
  const double ratio = matcher.logLikelihoodRatio(*descriptor, *descriptor);
  if (!(std::abs(ratio) <= std::log(20.0) + 0.01)) std::abort();
}

inline void tryClassifier(const std::uint8_t* data, std::size_t size) {
  std::string text(reinterpret_cast<const char*>(data), size);
  if (size > 0 && data[0] % 3 == 0) text = "pg1:8x24:4.0:" + text.substr(1);
  if (size > 0 && data[0] % 3 == 1) text = "pg2:8x48:8.0:" + text.substr(1);
  tryText<CornerMatcher, PolarGrid>(text);
  tryText<EdgeMatcher, ViewGrid>(text);
}

}  // namespace ramscout_feature_detector
