// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz_target.hpp"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include <ram_slam/io/atomic_file.hpp>
#include <unistd.h>

namespace ramscout_bringup_ros {
namespace {

/// In memory where there is such a place.
class Folder {
public:
  Folder() {
    const std::filesystem::path memory = "/dev/shm";
    path_ = (std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path()) /
            ("fuzz_" + std::to_string(getpid()));
    std::filesystem::create_directory(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

}  // namespace

std::string fuzzPath(const std::string& name) {
  static const Folder folder;
  return folder.path() / name;
}

FuzzTarget fileTarget(const std::string& name,
                      std::vector<std::string> seeds,
                      std::function<void(const std::string& path)> read) {
  return {name, std::move(seeds), [name, read = std::move(read)](const std::string& bytes) {
            const std::string path = fuzzPath(name);
            std::ofstream(path, std::ios::binary) << bytes;
            read(path);
          }};
}

std::vector<std::string> storedSeeds(const std::string& name) {
  const std::string path = FUZZ_SEEDS_FOLDER "/" + name;
  if (!std::filesystem::exists(path)) return {};
  return {ram_slam::readWholeFile(path)};
}

const std::vector<FuzzTarget>& fuzzTargets() {
  static const std::vector<FuzzTarget> targets = [] {
    std::vector<FuzzTarget> all;
    for (auto part : {recordingTargets, worldTargets, mapTargets, messageTargets}) {
      for (FuzzTarget& target : part()) all.push_back(std::move(target));
    }
    return all;
  }();
  return targets;
}

const FuzzTarget& fuzzTarget(const std::string& name) {
  std::string names;
  for (const FuzzTarget& target : fuzzTargets()) {
    if (target.name == name) return target;
    names += " " + target.name;
  }
  throw std::invalid_argument("there is no target '" + name + "', only" + names);
}

void tryBytes(const FuzzTarget& target, const std::string& bytes) {
  std::string refusal;
  try {
    target.read(bytes);
    return;
  } catch (const std::runtime_error& error) {
    refusal = error.what();
  } catch (const std::invalid_argument& error) {
    refusal = error.what();
  } catch (const std::exception& error) {
    throw std::logic_error(target.name +
                           ": refused with an exception of another type: " + error.what());
  }
  // Or another file that it refers to.
  if (target.is_file && refusal.find(fuzzPath("")) == std::string::npos)
    throw std::logic_error(target.name + ": the refusal does not name the file: " + refusal);
}

}  // namespace ramscout_bringup_ros
