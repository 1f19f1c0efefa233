// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer: any scan is either refused with std::invalid_argument or yields finite features.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "ramscout_feature_detector/feature_detector.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  float header[4];
  if (size < sizeof(header) + sizeof(float)) return 0;
  std::memcpy(header, data, sizeof(header));
  ram_slam::LaserScan scan;
  scan.angle_min_rad = header[0];
  scan.angle_increment_rad = header[1];
  scan.range_min_m = header[2];
  scan.range_max_m = header[3];
  scan.ranges_m.resize((size - sizeof(header)) / sizeof(float));
  std::memcpy(scan.ranges_m.data(), data + sizeof(header), scan.ranges_m.size() * sizeof(float));
  static const ramscout_feature_detector::FeatureDetector detector({});
  try {
    for (const auto& feature : detector.detect(scan, {}).features) {
      if (!feature.position_m.allFinite() || !feature.covariance_m2.allFinite() ||
          !std::isfinite(feature.orientation_rad) || !(feature.covariance_m2.determinant() > 0.0)) {
        std::abort();
      }
    }
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
