// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// Learns while driving by how much the stamps of the wheels' odometry and those of the scans
/// differ: drivers stamp when they read, not when the sensor measured, and 0.1 s at 1 rad/s is 6
/// degrees that look like slip.
///
/// Both tell how far the robot turned between the same two instants; of a row of offsets the one
/// counts at which the sum of absolute differences over all turns so far is the least.
class StampOffset {
public:
  /// \param max_offset_s  greatest offset to either side; 0: never any
  /// \throws std::invalid_argument if it is negative or beyond 1 s
  explicit StampOffset(double max_offset_s);

  /// What the wheels say, in the order of the stamps.
  void addWheels(const StampedPose2& odom_from_base);
  /// Where the robot is by its scans, in the order of the stamps.
  void addScan(const StampedPose2& odom_from_base);

  /// To be added to a scan's stamp to have the wheels'. 0 until enough turns have shown one beyond
  /// 0.02 s.
  std::int64_t offset_ns() const { return offset_ns_; }

private:
  struct Turn {
    StampedPose2 from;
    StampedPose2 to;
  };

  void compare(const Turn& turn);
  void decide();

  std::int64_t max_offset_ns_;
  std::deque<StampedPose2> wheels_;    ///< as many as the turns that wait need
  std::deque<Turn> waiting_;           ///< for wheels after them
  std::optional<StampedPose2> start_;  ///< of the turn that goes on
  std::vector<double> errors_rad_;     ///< by offset
  std::size_t turn_count_ = 0;
  std::int64_t offset_ns_ = 0;
};

}  // namespace ram_slam
