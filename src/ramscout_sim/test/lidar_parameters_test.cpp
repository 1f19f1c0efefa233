// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/lidar_parameters.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

namespace ramscout_sim {
namespace {

using ::testing::HasSubstr;

std::string refusal(const LidarParameters& parameters) {
  try {
    parameters.validate();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(LidarPreset, ShippedFilesStateTheSameValues) {
  for (const std::string name : {"utm_30lx", "urg_04lx", "sick_lms", "sick_lms_180", "rplidar"}) {
    const std::string path = std::string(CONFIG_FOLDER) + "/lidars/" + name + ".yaml";
    YAML::Node values = ram_parameters::readYamlFile(path)["simulator"]["lidar"];
    const std::string preset = name == "rplidar" ? "rplidar_a2" : name;
    values["preset"] = preset;
    ram_parameters::ParameterReader reader(values, path);
    const auto shipped = LidarParameters::table().rows(readLidarParameters(reader));
    const auto rows = LidarParameters::table().rows(lidarPreset(preset));
    ASSERT_EQ(shipped.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      EXPECT_EQ(shipped[i].value, rows[i].value) << name << ": " << rows[i].key;
  }
}

TEST(LidarPreset, EveryOneIsValidAndNamesItself) {
  for (const char* name : {"utm_30lx", "urg_04lx", "sick_lms", "sick_lms_180", "rplidar_a2"}) {
    const LidarParameters lidar = lidarPreset(name);
    EXPECT_EQ(lidar.preset, name);
    EXPECT_EQ(refusal(lidar), "accepted") << name;
  }
  EXPECT_THROW(lidarPreset("utm"), std::invalid_argument);
}

TEST(LidarPreset, HasTheAngularStepOfTheDataSheet) {
  constexpr double kDegree = M_PI / 180.0;
  EXPECT_NEAR(lidarPreset("utm_30lx").angleIncrement_rad(), 0.25 * kDegree, 1e-9);
  EXPECT_NEAR(lidarPreset("urg_04lx").angleIncrement_rad(), 2.0 * M_PI / 1024, 1e-12);
  EXPECT_NEAR(lidarPreset("sick_lms").angleIncrement_rad(), 0.5 * kDegree, 1e-12);
  EXPECT_NEAR(lidarPreset("sick_lms_180").angleIncrement_rad(), 1.0 * kDegree, 1e-12);
  EXPECT_NEAR(lidarPreset("rplidar_a2").angleIncrement_rad(), 1.0 * kDegree, 1e-12);
}

TEST(LidarParameters, RefuseASweepLongerThanTheScanPeriod) {
  LidarParameters lidar;
  lidar.time_increment_s = 1.01 / lidar.scan_rate_hz / (lidar.beams - 1);
  EXPECT_THAT(refusal(lidar), HasSubstr("a sweep fits between two scans"));
  lidar.time_increment_s *= 0.98;
  EXPECT_EQ(refusal(lidar), "accepted");
}

TEST(LidarParameters, RefuseMoreThanATurnAndAnEmptyRange) {
  LidarParameters lidar;
  lidar.angle_min_rad = -3.2;
  lidar.angle_max_rad = 3.2;
  EXPECT_THAT(refusal(lidar), HasSubstr("at most a turn"));
  lidar.angle_max_rad = -3.2;
  EXPECT_THAT(refusal(lidar), HasSubstr("> angle_min_rad"));
  lidar = {};
  lidar.range_max_m = lidar.range_min_m;
  EXPECT_THAT(refusal(lidar), HasSubstr("> range_min_m"));
}

TEST(LidarParameters, NameDetailsOfTheLightInASection) {
  LidarParameters lidar;
  lidar.light.footprint_rays = 1;
  EXPECT_THAT(refusal(lidar), HasSubstr("light/footprint_rays must be in [2, 100]"));
}

}  // namespace
}  // namespace ramscout_sim
