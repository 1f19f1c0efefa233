// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace ramscout_feature_detector {

/// \throws std::invalid_argument naming the parameter, its value and its bounds; NaN is out of them
inline void requireWithin(const char* name, double value, double low, double high) {
  if (low <= value && value <= high) return;
  throw std::invalid_argument(std::string(name) + " must be in [" + std::to_string(low) + ", " +
                              std::to_string(high) + "], got " + std::to_string(value));
}

/// \throws std::invalid_argument if the name of a frame is empty or begins with a slash
inline void requireFrame(const char* name, const std::string& frame) {
  if (!frame.empty() && frame.front() != '/') return;
  throw std::invalid_argument(std::string(name) +
                              " must be a frame without a leading slash, got \"" + frame + "\"");
}

}  // namespace ramscout_feature_detector
