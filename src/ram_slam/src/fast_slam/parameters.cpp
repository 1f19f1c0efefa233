// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/parameters.hpp"

#include <limits>

#include "ram_slam/fast_slam/read_filter_parameters.hpp"

namespace ram_slam {

using ram_parameters::above;
using ram_parameters::aboveUpTo;
using ram_parameters::anyNumber;
using ram_parameters::atLeast;
using ram_parameters::below;
using ram_parameters::between;
using ram_parameters::ParameterTable;
using ram_parameters::positive;
using ram_parameters::within;

const ParameterTable<AppearanceParameters>& AppearanceParameters::table() {
  using P = AppearanceParameters;
  static const auto table =
      ParameterTable<P>()
          .add("maximum_descriptors", &P::maximum_descriptors, "", within(0, 100),
               "Descriptors that are kept of a landmark.")
          .add("new_descriptor_below", &P::new_descriptor_below, "nat", anyNumber(),
               "A descriptor less alike than this to every one kept is kept, too.")
          .add("sighting_sigma_rad", &P::sighting_sigma_rad, "rad", atLeast(0.0),
               "Standard deviation of the robot's yaw when it sees a landmark's orientation.")
          .add("orientation_sigma_rad", &P::orientation_sigma_rad, "rad", atLeast(0.0),
               "Standard deviation of orientations beyond what detectors state.")
          .add("wrong_orientation_share", &P::wrong_orientation_share, "", between(0.0, 1.0),
               "Share of orientations that are plainly wrong.");
  return table;
}

const ParameterTable<ExistenceParameters>& ExistenceParameters::table() {
  using P = ExistenceParameters;
  static const auto table =
      ParameterTable<P>()
          .add("passed_log_odds", &P::passed_log_odds, "log-odds", below(0.0),
               "Evidence of a view that shows empty space where a landmark should be.")
          .add("overlooked_log_odds", &P::overlooked_log_odds, "log-odds", anyNumber(),
               "Landmarks that were confirmed once do not fall below this because a detector did "
               "not find them.")
          .add("sampled_particles", &P::sampled_particles, "", within(1, 1000),
               "Particles in whose maps is checked whether landmarks are missing.")
          .add("edge_margin_m", &P::edge_margin_m, "m", atLeast(0.0),
               "On both sides of a landmark the space must be empty so far to count as empty.");
  return table;
}

const ParameterTable<SharedErrorParameters>& SharedErrorParameters::table() {
  using P = SharedErrorParameters;
  static const auto table =
      ParameterTable<P>()
          .add("feature_distance_m", &P::feature_distance_m, "m", positive(),
               "Typical distance of features: turns their errors into errors of yaw.")
          .add("known_floors", &P::known_floors, "", atLeast(0.0),
               "Standard deviation on known ground, in units of pose_noise_floor.")
          .add("new_floors", &P::new_floors, "", atLeast(0.0),
               "The same after new_ground_m of new ground.")
          .add("new_ground_m", &P::new_ground_m, "m", positive(),
               "Length of new ground over which the variance grows linearly.")
          .add("known_within_m", &P::known_within_m, "m", positive(),
               "Ground nearer than this to a corrected trajectory is known.")
          .add("known_spacing_m", &P::known_spacing_m, "m", positive(),
               "Spacing of the places that are kept of a corrected trajectory.");
  return table;
}

const ParameterTable<MapSummaryParameters>& MapSummaryParameters::table() {
  using P = MapSummaryParameters;
  static const auto table = ParameterTable<P>()
                                .add("pair_distance_m", &P::pair_distance_m, "m", atLeast(0.0),
                                     "Covariances are stated between landmarks up to so far apart.")
                                .add("least_correlation", &P::least_correlation, "",
                                     within(0.0, 1.0), "And whose correlation exceeds this.");
  return table;
}

namespace {

using P = FastSlamParameters;

void addParticles(ParameterTable<P>& table) {
  table
      .add("particle_amount", &P::particle_amount, "", within(1, 100000),
           "Number of particles; at least 50 are advised.")
      .add(
          "feature_match_distance", &P::feature_match_distance, "m", positive(),
          "Only in mode fast_slam_1: a feature nearer than this to a landmark is that landmark; at "
          "least 0.1 is advised.");
}

void addCreation(ParameterTable<P>& table) {
  table
      .add("minimum_feature_separation", &P::minimum_feature_separation, "m", atLeast(0.0),
           "Nearer to a landmark than this no other one is created, unless both are seen at once; "
           "at least 0.3 is advised. (The spelling minimum_feature_seperation is accepted, too.)")
      .rule(&P::minimum_feature_separation, ">= feature_match_distance in mode fast_slam_1",
            [](const P& p) {
              return p.mode != FastSlamMode::kFastSlam1 ||
                     p.minimum_feature_separation >= p.feature_match_distance;
            })
      .alias("minimum_feature_seperation")
      .add("future_interpol", &P::future_interpol, "s", within(0.0, 10.0),
           "How long the published pose is valid: tf map -> odom is dated ahead by this.");
}

void addMode(ParameterTable<P>& table) {
  table
      .addChoice(
          "mode", &P::mode,
          {{"fast_slam_1", FastSlamMode::kFastSlam1}, {"fast_slam_2", FastSlamMode::kFastSlam2}},
          "fast_slam_2 (advised): particles are sampled with the features in view, "
          "association by covariance and classifier. fast_slam_1: particles are sampled from "
          "the motion model, association by the two distances above.")
      .add("seed", &P::seed, "", within(0, std::numeric_limits<int>::max()),
           "Of the random numbers. The same seed and input give the same output.");
}

void addPace(ParameterTable<P>& table) {
  table
      .add("update_distance", &P::update_distance, "m", atLeast(0.0),
           "The map is updated once per this distance driven; in between features only correct the "
           "pose. fast_slam_2 samples its particles then, which costs diversity, so more is not "
           "better.")
      .add("update_angle", &P::update_angle, "rad", atLeast(0.0), "Or once per this angle turned.");
}

void addGates(ParameterTable<P>& table) {
  table
      .add("association_gate", &P::association_gate, "", positive(),
           "Largest squared Mahalanobis distance of a match; 9.21 holds 99 % of the right ones.")
      .add("creation_gate", &P::creation_gate, "", anyNumber(),
           "A feature with a smaller squared Mahalanobis distance to a landmark is not new.")
      .rule(&P::creation_gate, ">= association_gate",
            [](const P& p) { return p.creation_gate >= p.association_gate; })
      .add("duplicate_gate", &P::duplicate_gate, "", atLeast(0.0),
           "Two features of one reading with a smaller squared Mahalanobis distance to each other "
           "may be one thing found twice; 0 if the detector never does that.")
      .add("ambiguity_margin", &P::ambiguity_margin, "nat", atLeast(0.0),
           "A match that is not more likely than its alternatives by this is uncertain: FastSLAM "
           "samples it, each particle takes one of the alternatives, as often as they are likely; "
           "filters with one hypothesis ignore the feature.");
}

void addJointDraws(ParameterTable<P>& table) {
  table.add("draw_jointly", &P::draw_jointly,
            "Whether uncertain pairings are sampled for all features of a reading together, each "
            "particle weighing as much as all its alternatives, as importance sampling asks for; "
            "otherwise one feature after the other, weighing as what was sampled. For sensors that "
            "confuse neighbouring landmarks in many readings (cameras that measure range); with a "
            "lidar's features it makes the covariance of the pose a little too small.");
}

void addNoise(ParameterTable<P>& table) {
  table
      .add("unknown_feature_density", &P::unknown_feature_density, "1/m^2", positive(),
           "Features that belong to no landmark, per area: the alternative to every match.")
      .add("feature_noise_floor", &P::feature_noise_floor, "m", atLeast(0.0),
           "Noise per axis added to what the detector states for each feature. More than a "
           "detector's scatter, since its errors hardly change from scan to scan.");
}

void addWeights(ParameterTable<P>& table) {
  table
      .add(
          "evidence_exponent", &P::evidence_exponent, "", aboveUpTo(0.0, 1.0),
          "Exponent of the particles' weights. Below 1 where the errors of successive readings are "
          "alike: repeated evidence counts for less.")
      .add("resample_threshold", &P::resample_threshold, "", within(0.0, 1.0),
           "Particles are resampled when the effective ones are fewer than this fraction.");
}

void addDrift(ParameterTable<P>& table) {
  table.add(
      "drift_inflation", &P::drift_inflation, "", atLeast(1.0),
      "Variance of the drift since the start over that of the motion model: more than 1 where "
      "successive errors of odometry are alike and add up to more than white noise does. "
      "Changes what is published, not the estimate.");
}

void addPoseNoise(ParameterTable<P>& table) {
  table.add(
      "pose_noise_floor", &P::pose_noise_floor, "m", atLeast(0.0),
      "Standard deviation per axis that the common errors of features leave in the published "
      "pose, and in its yaw at a distance of 5 m: half of it at the start and where a smoother "
      "was followed, growing to twice it over 50 m of new ground. Changes what is published, "
      "not the estimate.");
}

void addExistence(ParameterTable<P>& table) {
  table.heading("Existence of landmarks")
      .add("detection_probability", &P::detection_probability, "", between(0.0, 1.0),
           "Probability that a landmark in view is found in a reading.")
      .add("false_detection_probability", &P::false_detection_probability, "", positive(),
           "Probability that something is found where no landmark is.")
      .rule(&P::false_detection_probability, "in (0, detection_probability)",
            [](const P& p) { return p.false_detection_probability < p.detection_probability; })
      .add("confirm_log_odds", &P::confirm_log_odds, "log-odds", anyNumber(),
           "Landmarks more likely than this correct the pose.")
      .rule(&P::confirm_log_odds, "> delete_log_odds",
            [](const P& p) { return p.delete_log_odds < p.confirm_log_odds; })
      .add("delete_log_odds", &P::delete_log_odds, "log-odds", below(0.0),
           "Landmarks less likely than this are removed.")
      .add("maximum_log_odds", &P::maximum_log_odds, "log-odds", anyNumber(),
           "No landmark gets more certain than this.")
      .rule(&P::maximum_log_odds, ">= confirm_log_odds",
            [](const P& p) { return p.maximum_log_odds >= p.confirm_log_odds; });
}

void addPasses(ParameterTable<P>& table) {
  table.add("association_passes", &P::association_passes, "", within(1, 10),
            "How often features are associated, each time from the pose corrected before.");
}

void addHypotheses(ParameterTable<P>& table) {
  table.add(
      "maximum_hypotheses", &P::maximum_hypotheses, "", within(1, 100000),
      "About so many ways to pair the uncertain features are compared at once (draw_jointly).");
}

void addMemory(ParameterTable<P>& table) {
  table
      .add("quality_memory", &P::quality_memory, "", within(0.0, 1.0),
           "Weight of the past in the running means of quality, per list.")
      .include(&P::loaded_frame,
               motionGateTable("A corrected trajectory that is farther from the path in a loaded "
                               "map is not in its frame."),
               "loaded_frame_")
      .add("skipped_ids", &P::skipped_ids, "", within(0, 1000000),
           "Identifiers left out behind those of a map from a file: others may know landmarks that "
           "were created after it was written.")
      .section("path", &P::path, PathParameters::table())
      .section("appearance", &P::appearance, AppearanceParameters::table())
      .section("existence", &P::existence, ExistenceParameters::table())
      .section("shared_error", &P::shared_error, SharedErrorParameters::table())
      .section("summary", &P::summary, MapSummaryParameters::table());
}

}  // namespace

const ParameterTable<FastSlamParameters>& FastSlamParameters::table() {
  static const ParameterTable<P> table = [] {
    ParameterTable<P> rows;
    addParticles(rows);
    addCreation(rows);
    addMode(rows);
    addPace(rows);
    addGates(rows.heading("Association (fast_slam_2)"));
    addJointDraws(rows);
    addNoise(rows);
    addWeights(rows);
    addDrift(rows.heading("Covariance of the pose (fast_slam_2)"));
    addPoseNoise(rows);
    addExistence(rows);
    addPasses(rows.expert("Tuning of the filter"));
    addHypotheses(rows);
    rows.add("drift_yaw_arm_m", &P::drift_yaw_arm_m, "m", atLeast(0.0),
             "Distance at which yaw counts as much as position where drifts are compared.");
    addMemory(rows);
    return rows;
  }();
  return table;
}

const ParameterTable<FastSlamParameters>& FastSlamParameters::landmarkTable() {
  static const ParameterTable<P> table = [] {
    ParameterTable<P> rows;
    addCreation(rows);
    addPace(rows);
    addGates(rows.heading("Association"));
    addNoise(rows);
    addPoseNoise(rows.heading("Covariance of the pose"));
    addExistence(rows);
    addPasses(rows.expert("Tuning of the filter"));
    addMemory(rows);
    return rows;
  }();
  return table;
}

void FastSlamParameters::validate() const {
  table().check(*this);
}

FastSlamParameters readFastSlamParameters(ram_parameters::ParameterReader& reader) {
  return readFilterParameters<FastSlamParameters>(reader);
}

}  // namespace ram_slam
