// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace ram_slam {

/// Counts messages that were lost on their way, by the numbers that their publishers give them: a
/// queue that overflows loses messages without any other trace.
class LossCounter {
public:
  /// A message arrived. \param number  the publisher's: one more than that of the one before
  void add(const std::string& publisher, std::uint32_t number) {
    const auto [last, is_first] = last_.emplace(publisher, number);
    ++received_;
    // Counted modulo 2^32; what goes back, repeats or leaps far is another numbering.
    const std::uint32_t step = number - last->second;
    if (!is_first && step > 1 && step < kMostLost) lost_ += step - 1;
    last->second = number;
  }

  std::uint64_t received() const { return received_; }
  std::uint64_t lost() const { return lost_; }

private:
  static constexpr std::uint32_t kMostLost = 1'000'000;

  std::map<std::string, std::uint32_t> last_;
  std::uint64_t received_ = 0;
  std::uint64_t lost_ = 0;
};

/// The share of messages that did not come, or were not used, since the call before.
class DropShare {
public:
  /// All three counted from the start; what was dropped had arrived.
  void update(std::uint64_t arrived, std::uint64_t lost, std::uint64_t dropped) {
    const std::uint64_t wanted = arrived - arrived_ + lost - lost_;
    const std::uint64_t unused = lost - lost_ + dropped - dropped_;
    share_ = unused == 0 ? 0.0
                         : static_cast<double>(unused) /
                               static_cast<double>(wanted > unused ? wanted : unused);
    arrived_ = arrived;
    lost_ = lost;
    dropped_ = dropped;
  }
  /// In [0, 1].
  double share() const { return share_; }

private:
  std::uint64_t arrived_ = 0;
  std::uint64_t lost_ = 0;
  std::uint64_t dropped_ = 0;
  double share_ = 0.0;
};

}  // namespace ram_slam
