// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "ramscout_feature_detector/polar_grid.hpp"

namespace ramscout_feature_detector {

/// Three cells of two bits each are one base64 character, the first cell in the lowest bits.
constexpr int kCellsPerDigit = 3;

inline const std::string& base64Digits() {
  static const std::string digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  return digits;
}

/// \param count  a multiple of kCellsPerDigit
inline void appendCells(const PolarGrid::Cell* cells, int count, std::string& to) {
  for (int i = 0; i < count; i += kCellsPerDigit) {
    to += base64Digits()[cells[i] | cells[i + 1] << 2 | cells[i + 2] << 4];
  }
}

/// Whether the text from `begin` to its end is that many cells; then they are written to `cells`.
inline bool readCells(const std::string& text,
                      std::size_t begin,
                      int count,
                      PolarGrid::Cell* cells) {
  if (text.size() != begin + static_cast<std::size_t>(count / kCellsPerDigit)) return false;
  for (int i = 0; i < count; ++i) {
    const std::size_t value = base64Digits().find(text[begin + i / kCellsPerDigit]);
    if (value == std::string::npos) return false;
    cells[i] = static_cast<PolarGrid::Cell>(value >> (2 * (i % kCellsPerDigit)) & 3U);
  }
  return true;
}

}  // namespace ramscout_feature_detector
