// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace ramscout_bringup_ros {

/// Something that reads bytes which anyone may have written: a parser of files, or the conversion
/// of a message.
struct FuzzTarget {
  std::string name;                ///< of a parser: the file's
  std::vector<std::string> seeds;  ///< sound inputs
  /// Reads the bytes. \throws std::runtime_error or std::invalid_argument if they are refused; of
  /// files the text contains the file's name
  std::function<void(const std::string& bytes)> read;
  bool is_file = true;
};

/// All of them; the only list.
const std::vector<FuzzTarget>& fuzzTargets();

/// \throws std::invalid_argument naming all targets if there is none of that name
const FuzzTarget& fuzzTarget(const std::string& name);

/// Bytes are to be read or refused, nothing else. \throws std::logic_error with the finding:
/// refused by another exception, or without the name of the file
void tryBytes(const FuzzTarget& target, const std::string& bytes);

/// Parts of the list.
std::vector<FuzzTarget> recordingTargets();
std::vector<FuzzTarget> worldTargets();
std::vector<FuzzTarget> mapTargets();
std::vector<FuzzTarget> messageTargets();

/// A target whose bytes are a file, in a folder of this process that is removed at its end.
/// \param read  gets the file's path
FuzzTarget fileTarget(const std::string& name,
                      std::vector<std::string> seeds,
                      std::function<void(const std::string& path)> read);
/// A path in that folder.
std::string fuzzPath(const std::string& name);
/// The sound files of fuzz/seeds with that name: one, or none.
std::vector<std::string> storedSeeds(const std::string& name);

/// Numbers from bytes; zeros where they end.
class ByteReader {
public:
  explicit ByteReader(const std::string& bytes) : bytes_(bytes) {}

  template <typename Number>
  Number take() {
    Number number{};
    if (!isAtEnd()) bytes_.copy(reinterpret_cast<char*>(&number), sizeof(number), at_);
    at_ += sizeof(number);
    return number;
  }
  /// As many bytes as the next one states.
  std::string text() {
    const std::size_t length = take<std::uint8_t>();
    const std::string result = isAtEnd() ? "" : bytes_.substr(at_, length);
    at_ += length;
    return result;
  }
  bool isAtEnd() const { return at_ >= bytes_.size(); }

private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

}  // namespace ramscout_bringup_ros
