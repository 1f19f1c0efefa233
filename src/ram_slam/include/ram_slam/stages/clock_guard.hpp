// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace ram_slam {

/// How a stamp follows those before it.
enum class StampOrder {
  kLater,     ///< as it should be
  kNotLater,  ///< a repetition, or out of order by a little
  kSetBack,   ///< so much older that the clock must have been set back, or a recording begins again
};

/// The rule by which every stage recognises that the clock was set back: a stamp more than one
/// second older than the newest one. Less is a message out of order.
class ClockGuard {
public:
  static constexpr std::int64_t kSetBackNs = 1'000'000'000;

  static bool isSetBack(std::int64_t newest_ns, std::int64_t stamp_ns) {
    return stamp_ns + kSetBackNs < newest_ns;
  }

  /// The newest stamp is this one from now on, unless it is merely not later.
  StampOrder check(std::int64_t stamp_ns) {
    if (isSetBack(newest_ns_, stamp_ns)) {
      newest_ns_ = stamp_ns;
      return StampOrder::kSetBack;
    }
    if (stamp_ns <= newest_ns_) return StampOrder::kNotLater;
    newest_ns_ = stamp_ns;
    return StampOrder::kLater;
  }

  /// 0: none yet.
  std::int64_t newest_ns() const { return newest_ns_; }

private:
  std::int64_t newest_ns_ = 0;
};

}  // namespace ram_slam
