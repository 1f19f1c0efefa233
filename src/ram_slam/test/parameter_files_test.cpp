// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/parameter_files.hpp"

#include <set>

#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

namespace ram_slam {
namespace {

TEST(SlamParameterFiles, HaveEachNameAndKeyOnceAndDescribeEveryKey) {
  std::set<std::string> names;
  for (const auto& file : parameterFiles()) {
    EXPECT_TRUE(names.insert(file.name).second) << file.name;
    std::set<std::string> keys;
    for (const auto& row : file.rows) {
      EXPECT_TRUE(keys.insert(row.key).second) << file.name << ": " << row.key;
      EXPECT_FALSE(row.text.empty()) << file.name << ": " << row.key;
    }
  }
}

TEST(SlamParameterFiles, HoldTheParametersOfUsersOnly) {
  for (const auto& file : parameterFiles()) {
    if (file.name != "laser_odometry.yaml") continue;
    const YAML::Node yaml = YAML::Load(ram_parameters::toYaml(file));
    EXPECT_TRUE(yaml["key_scan_distance_m"]);
    EXPECT_TRUE(yaml["first_gate_m"]);
    EXPECT_FALSE(yaml["slip"]);
    EXPECT_FALSE(yaml["gate_shrink"]);
  }
}

}  // namespace
}  // namespace ram_slam
