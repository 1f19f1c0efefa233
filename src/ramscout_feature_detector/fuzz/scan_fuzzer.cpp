// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer: any scan is either refused with std::invalid_argument or yields finite features. Scans
// are small and the image has one level only, so that millions of them take minutes.
#include <cstdint>

#include "../test/fuzz_targets.hpp"

namespace {

using namespace ramscout_feature_detector;

constexpr std::size_t kMostBeams = 48;

FeatureDetectorParameters cornerParameters() {
  FeatureDetectorParameters parameters;
  parameters.scale_levels = 1;
  parameters.max_features = 1;
  return parameters;
}

EdgeDetectorParameters edgeParameters() {
  EdgeDetectorParameters parameters;
  parameters.max_features = 2;
  return parameters;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FeatureDetector corners(cornerParameters());
  static const EdgeDetector edges(edgeParameters());
  tryScan(corners, edges, scanOfBytes(data, size, kMostBeams));
  return 0;
}
