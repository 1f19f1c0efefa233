// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace ram_slam {

inline std::int64_t toNanoseconds(double duration_s) {
  return static_cast<std::int64_t>(duration_s * 1e9);
}

}  // namespace ram_slam
