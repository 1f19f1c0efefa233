// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/text_file.hpp"

#include <array>
#include <fstream>
#include <stdexcept>

#include <boost/iostreams/filter/gzip.hpp>
#include <boost/iostreams/filter/lzma.hpp>
#include <boost/iostreams/filtering_stream.hpp>

namespace ramscout_bringup {
namespace {

/// Of a log's lines, which have some thousands; a packed file of some kilobytes may hold gigabytes.
constexpr std::size_t kLongestLine = 16'000'000;

enum class Packing { kNone, kGzip, kXz };

Packing detectPacking(std::ifstream& file) {
  std::array<char, 6> head{};
  file.read(head.data(), head.size());
  const std::string_view bytes(head.data(), static_cast<std::size_t>(file.gcount()));
  file.clear();
  file.seekg(0);
  if (bytes.substr(0, 2) == "\x1f\x8b") return Packing::kGzip;
  if (bytes == std::string_view("\xfd"
                                "7zXZ\0",
                                6))
    return Packing::kXz;
  return Packing::kNone;
}

}  // namespace

struct TextFile::Streams {
  std::ifstream file;
  boost::iostreams::filtering_istream text;
};

TextFile::TextFile(const std::string& path) : path_(path), streams_(std::make_unique<Streams>()) {
  streams_->file.open(path, std::ios::binary);
  if (!streams_->file) throw std::runtime_error(path + " cannot be read");
  const Packing packing = detectPacking(streams_->file);
  if (packing == Packing::kGzip) streams_->text.push(boost::iostreams::gzip_decompressor());
  if (packing == Packing::kXz) streams_->text.push(boost::iostreams::lzma_decompressor());
  streams_->text.push(streams_->file);
  streams_->text.exceptions(std::ios::badbit);
}

TextFile::~TextFile() = default;

std::optional<std::string_view> TextFile::nextLine() {
  try {
    line_.clear();
    std::streambuf& characters = *streams_->text.rdbuf();
    constexpr int kEnd = std::char_traits<char>::eof();
    int c = characters.sbumpc();
    if (c == kEnd) return std::nullopt;
    for (; c != kEnd && c != '\n'; c = characters.sbumpc()) {
      if (line_.size() >= kLongestLine)
        throw std::runtime_error("a line has more than 16 million characters");
      line_.push_back(static_cast<char>(c));
    }
  } catch (const std::exception& error) {
    throw std::runtime_error(path_ + " is damaged: " + error.what());
  }
  if (!line_.empty() && line_.back() == '\r') line_.pop_back();
  return line_;
}

}  // namespace ramscout_bringup
