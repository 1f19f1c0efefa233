// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace ram_slam {

/// Less than that, and the next map may not fit on the disk.
constexpr std::uint64_t kLeastFree_bytes = 50'000'000;

/// What to do if less is free on the disk of a folder, which need not exist yet; else empty.
std::string freeSpaceProblem(const std::string& folder,
                             std::uint64_t least_bytes = kLeastFree_bytes);

}  // namespace ram_slam
