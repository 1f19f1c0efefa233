// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "ram_slam/estimation/estimator.hpp"

namespace ram_slam {

/// Which readings belong into a map: those whose pose is known.
class TrackingGate {
public:
  /// \param is_lost  whether the robot's place is unknown until set() states that it is known
  explicit TrackingGate(bool is_lost = false) : is_lost_(is_lost) {}

  void set(const Tracking& tracking) {
    if (tracking.is_lost) {
      certain_until_ns_ = tracking.certain_until_ns;
    } else if (is_lost_) {
      found_ns_ = tracking.stamp_ns;
    }
    is_lost_ = tracking.is_lost;
  }
  bool isLost() const { return is_lost_; }
  /// Whether the pose at that stamp is known, as far as set() has stated.
  bool admits(std::int64_t stamp_ns) const {
    return stamp_ns <= certain_until_ns_ || (!is_lost_ && stamp_ns > found_ns_);
  }

private:
  bool is_lost_;
  std::int64_t certain_until_ns_ = 0;
  std::int64_t found_ns_ = 0;
};

}  // namespace ram_slam
