// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/fast_slam_node_parameters.hpp"

#include <stdexcept>

namespace ram_slam {

using ram_parameters::aboveUpTo;
using ram_parameters::atLeast;
using ram_parameters::positive;
using ram_parameters::within;

const ram_parameters::ParameterTable<Frames>& Frames::table() {
  static const auto table =
      ram_parameters::ParameterTable<Frames>()
          .add("map_frame", &Frames::map, "Frame of the pose and the map.")
          .add("odom_frame", &Frames::odom,
               "Parent of the base in tf: map_frame -> odom_frame is published.")
          .rule(&Frames::odom, "another frame than map_frame",
                [](const Frames& frames) { return frames.odom != frames.map; })
          .add("base_frame", &Frames::base,
               "The robot's base; features must be given in this frame.")
          .rule(&Frames::base, "another frame than map_frame and odom_frame",
                [](const Frames& frames) {
                  return frames.base != frames.odom && frames.base != frames.map;
                });
  return table;
}

const ram_parameters::ParameterTable<MapToOdomParameters>& MapToOdomParameters::table() {
  using P = MapToOdomParameters;
  static const auto table =
      ram_parameters::ParameterTable<P>()
          .add("period_s", &P::period_s, "s", within(0.001, 10.0),
               "Longest time between two transforms map_frame -> odom_frame.")
          .add("tick_s", &P::tick_s, "s", within(0.001, 1.0),
               "How often is checked whether the transform is due.")
          .add("maximum_speed_mps", &P::maximum_speed_mps, "m/s", positive(),
               "A faster motion of odom_frame -> base_frame is a jump of the odometry's origin.");
  return table;
}

const ram_parameters::ParameterTable<WaitingParameters>& WaitingParameters::table() {
  using P = WaitingParameters;
  static const auto table =
      ram_parameters::ParameterTable<P>()
          .add("queue_size", &P::queue_size, "", within(1, 100000),
               "Lists of features that wait at most, and scans that are kept for them.")
          .add("motion_s", &P::motion_s, "s", within(0.0, 60.0),
               "How long a list waits for the motion up to it.")
          .add("interrupted_s", &P::interrupted_s, "s", within(0.0, 60.0),
               "The same while the odometry is known to be interrupted.")
          .add("first_retry_s", &P::first_retry_s, "s", within(0.0001, 10.0),
               "Pause before the motion is requested again; each pause is twice the one before ...")
          .add("longest_retry_s", &P::longest_retry_s, "s", within(0.0001, 10.0), "... up to this.")
          .add("service_s", &P::service_s, "s", within(0.0, 60.0),
               "How long a service call or an initial pose waits for the estimator.");
  return table;
}

const ram_parameters::ParameterTable<LandmarkMarkerParameters>& LandmarkMarkerParameters::table() {
  using P = LandmarkMarkerParameters;
  static const auto table =
      ram_parameters::ParameterTable<P>()
          .add("ellipse_sigmas", &P::ellipse_sigmas, "", positive(),
               "Standard deviations that the ellipse of a landmark shows.")
          .add("least_diameter_m", &P::least_diameter_m, "m", positive(),
               "Smaller ellipses could not be seen.")
          .add("height_m", &P::height_m, "m", positive(), "Height of an ellipse.");
  return table;
}

const ram_parameters::ParameterTable<FastSlamNodeParameters>& FastSlamNodeParameters::table() {
  using P = FastSlamNodeParameters;
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
          .add("max_published_poses", &P::max_published_poses, "", atLeast(100),
               "Most poses in a message on trajectory; of more, the older ones are thinned out.")
          .add("initial_map", &P::initial_map,
               "Saved map (folder, or a file in it, of the service save_map of world_map) to begin "
               "with: its landmarks are the map and the robot starts lost in it; empty: an empty "
               "map, the robot at its origin. (docs/maps.md)")
          .add("localise_only", &P::localise_only,
               "Whether only the pose is estimated: the initial map stays as it is.")
          .rule(&P::localise_only, "false without initial_map",
                [](const P& p) { return !p.localise_only || !p.initial_map.empty(); })
          .add("checkpoint_file", &P::checkpoint_file,
               "File from which the node continues after it was killed: its map, its path, and the "
               "robot about where it was. It takes precedence over initial_map, and is removed "
               "when the node is reset or the launch ends (Ctrl-C). A relative path begins in the "
               "node's "
               "working directory, ~/.ros under roslaunch; empty: none. (docs/fast_slam.md)")
          .add("checkpoint_period", &P::checkpoint_period, "s", aboveUpTo(0.0, 3600.0),
               "Least time between two checkpoints.")
          .include(&P::readings, EstimatorStageParameters::table())
          .expert("Node: details")
          .add("initial_sigma_m", &P::initial_sigma_m, "m", positive(),
               "Least standard deviation per axis of an initial pose: a click is no more exact.")
          .add("initial_sigma_rad", &P::initial_sigma_rad, "rad", positive(), "Of its yaw.")
          .include(&P::logged_correction,
                   motionGateTable("A smoothed trajectory that moves the pose by so much is "
                                   "logged: consumers see it jump."),
                   "logged_correction_")
          .section("waiting", &P::waiting, WaitingParameters::table())
          .section("map_to_odom", &P::map_to_odom, MapToOdomParameters::table())
          .section("markers", &P::markers, LandmarkMarkerParameters::table());
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
