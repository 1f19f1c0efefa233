// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/parameters.hpp"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ramscout_feature_detector {
namespace {

FeatureDetectorParameters read(const std::string& yaml) {
  ram_parameters::ParameterReader reader(YAML::Load(yaml), "test");
  return readFeatureDetectorParameters(reader);
}

TEST(Parameters, DefaultsAreValidAndGiveNoWarning) {
  EXPECT_THAT(read("").warnings(), testing::IsEmpty());
}

TEST(Parameters, ShippedFileHoldsTheDefaults) {
  ram_parameters::ParameterReader reader(ram_parameters::readYamlFile(CONFIG_FILE), CONFIG_FILE);
  const FeatureDetectorParameters shipped = readFeatureDetectorParameters(reader);
  const auto rows = FeatureDetectorParameters::table().rows(shipped);
  const auto defaults = FeatureDetectorParameters::table().rows();
  ASSERT_EQ(rows.size(), defaults.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    EXPECT_EQ(rows[i].value, defaults[i].value) << rows[i].key;
}

TEST(Parameters, PresetsOfLidarsAreAccepted) {
  for (const char* name :
       {"depth_camera", "rplidar", "sick_lms", "sick_lms_180", "urg_04lx", "utm_30lx"}) {
    const std::string path = std::string(PRESET_FOLDER) + "/" + name + ".yaml";
    ram_parameters::ParameterReader reader(ram_parameters::readYamlFile(path)["feature_detector"],
                                           path);
    EXPECT_NO_THROW(readFeatureDetectorParameters(reader)) << path;
  }
}

class Refused : public testing::TestWithParam<const char*> {};

TEST_P(Refused, IsRefused) {
  EXPECT_THROW(read(GetParam()), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Values,
                         Refused,
                         testing::Values("ppm: 0",
                                         "ppm: -1",
                                         "ppm: 1000000",
                                         "ppm: one hundred",
                                         "ppm: '100'",
                                         "kernel_radius: 0",
                                         "kernel_radius: 10000",
                                         "kernel_radius: 30.5",
                                         "scale_levels: 0",
                                         "scale_levels: 9",
                                         "laser_range_sigma: 0",
                                         "laser_range_sigma: .nan",
                                         "laser_angular_sigma: -0.1",
                                         "distance_threshold: 0",
                                         "occlude_limit: -0.3",
                                         "feature_distance: 0",
                                         "max_features: 0",
                                         "covariance_limit: 0",
                                         "feature_threshold: 1.5",
                                         "occlude_limit: 1.0",
                                         "extrapolation_distance: 0.2",
                                         "base_frame: /base_link",
                                         "two_lines: {leg_lengths_m: []}",
                                         "two_lines: {leg_lengths_m: [0.4, 0.2]}",
                                         "two_lines: {line: {refinements: -1}}",
                                         "segmentation: {max_bridged_beams: -1}",
                                         "max_lasers: 0",
                                         "ocludelimit: 0.3"));

TEST(Parameters, AnIntegerIsADouble) {
  EXPECT_EQ(read("occlude_limit: 0.5\nppm: 200").ppm, 200.0);
}

TEST(Parameters, WarnsOfWhatIsAllowedButHardlyMeant) {
  EXPECT_THAT(read("ppm: 20").warnings(),
              testing::Contains(testing::HasSubstr("pixels per metre")));
  EXPECT_THAT(read("kernel_radius: 15\nlaser_angular_sigma: 0.01").warnings(),
              testing::Contains(testing::HasSubstr("kernel_radius")));
  EXPECT_THAT(read("scale_levels: 5").warnings(),
              testing::Contains(testing::HasSubstr("scale_levels")));
}

TEST(Parameters, EveryAdvisedRangeWarnsOutside) {
  for (const char* yaml :
       {"ppm: 250", "kernel_radius: 101", "scale_levels: 4", "distance_threshold: 0.2",
        "occlude_limit: 0.2", "extrapolation_distance: 0.9", "max_features: 4",
        "feature_distance: 0.1",
        "{relative_threshold: true, "
        "feature_threshold: 0.5}"}) {
    EXPECT_THAT(read(yaml).warnings(),
                testing::Contains(testing::HasSubstr("outside the range that is known to work")))
        << yaml;
  }
  EXPECT_THAT(read("feature_threshold: 0.5").warnings(), testing::IsEmpty());
}

TEST(Parameters, CornerModelIsThatOfTheParameters) {
  const FeatureDetectorParameters parameters = read("{corner_threshold: 0.2, ppm: 80}");
  const CornerModel model = parameters.cornerModel();
  EXPECT_EQ(model.corner_threshold, 0.2);
  EXPECT_EQ(model.range_sigma_m, parameters.laser_range_sigma);
  EXPECT_EQ(&model.tuning, &parameters.two_lines);
}

}  // namespace
}  // namespace ramscout_feature_detector
