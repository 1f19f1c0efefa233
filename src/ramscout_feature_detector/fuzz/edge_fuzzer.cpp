// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer: any scan is either refused with std::invalid_argument or yields finite edges.
#include <cstdint>

#include "../test/fuzz_targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ramscout_feature_detector;
  static const EdgeDetector edges([] {
    EdgeDetectorParameters parameters;
    parameters.max_features = 2;
    return parameters;
  }());
  tryScan(edges, scanOfBytes(data, size, 32));
  return 0;
}
