// SPDX-License-Identifier: BSD-3-Clause
#include "checkpoint_keeper.hpp"

#include <exception>
#include <filesystem>
#include <utility>

#include <ros/console.h>

#include "ram_slam/io/atomic_file.hpp"

namespace ram_slam_ros {
namespace {

/// The first name beside the file that is not taken.
std::string nameAside(const std::string& path) {
  for (int i = 1;; ++i) {
    const std::string name = path + ".refused-" + std::to_string(i);
    std::error_code none;
    if (!std::filesystem::exists(name, none)) return name;
  }
}

}  // namespace

CheckpointKeeper::CheckpointKeeper(std::string path, double period_s)
    : path_(std::move(path)), period_ns_(static_cast<std::int64_t>(period_s * 1e9)) {
  if (!path_.empty()) thread_ = std::thread([this] { run(); });
}

CheckpointKeeper::~CheckpointKeeper() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

std::optional<ram_slam::Checkpoint> CheckpointKeeper::load() {
  std::error_code none;
  if (path_.empty() || !std::filesystem::exists(path_, none)) return std::nullopt;
  try {
    ram_slam::Checkpoint checkpoint = ram_slam::checkpointFromBytes(ram_slam::readWholeFile(path_));
    kept_ns_ = checkpoint.map.stamp_ns;
    return checkpoint;
  } catch (const std::exception& error) {
    rename(error.what());
    return std::nullopt;
  }
}

void CheckpointKeeper::putAside(const std::string& reason) {
  queue([this, reason] { rename(reason); });
}

void CheckpointKeeper::rename(const std::string& reason) {
  std::error_code error;
  const std::string aside = nameAside(path_);
  std::filesystem::rename(path_, aside, error);
  if (!error) {
    ROS_WARN_STREAM("No checkpoint to continue from: " << path_ << ": " << reason << "; it is "
                                                       << aside << " now");
    return;
  }
  ROS_WARN_STREAM("No checkpoint to continue from, and none will be written: "
                  << path_ << ": " << reason << "; it cannot be put aside: " << error.message());
  const std::lock_guard<std::mutex> lock(mutex_);
  path_.clear();
}

bool CheckpointKeeper::isDue(std::int64_t stamp_ns) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return !path_.empty() && jobs_.empty() &&
         (stamp_ns >= kept_ns_ + period_ns_ || stamp_ns < kept_ns_);
}

void CheckpointKeeper::keep(ram_slam::Checkpoint checkpoint) {
  kept_ns_ = checkpoint.map.stamp_ns;
  queue([this, kept = std::move(checkpoint)] { write(kept); });
}

void CheckpointKeeper::remove() {
  kept_ns_ = 0;
  queue([this] {
    std::error_code error;
    std::filesystem::remove(path_, error);
    if (error) ROS_WARN_STREAM("The checkpoint " << path_ << " stays: " << error.message());
  });
}

void CheckpointKeeper::write(const ram_slam::Checkpoint& checkpoint) {
  try {
    const std::filesystem::path folder = std::filesystem::path(path_).parent_path();
    if (!folder.empty()) std::filesystem::create_directories(folder);
    ram_slam::writeFileAtomically(path_, ram_slam::toBytes(checkpoint));
    setProblem("");
  } catch (const std::exception& error) {
    setProblem("no checkpoint can be written, so that a crash loses the map: " +
               std::string(error.what()) + "; remove files, or set node/checkpoint_file");
  }
}

void CheckpointKeeper::setProblem(const std::string& problem) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (problem.empty() && !problem_.empty())
    ROS_INFO_STREAM("Checkpoints are written again to " << path_);
  problem_ = problem;
}

std::string CheckpointKeeper::problem() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return problem_;
}

void CheckpointKeeper::queue(std::function<void()> job) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (path_.empty()) return;
  jobs_.push_back(std::move(job));
  changed_.notify_all();
}

void CheckpointKeeper::run() {
  while (true) {
    std::function<void()> job;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait(lock, [this] { return stop_ || !jobs_.empty(); });
      if (jobs_.empty()) return;
      job = std::move(jobs_.front());  // its place stays until it is done
    }
    job();
    const std::lock_guard<std::mutex> lock(mutex_);
    jobs_.pop_front();
  }
}

}  // namespace ram_slam_ros
