// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer: any text is either no descriptor or one that compares to a finite ratio and is written
// as it was read.
#include <cstdint>

#include "../test/fuzz_targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ramscout_feature_detector::tryClassifier(data, size);
  return 0;
}
