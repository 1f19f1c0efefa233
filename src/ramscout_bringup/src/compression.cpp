// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/compression.hpp"

#include <memory>
#include <stdexcept>

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

namespace ramscout_bringup {
namespace {

using Bytes = std::vector<std::uint8_t>;

bool uncompressLz4(std::string_view chunk, Bytes& content) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0)
    throw std::runtime_error("no memory to decompress");
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(
      context, LZ4F_freeDecompressionContext);
  std::size_t written = 0;
  while (!chunk.empty()) {
    std::size_t room = content.size() - written;
    std::size_t used = chunk.size();
    const std::size_t state =
        LZ4F_decompress(context, content.data() + written, &room, chunk.data(), &used, nullptr);
    if (LZ4F_isError(state) != 0 || (room == 0 && used == 0)) return false;
    written += room;
    chunk.remove_prefix(used);
    if (state == 0) break;
  }
  return written == content.size();
}

bool uncompressBz2(std::string_view chunk, Bytes& content) {
  auto written = static_cast<unsigned int>(content.size());
  // The library does not write to its input.
  return BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(content.data()), &written,
                                    const_cast<char*>(chunk.data()),
                                    static_cast<unsigned int>(chunk.size()), 0, 0) == BZ_OK &&
         written == content.size();
}

bool uncompressZstd(std::string_view chunk, Bytes& content) {
  return ZSTD_decompress(content.data(), content.size(), chunk.data(), chunk.size()) ==
         content.size();
}

}  // namespace

std::vector<std::uint8_t> uncompressed(const std::string& compression,
                                       std::string_view chunk,
                                       std::uint64_t size) {
  if (compression.empty() || compression == "none") {
    if (chunk.size() != size) throw std::runtime_error("a chunk does not have its size");
    return {chunk.begin(), chunk.end()};
  }
  const auto uncompress = compression == "lz4"    ? uncompressLz4
                          : compression == "bz2"  ? uncompressBz2
                          : compression == "zstd" ? uncompressZstd
                                                  : nullptr;
  if (uncompress == nullptr)
    throw std::runtime_error("a chunk is compressed as '" + compression + "'");
  if (size > kMaxChunkSize)
    throw std::runtime_error("a chunk of " + std::to_string(size) + " bytes");
  Bytes content(size);
  if (!uncompress(chunk, content)) throw std::runtime_error("a chunk cannot be decompressed");
  return content;
}

}  // namespace ramscout_bringup
