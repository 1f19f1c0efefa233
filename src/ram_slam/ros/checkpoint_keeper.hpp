// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "ram_slam/tracking/checkpoint.hpp"

namespace ram_slam_ros {

/// Keeps the estimator's newest checkpoint in a file. Files are written by a thread of its own, so
/// that a slow disk holds up nothing.
class CheckpointKeeper {
public:
  /// \param path  empty: no checkpoints, and all functions do nothing
  /// \param period_s  least time between two checkpoints, by their stamps
  CheckpointKeeper(std::string path, double period_s);
  /// Writes first what still waits.
  ~CheckpointKeeper();
  CheckpointKeeper(const CheckpointKeeper&) = delete;
  CheckpointKeeper& operator=(const CheckpointKeeper&) = delete;

  /// The checkpoint in the file, if there is a good one. Another file is put aside and logged.
  std::optional<ram_slam::Checkpoint> load();
  /// Renames the file, since this run cannot continue from it.
  void putAside(const std::string& reason);
  /// Whether keep() should be called. False while the one before is being written.
  bool isDue(std::int64_t stamp_ns);
  void keep(ram_slam::Checkpoint checkpoint);
  /// There is nothing to continue from any more: removes the file.
  void remove();
  /// Why the newest one could not be written, and what to do; empty if it was.
  std::string problem();

private:
  void run();
  void queue(std::function<void()> job);
  void write(const ram_slam::Checkpoint& checkpoint);
  void rename(const std::string& reason);
  void setProblem(const std::string& problem);

  std::string path_;
  std::int64_t period_ns_;
  std::int64_t kept_ns_ = 0;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;  ///< the first one is being done
  std::string problem_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace ram_slam_ros
