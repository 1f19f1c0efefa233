// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace ramscout_bringup {

/// Writers make chunks of a few megabytes; a larger one is damaged or meant to fill the memory.
inline constexpr std::uint64_t kMaxChunkSize = 256U << 20U;

/// The content of a chunk of a recording.
///
/// \param compression  `bz2`, `lz4` (frames), `zstd`; `none` or nothing
/// \param size  of the content in bytes, as the recording states it
/// \throws std::runtime_error if the chunk is damaged, has another size, is compressed otherwise,
/// or claims to hold more than kMaxChunkSize
std::vector<std::uint8_t> uncompressed(const std::string& compression,
                                       std::string_view chunk,
                                       std::uint64_t size);

}  // namespace ramscout_bringup
