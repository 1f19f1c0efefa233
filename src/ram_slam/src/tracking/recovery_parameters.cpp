// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/recovery_parameters.hpp"

namespace ram_slam {

const ram_parameters::ParameterTable<TrackingParameters>& TrackingParameters::table() {
  using P = TrackingParameters;
  using namespace ram_parameters;
  static const auto table =
      ParameterTable<P>()
          .add("copy_period_s", &P::copy_period_s, "s", positive(),
               "Time between two copies of the filter that are put aside.")
          .add("copy_age_s", &P::copy_age_s, "s", positive(),
               "A copy this old is from before what made the robot lost: the map goes back to it.")
          .add("probation_m", &P::probation_m, "m", positive(),
               "Driving for which the map from before is kept after the pose was newly set.")
          .add("known_motion_sigma_m", &P::known_motion_sigma_m, "m", positive(),
               "A motion less certain than this is no evidence about whether two views belong "
               "together ...")
          .add("known_motion_sigma_rad", &P::known_motion_sigma_rad, "rad", positive(),
               "... and so is one whose turn is less certain than this.")
          .add("resumed_sigma_m", &P::resumed_sigma_m, "m", positive(),
               "Standard deviation per axis of the pose after a slip or a disturbance.")
          .add("resumed_sigma_rad", &P::resumed_sigma_rad, "rad", positive(), "Of its yaw.")
          .add("restored_sigma_m", &P::restored_sigma_m, "m", positive(),
               "Standard deviation per axis of the pose of a checkpoint relative to its landmarks.")
          .add("restored_sigma_rad", &P::restored_sigma_rad, "rad", positive(), "Of its yaw.")
          .add("lost_sigma_m", &P::lost_sigma_m, "m", positive(),
               "Standard deviation per axis of the published pose while the robot is lost.")
          .add("lost_sigma_rad", &P::lost_sigma_rad, "rad", positive(), "Of its yaw.")
          .include(&P::checkpoint_step,
                   motionGateTable("A checkpoint keeps a pose of the path after so much motion."),
                   "checkpoint_step_");
  return table;
}

const ram_parameters::ParameterTable<OdometryTrustParameters>& OdometryTrustParameters::table() {
  using P = OdometryTrustParameters;
  using namespace ram_parameters;
  static const auto table =
      ParameterTable<P>()
          .add("contradicted_m", &P::contradicted_m, "m", positive(),
               "A robot that its map contradicted is where odometry leads if it found no other "
               "place within this way ...")
          .add("walls_agree_s", &P::walls_agree_s, "s", atLeast(0.0),
               "... or if the walls agree there for so long.")
          .add("carried_m", &P::carried_m, "m", positive(),
               "A robot whose views showed two places is where odometry leads if it found no other "
               "place within this way and no view of the map denies it.")
          .add("sigma_m", &P::sigma_m, "m", positive(),
               "Standard deviation per axis of the pose then.")
          .add("sigma_rad", &P::sigma_rad, "rad", positive(), "Of its yaw.");
  return table;
}

const ram_parameters::ParameterTable<RecoveryParameters>& RecoveryParameters::table() {
  using P = RecoveryParameters;
  using namespace ram_parameters;
  static const auto table =
      ParameterTable<P>()
          .add("enabled", &P::enabled,
               "Whether the robot can take itself for lost and find its place again. False: the "
               "filter alone.")
          .include(&P::monitor, PoseMonitorParameters::table())
          .include(&P::relocaliser, RelocaliserParameters::table())
          .expert("States of tracking")
          .section("tracking", &P::tracking, TrackingParameters::table())
          .expert("Odometry that is trusted again")
          .section("odometry_trust", &P::odometry_trust, OdometryTrustParameters::table())
          .section("disturbance", &P::disturbance, DisturbanceParameters::table())
          .expert("Views of the map")
          .section("map_views", &P::map_views, MapViewsParameters::table());
  return table;
}

RecoveryParameters readRecoveryParameters(ram_parameters::ParameterReader& all) {
  ram_parameters::ParameterReader reader = all.section("relocalisation");
  return RecoveryParameters::table().readAll(reader);
}

}  // namespace ram_slam
