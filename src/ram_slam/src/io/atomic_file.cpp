// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/io/atomic_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

namespace ram_slam {
namespace {

constexpr std::size_t kMaxNameLength = 100;

[[noreturn]] void fail(int error, const std::string& doing, const std::string& path) {
  throw std::system_error(error, std::generic_category(), doing + " " + path);
}

/// An open file; closing is the destructor's, unless close() was called to see its result.
class File {
public:
  File(const std::string& path, int flags, const std::string& doing)
      : path_(path), doing_(doing), descriptor_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) fail(errno, doing_, path_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  void write(const std::string& content) {
    std::size_t done = 0;
    while (done < content.size()) {
      const ssize_t count = ::write(descriptor_, content.data() + done, content.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) fail(count < 0 ? errno : EIO, doing_, path_);
      done += static_cast<std::size_t>(count);
    }
  }
  /// Up to `size` bytes; fewer only at the end of the file.
  std::string read(std::size_t size) {
    std::string content(size, '\0');
    std::size_t done = 0;
    while (done < size) {
      const ssize_t count = ::read(descriptor_, content.data() + done, size - done);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail(errno, doing_, path_);
      if (count == 0) break;
      done += static_cast<std::size_t>(count);
    }
    content.resize(done);
    return content;
  }
  void sync() {
    if (::fsync(descriptor_) != 0) fail(errno, doing_, path_);
  }
  void close() {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    if (::close(descriptor) != 0) fail(errno, doing_, path_);
  }
  std::size_t size() const {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) fail(errno, doing_, path_);
    if (!S_ISREG(status.st_mode)) fail(S_ISDIR(status.st_mode) ? EISDIR : EINVAL, doing_, path_);
    return static_cast<std::size_t>(status.st_size);
  }

private:
  std::string path_;
  std::string doing_;
  int descriptor_;
};

/// Removes the file at the end of the scope.
class RemovedAtEnd {
public:
  explicit RemovedAtEnd(std::string path) : path_(std::move(path)) {}
  RemovedAtEnd(const RemovedAtEnd&) = delete;
  RemovedAtEnd& operator=(const RemovedAtEnd&) = delete;
  ~RemovedAtEnd() { ::unlink(path_.c_str()); }

private:
  std::string path_;
};

/// Beyond this limit the kernel would not only refuse to write but end the process by SIGXFSZ.
void checkFileSizeLimit(std::size_t size, const std::string& path) {
  struct rlimit limit {};
  if (::getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
      size > limit.rlim_cur) {
    fail(EFBIG, "writing", path);
  }
}

std::string folderOf(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

constexpr const char* kTemporaryMark = ".writing-";

bool isRunning(const std::string& process) {
  const auto id = static_cast<pid_t>(std::strtol(process.c_str(), nullptr, 10));
  return ::kill(id, 0) == 0 || errno == EPERM;
}

/// Devices and pipes, such as /dev/stdout, are written to: a file in their place would break the
/// system.
bool isNoFile(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))
    return true;
  const bool is_of_system = path.rfind("/dev/", 0) == 0 || path.rfind("/proc/", 0) == 0;
  return is_of_system && ::lstat(path.c_str(), &status) == 0 && S_ISLNK(status.st_mode);
}

}  // namespace

void removeLeftOver(const std::string& folder) {
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename().string();
    const std::size_t mark = name.rfind(kTemporaryMark);
    if (mark == std::string::npos) continue;
    const std::string process = name.substr(mark + std::string(kTemporaryMark).size());
    const bool is_number = !process.empty() && process.size() < 10 &&
                           process.find_first_not_of("0123456789") == std::string::npos;
    if (is_number && !isRunning(process)) std::filesystem::remove_all(entry.path(), none);
  }
}

void writeFileAtomically(const std::string& path, const std::string& content) {
  checkFileSizeLimit(content.size(), path);
  if (isNoFile(path)) {
    File device(path, O_WRONLY, "writing");
    device.write(content);
    device.close();
    return;
  }
  removeLeftOver(folderOf(path));
  const std::string temporary = path + kTemporaryMark + std::to_string(::getpid());
  ::unlink(temporary.c_str());  // of an earlier process with this id that was killed
  File file(temporary, O_WRONLY | O_CREAT | O_EXCL, "writing");
  const RemovedAtEnd cleanup(temporary);
  file.write(content);
  file.sync();
  file.close();
  if (File(temporary, O_RDONLY, "reading back").read(content.size() + 1) != content)
    fail(EIO, "reading back", path);
  if (::rename(temporary.c_str(), path.c_str()) != 0) fail(errno, "renaming to", path);
  File(folderOf(path), O_RDONLY | O_DIRECTORY, "syncing").sync();
}

std::string readWholeFile(const std::string& path, std::size_t max_bytes) {
  File file(path, O_RDONLY | O_NONBLOCK, "reading");
  const std::size_t size = file.size();
  if (size > max_bytes) {
    throw std::length_error("reading " + path + ": it has " + std::to_string(size) +
                            " bytes, at most " + std::to_string(max_bytes) + " are taken");
  }
  return file.read(size);
}

std::string pathInFolder(const std::string& folder, const std::string& name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
  };
  if (name.empty() || name.size() > kMaxNameLength || name.front() == '.' ||
      !std::all_of(name.begin(), name.end(), allowed)) {
    throw std::invalid_argument(
        "a file name must be 1 to 100 letters, digits, '_', '-' and '.', not starting with '.'; "
        "got '" +
        name.substr(0, kMaxNameLength) + "'");
  }
  return (std::filesystem::path(folder) / name).string();
}

std::string expandHome(const std::string& path) {
  const char* home = std::getenv("HOME");
  if (home == nullptr || (path != "~" && path.compare(0, 2, "~/") != 0)) return path;
  return home + path.substr(1);
}

}  // namespace ram_slam
