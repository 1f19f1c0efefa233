// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/parameters.hpp"

#include <set>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "../parameter_text.hpp"

namespace ram_slam {
namespace {

FastSlamParameters read(const std::string& yaml) {
  return readText(readFastSlamParameters, yaml);
}

std::string refusalOf(const std::string& yaml) {
  return refusalOfText(readFastSlamParameters, yaml);
}

TEST(FastSlamParameters, AreTheDefaultsInTheShippedFile) {
  expectDefaultsIn("fast_slam.yaml", readFastSlamParameters);
}

TEST(FastSlamParameters, AreReadByTheirKeysThoseForExpertsInSections) {
  const FastSlamParameters p = read(
      "{particle_amount: 30, mode: fast_slam_1, seed: 7, draw_jointly: true, "
      "appearance: {maximum_descriptors: 4}, existence: {sampled_particles: 5}, "
      "shared_error: {new_ground_m: 20.0}, summary: {pair_distance_m: 2.0}}");
  EXPECT_EQ(p.particle_amount, 30);
  EXPECT_EQ(p.mode, FastSlamMode::kFastSlam1);
  EXPECT_EQ(p.seed, 7);
  EXPECT_TRUE(p.draw_jointly);
  EXPECT_EQ(p.appearance.maximum_descriptors, 4);
  EXPECT_EQ(p.existence.sampled_particles, 5);
  EXPECT_EQ(p.shared_error.new_ground_m, 20.0);
  EXPECT_EQ(p.summary.pair_distance_m, 2.0);
}

TEST(FastSlamParameters, AcceptTheOldSpellingOfTheSeparation) {
  EXPECT_EQ(read("{minimum_feature_seperation: 0.5}").minimum_feature_separation, 0.5);
  EXPECT_EQ(read("{minimum_feature_seperation: 0.5, minimum_feature_separation: 0.5}")
                .minimum_feature_separation,
            0.5);
  EXPECT_THAT(refusalOf("{minimum_feature_seperation: 0.5, minimum_feature_separation: 0.4}"),
              testing::AllOf(testing::HasSubstr("minimum_feature_seperation"),
                             testing::HasSubstr("contradict")));
}

TEST(FastSlamParameters, RefuseAModeThatDoesNotExist) {
  EXPECT_EQ(refusalOf("{mode: fast_slam_3}"),
            "mode must be fast_slam_1 or fast_slam_2, got 'fast_slam_3'");
}

TEST(FastSlamParameters, LeaveTheSectionsOfOthersAloneAndRefuseUnknownKeys) {
  EXPECT_EQ(refusalOf("{node: {anything: 1}, relocalisation: {anything: 1}}"), "");
  EXPECT_THAT(refusalOf("{particle_amuont: 5}"), testing::HasSubstr("particle_amount"));
}

TEST(FastSlamParameters, NameTheParameterThatIsOutOfBounds) {
  for (const char* yaml : {"particle_amount: 0",
                           "particle_amount: 100001",
                           "feature_match_distance: 0.0",
                           "minimum_feature_separation: -0.1",
                           "future_interpol: 10.1",
                           "seed: -1",
                           "association_gate: 0.0",
                           "creation_gate: 9.2",
                           "duplicate_gate: -1.0",
                           "ambiguity_margin: -1.0",
                           "unknown_feature_density: 0.0",
                           "feature_noise_floor: -0.1",
                           "evidence_exponent: 0.0",
                           "evidence_exponent: 1.1",
                           "resample_threshold: 1.1",
                           "drift_inflation: 0.9",
                           "pose_noise_floor: -0.1",
                           "detection_probability: 1.0",
                           "false_detection_probability: 0.5",
                           "delete_log_odds: 0.0",
                           "confirm_log_odds: -2.0",
                           "maximum_log_odds: 1.9",
                           "update_distance: -0.1",
                           "update_angle: -0.1"}) {
    const std::string key = std::string(yaml).substr(0, std::string(yaml).find(':'));
    EXPECT_THAT(refusalOf(std::string("{") + yaml + "}"), testing::HasSubstr(key + " must be"));
  }
}

TEST(FastSlamParameters, NeedASeparationOfAtLeastTheMatchDistanceInVersionOne) {
  const std::string distances = "feature_match_distance: 0.4, minimum_feature_separation: 0.3";
  EXPECT_EQ(refusalOf("{" + distances + "}"), "");
  EXPECT_THAT(refusalOf("{mode: fast_slam_1, " + distances + "}"),
              testing::HasSubstr("minimum_feature_separation must be"));
}

TEST(FastSlamParameters, HaveEachKeyOnce) {
  std::set<std::string> keys;
  for (const auto& row : FastSlamParameters::table().rows())
    EXPECT_TRUE(keys.insert(row.key).second) << row.key;
}

}  // namespace
}  // namespace ram_slam
