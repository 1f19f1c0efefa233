// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/io/free_space.hpp"

#include <filesystem>
#include <system_error>

namespace ram_slam {

std::string freeSpaceProblem(const std::string& folder, std::uint64_t least_bytes) {
  std::error_code error;
  std::filesystem::path existing = std::filesystem::absolute(folder, error);
  while (!existing.empty() && existing != existing.root_path() &&
         !std::filesystem::exists(existing, error))
    existing = existing.parent_path();
  const std::filesystem::space_info space = std::filesystem::space(existing, error);
  if (error || space.available >= least_bytes) return "";
  return "the disk of " + folder + " is full: less than " +
         std::to_string(least_bytes / 1'000'000) +
         " MB are left, and no map can be saved; remove files";
}

}  // namespace ram_slam
