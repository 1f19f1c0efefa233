// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/io/atomic_folder.hpp"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "ram_slam/io/atomic_file.hpp"

namespace ram_slam {
namespace {

[[noreturn]] void fail(int error, const std::string& doing, const std::string& path) {
  throw std::system_error(error, std::generic_category(), doing + " " + path);
}

/// Removes the folder at the end of the scope.
class FolderRemovedAtEnd {
public:
  explicit FolderRemovedAtEnd(std::string path) : path_(std::move(path)) {}
  FolderRemovedAtEnd(const FolderRemovedAtEnd&) = delete;
  FolderRemovedAtEnd& operator=(const FolderRemovedAtEnd&) = delete;
  ~FolderRemovedAtEnd() {
    std::error_code none;
    std::filesystem::remove_all(path_, none);
  }

private:
  std::string path_;
};

void syncFolder(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) fail(errno, "syncing", path);
  const int result = ::fsync(descriptor);
  const int error = errno;
  ::close(descriptor);
  if (result != 0) fail(error, "syncing", path);
}

/// Some network file systems cannot exchange two names in one step.
void replaceInTwoSteps(const std::string& fresh, const std::string& path) {
  const std::string old = path + ".old-" + std::to_string(::getpid());
  if (::rename(path.c_str(), old.c_str()) != 0) fail(errno, "renaming", path);
  if (::rename(fresh.c_str(), path.c_str()) != 0) {
    const int error = errno;
    ::rename(old.c_str(), path.c_str());
    fail(error, "renaming to", path);
  }
  ::rename(old.c_str(), fresh.c_str());
}

/// Afterwards `fresh` is the name of the old folder, if there was one.
void exchange(const std::string& fresh, const std::string& path) {
  if (!std::filesystem::exists(path)) {
    if (::rename(fresh.c_str(), path.c_str()) != 0) fail(errno, "renaming to", path);
    return;
  }
  if (!std::filesystem::is_directory(path)) fail(ENOTDIR, "replacing", path);
  if (::renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, path.c_str(), RENAME_EXCHANGE) == 0) return;
  if (errno != EINVAL && errno != ENOSYS) fail(errno, "renaming to", path);
  replaceInTwoSteps(fresh, path);
}

}  // namespace

void writeFolderAtomically(const std::string& path,
                           const std::map<std::string, std::string>& files) {
  const std::string fresh = path + ".writing-" + std::to_string(::getpid());
  const std::string parent = std::filesystem::path(path).parent_path().string();
  removeLeftOver(parent.empty() ? "." : parent);
  std::filesystem::remove_all(fresh);  // of an earlier process with this id that was killed
  const FolderRemovedAtEnd cleanup(fresh);
  std::filesystem::create_directories(fresh);
  for (const auto& [name, content] : files) writeFileAtomically(fresh + "/" + name, content);
  exchange(fresh, path);
  syncFolder(parent.empty() ? "." : parent);
}

}  // namespace ram_slam
