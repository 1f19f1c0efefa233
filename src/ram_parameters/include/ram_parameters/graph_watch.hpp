// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace ram_parameters {

/// What a node can see of the graph around it.
struct GraphSight {
  bool master_answers = true;
  bool is_registered = true;      ///< the master knows this node; of no meaning without its answer
  bool waits_for_clock = false;   ///< use_sim_time is set and no clock has come
  bool has_clock_source = false;  ///< a node publishes /clock
};

/// Decides what a node must report about the graph: a master that is gone or has forgotten the
/// node, a clock that does not come.
class GraphWatch {
public:
  /// \param interval_s  wall time since the call before
  void see(const GraphSight& sight, double interval_s);

  /// What is wrong now and what to do; empty if nothing is.
  const std::string& problem() const { return problem_; }
  /// Whether the problem has lasted for longer than other nodes need to start.
  bool isLasting() const { return problem_s_ >= kStarting_s; }
  /// The master was started again and does not know this node: it can only be started again, too.
  bool mustEnd() const { return forgotten_count_ >= kSightsBeforeEnd; }

private:
  static constexpr double kClockPatience_s = 2.0;
  static constexpr double kPausedPatience_s = 10.0;  ///< recordings are played after a pause
  static constexpr double kStarting_s = 5.0;
  static constexpr int kSightsBeforeEnd = 2;  ///< the first may fall between two registrations

  std::string problem_;
  double problem_s_ = 0.0;  ///< since when there is one
  double without_clock_s_ = 0.0;
  int forgotten_count_ = 0;
};

}  // namespace ram_parameters
