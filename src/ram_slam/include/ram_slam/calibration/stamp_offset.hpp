// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// Settings of StampOffset.
struct StampOffsetParameters {
  double step_s = 0.02;     ///< between the offsets that are compared; smaller ones are taken for 0
  double turn_rad = 0.1;    ///< a turn has at least this angle,
  double max_turn_s = 1.0;  ///< within this time
  double max_error_rad = 0.1;  ///< of a turn; more is slip, not a matter of stamps
  int min_turns = 30;          ///< before an offset is used
  double min_gain = 0.1;    ///< share of the error without an offset that the best one takes away
  int max_readings = 5000;  ///< of wheels that are kept while scans lag behind

  static const ram_parameters::ParameterTable<StampOffsetParameters>& table();
};

/// Learns while driving by how much the stamps of the wheels' odometry and those of the scans
/// differ: drivers stamp when they read, not when the sensor measured, and 0.1 s at 1 rad/s is 6
/// degrees that look like slip.
///
/// Both measure how far the robot turned between the same two instants; of a row of offsets the one
/// counts at which the sum of absolute differences over all turns so far is the least.
class StampOffset {
public:
  /// \param max_offset_s  greatest offset to either side; 0: never any
  /// \throws std::invalid_argument if it is negative or beyond 1 s
  explicit StampOffset(double max_offset_s, const StampOffsetParameters& parameters = {});

  /// Where the robot is by its wheels, in the order of the stamps.
  void addWheels(const StampedPose2& odom_from_base);
  /// Where the robot is by its scans, in the order of the stamps.
  void addScan(const StampedPose2& odom_from_base);

  /// To be added to a scan's stamp to have the wheels'. 0 until enough turns have shown one of
  /// at least `step_s`.
  std::int64_t offset_ns() const { return offset_ns_; }

private:
  struct Turn {
    StampedPose2 from;
    StampedPose2 to;
  };

  void compare(const Turn& turn);
  void decide();

  StampOffsetParameters parameters_;
  std::int64_t step_ns_;
  std::int64_t max_turn_ns_;
  std::int64_t max_offset_ns_;
  std::deque<StampedPose2> wheels_;    ///< as many as the turns that wait need
  std::deque<Turn> waiting_;           ///< for wheels after them
  std::optional<StampedPose2> start_;  ///< of the current turn
  std::vector<double> errors_rad_;     ///< by offset
  std::size_t turn_count_ = 0;
  std::int64_t offset_ns_ = 0;
};

}  // namespace ram_slam
