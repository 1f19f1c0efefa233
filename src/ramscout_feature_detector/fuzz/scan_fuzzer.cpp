// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer: any scan is either refused with std::invalid_argument or yields finite features.
#include <cstdint>

#include "../test/fuzz_targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ramscout_feature_detector::tryScan(data, size);
  return 0;
}
