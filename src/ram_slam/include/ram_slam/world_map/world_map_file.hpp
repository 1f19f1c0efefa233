// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ram_slam/world_map/world_map.hpp"

namespace ram_slam {

/// A map as the bytes of a file: "RAMWORLD", the format's version, the length of the content and
/// its checksum (FNV-1a, 64 bit), then the content; numbers little-endian on every machine. The
/// same map gives the same bytes.
std::string toBytes(const WorldMap& map);

/// The map that toBytes() wrote.
/// \throws std::runtime_error with what is wrong: not such a file, a newer version, cut short,
/// damaged, or a content
///         that WorldMap refuses. Allocates no more than the bytes account for.
WorldMap worldMapFromBytes(const std::string& bytes);

}  // namespace ram_slam
