// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

namespace ram_slam {

/// Replaces the file at `path` by one with this content, in one step: it is written beside the old
/// one, synced to disk, read back, renamed over it, and the folder is synced. Whatever fails, the
/// old file stays as it was and nothing is left behind; what a killed writer left in the folder is
/// removed by the next one. A device or pipe is written to as it is, never replaced. Not for two
/// threads writing the same path at once. \throws std::system_error naming the file and the
/// system's reason (disk full, no permission, no such folder ...)
void writeFileAtomically(const std::string& path, const std::string& content);

/// Removes files and folders that writers into this folder left behind when they were killed.
void removeLeftOver(const std::string& folder);

/// No file of a map is larger: 2 GiB, so that a wrong path does not fill the memory.
constexpr std::size_t kMaxFileBytes = std::size_t{1} << 31;

/// The whole content of a file.
/// \throws std::system_error naming the file and the system's reason
/// \throws std::length_error if it is longer than `max_bytes`
std::string readWholeFile(const std::string& path, std::size_t max_bytes = kMaxFileBytes);

/// `folder/name`, for a name that came over the wire: letters, digits, '_', '-' and '.', 1 to 100
/// of them, not starting with '.'. So the result lies in the folder. \throws std::invalid_argument
/// for any other name
std::string pathInFolder(const std::string& folder, const std::string& name);

/// The path with a leading `~` replaced by the home folder, if there is one.
std::string expandHome(const std::string& path);

}  // namespace ram_slam
