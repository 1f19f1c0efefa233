// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

#include <Eigen/LU>

#include "ramscout_feature_detector/corner_matcher.hpp"
#include "ramscout_feature_detector/edge_detector.hpp"
#include "ramscout_feature_detector/feature_detector.hpp"
#include "ramscout_feature_detector/polar_grid.hpp"

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

/// Four floats of geometry and limits, then one byte for each range: what a lidar sees is mostly
/// smooth, so that the bytes are steps from range to range; the highest ones are values without
/// meaning.
inline ram_slam::LaserScan scanOfBytes(const std::uint8_t* data, std::size_t size) {
  ram_slam::LaserScan scan;
  float header[4] = {};
  std::memcpy(header, data, std::min(size, sizeof(header)));
  scan.angle_min_rad = header[0];
  scan.angle_increment_rad = header[1];
  scan.range_min_m = header[2];
  scan.range_max_m = header[3];
  const float odd[] = {NAN, INFINITY, -INFINITY, 0.0F, -1.0F, 1e30F, 1e-40F, header[3]};
  float range_m = 2.0F;
  for (std::size_t i = sizeof(header); i < size; ++i) {
    if (data[i] >= 248) {
      scan.ranges_m.push_back(odd[data[i] - 248]);
      continue;
    }
    const float step = (static_cast<float>(data[i]) - 124.0F) / 124.0F;
    range_m += step * step * step * 2.0F;
    scan.ranges_m.push_back(range_m);
  }
  return scan;
}

inline void tryScan(const std::uint8_t* data, std::size_t size) {
  static const FeatureDetector detector({});
  static const EdgeDetector edge_detector({});
  const ram_slam::LaserScan scan = scanOfBytes(data, size);
  try {
    requireFinite(detector.detect(scan, {}));
    requireFinite(edge_detector.detect(scan, {}));
  } catch (const std::invalid_argument&) {
  }
}

inline void tryClassifier(const std::uint8_t* data, std::size_t size) {
  static const CornerMatcher matcher;
  std::string text(reinterpret_cast<const char*>(data), size);
  if (size > 0 && data[0] % 2 == 0) text = "pg1:8x24:4.0:" + text.substr(1);
  const auto descriptor = matcher.parse(text);
  const auto grid = PolarGrid::parse(text);
  if ((descriptor != nullptr) != grid.has_value()) std::abort();
  if (!grid) return;
  if (grid->toString() != text) std::abort();
  const double ratio = matcher.logLikelihoodRatio(*descriptor, *descriptor);
  if (!(std::abs(ratio) <= std::log(20.0) + 0.01)) std::abort();
}

}  // namespace ramscout_feature_detector
