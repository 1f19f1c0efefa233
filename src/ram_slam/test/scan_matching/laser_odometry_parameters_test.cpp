// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/laser_odometry_parameters.hpp"

#include <set>
#include <stdexcept>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

LaserOdometryParameters read(const char* yaml) {
  ram_parameters::ParameterReader reader(YAML::Load(yaml), "test");
  return readLaserOdometryParameters(reader);
}

TEST(LaserOdometryParameterTable, ReadsTheKeysOfSurfacesAndMatcherBesideItsOwn) {
  const LaserOdometryParameters parameters =
      read("{neighbour_count: 6, first_gate_m: 0.4, key_scan_count: 5, reference_count: 5}");
  EXPECT_EQ(parameters.surfaces.neighbour_count, 6);
  EXPECT_EQ(parameters.matcher.first_gate_m, 0.4);
  EXPECT_EQ(parameters.key_scan_count, 5);
  EXPECT_EQ(parameters.matcher.last_gate_m, ScanMatcherParameters{}.last_gate_m);
}

TEST(LaserOdometryParameterTable, ReadsExpertKeysFromTheirSections) {
  const LaserOdometryParameters parameters = read(
      "{slip: {deviations: 6.0, jump_distance_m: 0.1}, wheel_bias: {memory_m: 20.0}, "
      "pose_search: {levels: 5}, stamp_offset: {min_turns: 10}}");
  EXPECT_EQ(parameters.slip.deviations, 6.0);
  EXPECT_EQ(parameters.slip.jump.distance_m, 0.1);
  EXPECT_EQ(parameters.wheel_bias.memory_m, 20.0);
  EXPECT_EQ(parameters.pose_search.levels, 5);
  EXPECT_EQ(parameters.stamp_offset.min_turns, 10);
}

TEST(LaserOdometryParameterTable, RefusesUnknownKeysWrongTypesAndValuesOutOfBounds) {
  for (const char* yaml :
       {"{key_scan_distanse_m: 0.3}", "{use_wheels: 3}", "{key_scan_distance_m: 0.0}",
        "{reference_count: 30}", "{last_gate_m: 0.5}", "{max_stamp_offset_s: 1.5}",
        "{slip: {deviations: 0.0}}", "{pose_search: {levels: 9}}", "{slip: {deviatoins: 4.0}}"}) {
    EXPECT_THROW(read(yaml), std::invalid_argument) << yaml;
  }
}

TEST(LaserOdometryParameterTable, HasEveryKeyOnce) {
  std::set<std::string> keys;
  for (const auto& row : LaserOdometryParameters::table().rows()) {
    EXPECT_TRUE(keys.insert(row.key).second) << row.key;
    EXPECT_FALSE(row.text.empty()) << row.key;
  }
}

}  // namespace
}  // namespace ram_slam
