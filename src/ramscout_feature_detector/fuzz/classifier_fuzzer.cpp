// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer: any text is either no descriptor or one that compares to a finite ratio and is written
// as it was read.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "ramscout_feature_detector/corner_matcher.hpp"
#include "ramscout_feature_detector/polar_grid.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ramscout_feature_detector::CornerMatcher matcher;
  std::string text(reinterpret_cast<const char*>(data), size);
  if (size > 0 && data[0] % 2 == 0) text = "pg1:8x24:4.0:" + text.substr(1);
  const auto descriptor = matcher.parse(text);
  const auto grid = ramscout_feature_detector::PolarGrid::parse(text);
  if ((descriptor != nullptr) != grid.has_value()) std::abort();
  if (!grid) return 0;
  if (grid->toString() != text) std::abort();
  if (!(std::abs(matcher.logLikelihoodRatio(*descriptor, *descriptor)) <= std::log(20.0) + 0.01))
    std::abort();
  return 0;
}
