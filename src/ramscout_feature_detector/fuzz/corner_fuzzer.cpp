// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer: any scan is either refused with std::invalid_argument or yields finite corners. Scans
// and the image are small, so that millions of them take an hour.
#include <cstdint>

#include "../test/fuzz_targets.hpp"

namespace {

using namespace ramscout_feature_detector;

constexpr std::size_t kMostBeams = 24;

FeatureDetectorParameters smallImage() {
  FeatureDetectorParameters parameters;
  parameters.ppm = 50.0;
  parameters.kernel_radius = 15;
  parameters.scale_levels = 1;
  parameters.max_features = 1;
  return parameters;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FeatureDetector corners(smallImage());
  tryScan(corners, scanOfBytes(data, size, kMostBeams));
  return 0;
}
