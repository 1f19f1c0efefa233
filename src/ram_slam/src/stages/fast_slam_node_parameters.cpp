// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/fast_slam_node_parameters.hpp"

#include <stdexcept>

namespace ram_slam {

const ram_parameters::ParameterTable<Frames>& Frames::table() {
  static const auto table =
      ram_parameters::ParameterTable<Frames>()
          .add("map_frame", &Frames::map, "Frame of the pose and the map.")
          .add("odom_frame", &Frames::odom,
               "Parent of the base in tf: map_frame -> odom_frame is published.")
          .add("base_frame", &Frames::base,
               "The robot's base; features must be given in this frame.");
  return table;
}

const ram_parameters::ParameterTable<FastSlamNodeParameters>& FastSlamNodeParameters::table() {
  using P = FastSlamNodeParameters;
  using ram_parameters::aboveUpTo;
  using ram_parameters::atLeast;
  static const auto table =
      ram_parameters::ParameterTable<P>()
          .heading("How the node is wired")
          .add("estimator", &P::estimator,
               "Which estimator runs: fast_slam, or one that was registered (docs/extending.md).")
          .include(&P::frames, Frames::table())
          .add("feature_topics", &P::feature_topics, "Topics of detectors, at least one.")
          .rule(&P::feature_topics, "a list of at least one topic",
                [](const P& p) { return !p.feature_topics.empty(); })
          .add("use_scan", &P::use_scan,
               "Whether `scan` is subscribed to, so that landmarks are removed where the lidar "
               "sees empty space.")
          .add("output_period", &P::output_period, "s", atLeast(0.0),
               "Least time between two outputs of landmarks and trajectory.")
          .add("initial_map", &P::initial_map,
               "World map file (*.world, written by the service save_map of world_map) to begin "
               "with: its landmarks are the map and the robot starts lost in it; empty: an empty "
               "map, the robot at its origin.")
          .add("checkpoint_file", &P::checkpoint_file,
               "File from which the node continues after it was killed: its map, its path, and the "
               "robot about where it was. It takes precedence over initial_map, and is removed "
               "when the node is reset or ends in order. A relative path begins in the node's "
               "working directory, ~/.ros under roslaunch; empty: none. (docs/fast_slam.md)")
          .add("checkpoint_period", &P::checkpoint_period, "s", aboveUpTo(0.0, 3600.0),
               "Least time between two checkpoints.")
          .include(&P::readings, EstimatorStageParameters::table());
  return table;
}

void FastSlamNodeParameters::validate() const {
  try {
    table().check(*this);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string("node/") + error.what());
  }
}

FastSlamNodeParameters readFastSlamNodeParameters(ram_parameters::ParameterReader& all) {
  ram_parameters::ParameterReader reader = all.section("node");
  return FastSlamNodeParameters::table().readAll(reader);
}

}  // namespace ram_slam
