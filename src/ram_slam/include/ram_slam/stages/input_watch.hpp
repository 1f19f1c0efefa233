// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "ram_slam/stages/causes.hpp"

namespace ram_slam {

/// What comes on one input: rate, age, publisher, stamps against the clock, and what is refused.
/// Times `now_s` are wall time.
class InputWatch {
public:
  /// A message came. \param stamp_age_s  clock minus its stamp
  void arrived(const std::string& publisher, double stamp_age_s, double now_s);
  /// The newest message was not used.
  void refused(const std::string& reason, double now_s);

  /// Fills in what this knows.
  void report(double now_s, InputFacts& facts) const;
  /// Messages per second of wall time, over the newest two seconds.
  double rate_hz(double now_s) const;

private:
  static constexpr double kWindow_s = 2.0;
  static constexpr double kRefusedFor_s = 0.5;  ///< single messages are counted as drops

  struct Arrival {
    double now_s;
    double stamp_age_s;
  };
  std::deque<Arrival> arrivals_;  ///< of the window, and the two newest
  std::string newest_publisher_;
  std::uint64_t arrival_count_ = 0;
  std::uint64_t refused_count_ = 0;  ///< arrival_count_ at the newest refusal
  double refused_since_s_ = 0.0;     ///< since when each one was refused
  std::string refusal_;
};

/// How long it takes from a message that comes to what is published with its stamp.
class LatencyWatch {
public:
  void arrived(std::int64_t stamp_ns, double now_s);
  void answered(std::int64_t stamp_ns, double now_s);
  /// Of the newest thousand answers [s]. \param share  0.5: the median \return 0 without answers
  double percentile_s(double share) const;

private:
  static constexpr std::size_t kMostWaiting = 1000;
  static constexpr std::size_t kMostLatencies = 1000;

  struct Waiting {
    std::int64_t stamp_ns;
    double now_s;
  };
  std::deque<Waiting> waiting_;
  std::deque<double> latencies_s_;
};

}  // namespace ram_slam
