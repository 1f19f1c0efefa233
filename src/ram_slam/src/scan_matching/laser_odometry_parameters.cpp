// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/laser_odometry_parameters.hpp"

namespace ram_slam {

using namespace ram_parameters;

const ParameterTable<SlipParameters>& SlipParameters::table() {
  using P = SlipParameters;
  static const auto table =
      ParameterTable<P>()
          .add("deviations", &P::deviations, "", positive(),
               "The wheels slip if scans contradict them by more standard deviations than this.")
          .add("prior_variance_factor", &P::prior_variance_factor, "", atLeast(1.0),
               "By which the variance of the wheels' motion grows when they slip.")
          .add("probability", &P::probability, "", between(0.0, 1.0),
               "That the wheels slip between two scans. Scans overrule the wheels only where both "
               "together are likelier than the wheels alone.")
          .add("continued_probability", &P::continued_probability, "", between(0.0, 1.0),
               "That wheels which slipped go on slipping up to the next scan.")
          .add("contradiction", &P::contradiction, "", between(0.0, 1.0),
               "A scan of which a larger share of the readings contradicts the key scans, wherever "
               "it is placed, is not matched with by later scans, ...")
          .add("contradicting_scans", &P::contradicting_scans, "", atLeast(1),
               "... unless so many in a row contradict: then the key scans are forgotten, as when "
               "the robot was carried away.")
          .include(&P::jump,
                   motionGateTable("Beyond this, and beyond the interval times the two greatest "
                                   "speeds, a motion that scans show and wheels do not is a jump: "
                                   "the wheels carry the pose on."),
                   "jump_")
          .add("max_speed_mps", &P::max_speed_mps, "m/s", positive(),
               "Greatest speed of the robot, for jumps.")
          .add("max_turn_speed_radps", &P::max_turn_speed_radps, "rad/s", positive(),
               "Greatest speed of turning, for jumps.")
          .include(&P::standing, motionGateTable("Wheels that move no farther stand still."),
                   "standing_")
          .include(&P::stuck,
                   motionGateTable("Wheels that stand still are stuck if the robot moves farther "
                                   "than this meanwhile."),
                   "stuck_");
  return table;
}

const ParameterTable<ConstantSpeedParameters>& ConstantSpeedParameters::table() {
  using P = ConstantSpeedParameters;
  static const auto table =
      ParameterTable<P>()
          .add("rest_deviation_m", &P::rest_deviation_m, "m", positive(),
               "Standard deviation of the position after a very short interval.")
          .add("rest_deviation_rad", &P::rest_deviation_rad, "rad", positive(),
               "The same of the yaw.")
          .add("max_interval_ratio", &P::max_interval_ratio, "", atLeast(0.0),
               "The last motion is continued over at most so many of its intervals.");
  return table;
}

namespace {

using P = LaserOdometryParameters;

/// What users may have to change; in the shipped file.
ParameterTable<P> userRows() {
  return ParameterTable<P>()
      .add("odom_frame", &P::odom_frame, "Frame of the refined odometry.")
      .add("base_frame", &P::base_frame, "Frame of the robot's base.")
      .rule(&P::base_frame, "another frame than odom_frame",
            [](const P& p) { return p.base_frame != p.odom_frame; })
      .add("use_wheels", &P::use_wheels, "False: do not wait for wheel odometry.")
      .include(&P::surfaces, SurfaceParameters::table())
      .include(&P::matcher, ScanMatcherParameters::table())
      .heading("Key scans")
      .add("key_scan_distance_m", &P::key_scan_distance_m, "m", positive(),
           "A new key scan after so much motion.")
      .add("key_scan_angle_rad", &P::key_scan_angle_rad, "rad", positive(),
           "A new key scan after so much turning.")
      .add("key_scan_inlier_ratio", &P::key_scan_inlier_ratio, "", within(0.0, 1.0),
           "A new key scan when a smaller share of a scan than this meets the last ones.")
      .add("key_scan_count", &P::key_scan_count, "", atLeast(1), "How many are kept.")
      .add("reference_count", &P::reference_count, "", anyNumber(),
           "How many of them a scan is aligned with.")
      .rule(&P::reference_count, "in [1, key_scan_count]",
            [](const P& p) {
              return p.reference_count >= 1 && p.reference_count <= p.key_scan_count;
            })
      .add("max_reference_distance_m", &P::max_reference_distance_m, "m", aboveUpTo(0.0, 1000.0),
           "And not farther than this from the newest one: beyond a jump of the odometry nothing "
           "overlaps.")
      .heading("Standard deviation of the wheels' motion between two scans")
      .add("wheel_rest_deviation_m", &P::wheel_rest_deviation_m, "m", positive(),
           "Of the distance, at rest.")
      .add("wheel_rest_deviation_rad", &P::wheel_rest_deviation_rad, "rad", positive(),
           "Of the yaw, at rest.")
      .add("wheel_distance_deviation_m_per_m", &P::wheel_distance_deviation_m_per_m, "m/m",
           positive(), "Growth with the distance.")
      .add("wheel_yaw_deviation_rad_per_m", &P::wheel_yaw_deviation_rad_per_m, "rad/m", positive(),
           "Growth of the yaw's with the distance.")
      .add("wheel_yaw_deviation_rad_per_rad", &P::wheel_yaw_deviation_rad_per_rad, "rad/rad",
           positive(), "Growth of the yaw's with the turn.")
      .heading("Stamps of wheels and scans")
      .add("max_stamp_offset_s", &P::max_stamp_offset_s, "s", within(0.0, 1.0),
           "Greatest offset between the stamps of wheels and scans that is learned while "
           "turning; 0: none.")
      .heading("Change of speed of a robot without wheel odometry")
      .add("acceleration_deviation_m_per_s2", &P::acceleration_deviation_m_per_s2, "m/s^2",
           positive(), "Standard deviation of its acceleration.")
      .add("yaw_acceleration_deviation_rad_per_s2", &P::yaw_acceleration_deviation_rad_per_s2,
           "rad/s^2", positive(), "The same of the turn.")
      .heading("Recovery")
      .add("lost_inlier_ratio", &P::lost_inlier_ratio, "", within(0.0, 1.0),
           "A match below this share of paired points is searched for.")
      .add("search_distance_m", &P::search_distance_m, "m", positive(),
           "Greatest distance from the prediction that is searched.")
      .add("search_angle_rad", &P::search_angle_rad, "rad", positive(),
           "Greatest turn from the prediction that is searched.");
}

}  // namespace

const ParameterTable<LaserOdometryParameters>& LaserOdometryParameters::table() {
  static const auto table =
      userRows()
          .expert("Gaps between scans")
          .add("between_scans_s", &P::between_scans_s, "s", positive(),
               "Where scans are farther apart than twice this, the poses of the wheels are "
               "published in between, so far from each other.")
          .expert("When scans overrule the wheels")
          .section("slip", &P::slip, SlipParameters::table())
          .expert("How likely a scan is at a pose")
          .section("pose_likelihood", &P::pose_likelihood, PoseLikelihoodParameters::table())
          .expert("Search for a lost pose")
          .section("pose_search", &P::pose_search, PoseSearchParameters::table())
          .expert("Motion without wheel odometry")
          .section("constant_speed", &P::constant_speed, ConstantSpeedParameters::table())
          .expert("Systematic errors of the wheels that are learned")
          .section("wheel_bias", &P::wheel_bias, WheelBiasParameters::table())
          .expert("Scatter of the wheels that is learned")
          .section("wheel_scatter", &P::wheel_scatter, WheelScatterParameters::table())
          .expert("Learning the errors of the lidar")
          .section("lidar_calibration", &P::lidar_calibration, LidarCalibrationParameters::table())
          .expert("Learning the offset of the stamps")
          .section("stamp_offset", &P::stamp_offset, StampOffsetParameters::table());
  return table;
}

void LaserOdometryParameters::validate() const {
  table().check(*this);
}

LaserOdometryParameters readLaserOdometryParameters(ParameterReader& reader) {
  return LaserOdometryParameters::table().readAll(reader);
}

}  // namespace ram_slam
