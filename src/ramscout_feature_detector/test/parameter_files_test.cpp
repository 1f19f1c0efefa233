// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/parameter_files.hpp"

#include <gtest/gtest.h>

#include "ramscout_feature_detector/edge.hpp"
#include "ramscout_feature_detector/parameters.hpp"

namespace ramscout_feature_detector {
namespace {

ram_parameters::ParameterReader reader(const ram_parameters::ParameterFile& file) {
  return {YAML::Load(ram_parameters::toYaml(file)), file.name};
}

TEST(DetectorParameterFiles, ReadBackAsTheDefaults) {
  const auto files = parameterFiles();
  ASSERT_EQ(files.size(), 2U);
  EXPECT_EQ(files[0].name, "feature_detector.yaml");
  EXPECT_EQ(files[1].name, "edge_detector.yaml");
  auto corners = reader(files[0]);
  EXPECT_EQ(readFeatureDetectorParameters(corners).ppm, FeatureDetectorParameters{}.ppm);
  auto edges = reader(files[1]);
  EXPECT_EQ(readEdgeDetectorParameters(edges).bend_angle, EdgeDetectorParameters{}.bend_angle);
}

TEST(DetectorParameterFiles, HoldTheParametersOfUsersOnly) {
  for (const auto& file : parameterFiles()) {
    const YAML::Node yaml = YAML::Load(ram_parameters::toYaml(file));
    EXPECT_TRUE(yaml["base_frame"]) << file.name;
    EXPECT_FALSE(yaml["two_lines"]) << file.name;
    EXPECT_FALSE(yaml["max_lasers"]) << file.name;
  }
}

TEST(DetectorParameterFiles, DescribeEveryParameter) {
  for (const auto& file : parameterFiles()) {
    for (const auto& row : file.rows) EXPECT_FALSE(row.text.empty()) << row.key;
  }
}

}  // namespace
}  // namespace ramscout_feature_detector
