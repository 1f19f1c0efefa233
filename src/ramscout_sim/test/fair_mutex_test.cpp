// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/ros/fair_mutex.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

namespace ramscout_sim_ros {
namespace {

TEST(FairMutex, LetsAWaitingThreadInBeforeTheOwnerComesBack) {
  FairMutex mutex;
  std::atomic<bool> stop{false};
  int rounds = 0;
  std::thread owner([&] {
    while (!stop) {
      const std::lock_guard<FairMutex> lock(mutex);
      ++rounds;
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  });
  std::vector<int> waited;
  int before = 0;
  for (int i = 0; i < 41; ++i) {
    const std::lock_guard<FairMutex> lock(mutex);
    waited.push_back(rounds - before);
    before = rounds;
  }
  stop = true;
  owner.join();
  // One round each; a std::mutex gives the owner dozens.
  std::sort(waited.begin(), waited.end());
  EXPECT_LE(waited[20], 2);
}

}  // namespace
}  // namespace ramscout_sim_ros
