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
  const FeatureDetectorParameters defaults;
  EXPECT_EQ(shipped.ppm, defaults.ppm);
  EXPECT_EQ(shipped.kernel_radius, defaults.kernel_radius);
  EXPECT_EQ(shipped.scale_levels, defaults.scale_levels);
  EXPECT_EQ(shipped.laser_range_sigma, defaults.laser_range_sigma);
  EXPECT_EQ(shipped.laser_angular_sigma, defaults.laser_angular_sigma);
  EXPECT_EQ(shipped.distance_threshold, defaults.distance_threshold);
  EXPECT_EQ(shipped.occlude_limit, defaults.occlude_limit);
  EXPECT_EQ(shipped.extrapolation_distance, defaults.extrapolation_distance);
  EXPECT_EQ(shipped.max_features, defaults.max_features);
  EXPECT_EQ(shipped.relative_threshold, defaults.relative_threshold);
  EXPECT_EQ(shipped.feature_threshold, defaults.feature_threshold);
  EXPECT_EQ(shipped.feature_distance, defaults.feature_distance);
  EXPECT_EQ(shipped.covariance_limit, defaults.covariance_limit);
  EXPECT_EQ(shipped.corner_threshold, defaults.corner_threshold);
  EXPECT_EQ(shipped.significance_min, defaults.significance_min);
  EXPECT_EQ(shipped.position_sigma_limit, defaults.position_sigma_limit);
  EXPECT_EQ(shipped.base_frame, defaults.base_frame);
}

TEST(Parameters, PresetsOfSensorsAreAccepted) {
  for (const char* name : {"hokuyo_urg04lx", "hokuyo_utm30lx", "rplidar_a1", "sick_lms"}) {
    const std::string path = std::string(PRESET_FOLDER) + "/" + name + ".yaml";
    ram_parameters::ParameterReader reader(ram_parameters::readYamlFile(path), path);
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

}  // namespace
}  // namespace ramscout_feature_detector
