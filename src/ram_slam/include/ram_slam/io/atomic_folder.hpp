// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

namespace ram_slam {

/// Replaces the folder at `path` by one that holds these files and nothing else, in one step: it is
/// written beside the old one, synced to disk, and the two change their names. Whatever fails, the
/// old folder stays as it was. Not for two threads writing the same path at once.
/// \param files  content by name
/// \throws std::system_error naming the file or folder and the system's reason
void writeFolderAtomically(const std::string& path,
                           const std::map<std::string, std::string>& files);

}  // namespace ram_slam
