// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/graph_watch.hpp"

namespace ram_parameters {

void GraphWatch::see(const GraphSight& sight, double interval_s) {
  without_clock_s_ = sight.waits_for_clock ? without_clock_s_ + interval_s : 0.0;
  forgotten_count_ = sight.master_answers && !sight.is_registered ? forgotten_count_ + 1 : 0;
  problem_.clear();
  if (!sight.master_answers) {
    problem_ =
        "the ROS master does not answer: this node continues with the connections it has, but no "
        "other node finds it; start roscore again";
  } else if (mustEnd()) {
    problem_ =
        "the ROS master was started again and does not know this node: it ends, and must be "
        "started again (roslaunch does so with respawn:=true)";
  } else if (sight.has_clock_source && without_clock_s_ >= kPausedPatience_s) {
    problem_ =
        "use_sim_time is set and /clock has a publisher, but no time comes: the simulation or "
        "rosbag play is paused; resume it";
  } else if (!sight.has_clock_source && without_clock_s_ >= kClockPatience_s) {
    problem_ =
        "use_sim_time is set, but nothing comes on /clock: start the simulator or rosbag play "
        "--clock, or set use_sim_time to false";
  }
  problem_s_ = problem_.empty() ? 0.0 : problem_s_ + interval_s;
}

}  // namespace ram_parameters
