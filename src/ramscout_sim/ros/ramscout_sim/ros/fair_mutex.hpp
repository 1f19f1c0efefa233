// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>

namespace ramscout_sim_ros {

/// A mutex that is given to the thread that requested it first. A thread that unlocks and locks it
/// in a loop, as a simulation that runs as fast as it can does, keeps no other thread waiting for
/// longer than one round; with a std::mutex it can for seconds. Fits std::lock_guard,
/// std::unique_lock and std::condition_variable_any.
class FairMutex {
public:
  void lock() {
    std::unique_lock<std::mutex> lock(mutex_);
    const std::uint64_t ticket = next_ticket_++;
    served_.wait(lock, [this, ticket] { return now_serving_ == ticket; });
  }

  void unlock() {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++now_serving_;
    if (now_serving_ != next_ticket_) served_.notify_all();
  }

private:
  std::mutex mutex_;
  std::condition_variable served_;
  std::uint64_t next_ticket_ = 0;
  std::uint64_t now_serving_ = 0;
};

}  // namespace ramscout_sim_ros
