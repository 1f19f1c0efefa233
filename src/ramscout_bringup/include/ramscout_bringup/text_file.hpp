// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace ramscout_bringup {

/// A text file read line by line; `.xz` and `.gz` are unpacked on the way, recognised by
/// their first bytes, not their name.
class TextFile {
public:
  /// \throws std::runtime_error naming the file if it cannot be opened
  explicit TextFile(const std::string& path);
  ~TextFile();
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;

  /// The next line without its end ("\n" or "\r\n"), valid until the next call; none at the end of
  /// the file. \throws std::runtime_error naming the file if it is damaged
  std::optional<std::string_view> nextLine();

private:
  struct Streams;

  std::string path_;
  std::unique_ptr<Streams> streams_;
  std::string line_;
};

}  // namespace ramscout_bringup
