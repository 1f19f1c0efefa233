// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ramscout_feature_detector/edge.hpp"

namespace ramscout_feature_detector {
namespace {

EdgeDetectorParameters read(const std::string& yaml) {
  ram_parameters::ParameterReader reader(YAML::Load(yaml), "test");
  return readEdgeDetectorParameters(reader);
}

TEST(EdgeDetectorParameters, ShippedFileHoldsTheDefaults) {
  ram_parameters::ParameterReader reader(ram_parameters::readYamlFile(EDGE_CONFIG_FILE),
                                         EDGE_CONFIG_FILE);
  const EdgeDetectorParameters shipped = readEdgeDetectorParameters(reader);
  const auto rows = EdgeDetectorParameters::table().rows(shipped);
  const auto defaults = EdgeDetectorParameters::table().rows();
  ASSERT_EQ(rows.size(), defaults.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    EXPECT_EQ(rows[i].value, defaults[i].value) << rows[i].key;
}

TEST(EdgeDetectorParameters, OutOfRangeIsRefusedByName) {
  for (const char* yaml :
       {"laser_range_sigma: 0", "distance_threshold: -1", "object_size: 9", "bend_scale: 0",
        "laser_range_sigma: wide", "max_features: 1.5", "bend_angle: 7", "significance_min: -1",
        "position_sigma_limit: .nan", "feature_distance: 0", "max_features: 0", "base_frame: ''",
        "bendangle: 1", "ends: {few_points: -1}", "objects: {min_points: 0}",
        "bends: {ragged_variance_m2: -1}", "corner_threshold: 0.6"}) {
    try {
      read(yaml);
      ADD_FAILURE() << yaml << " was accepted";
    } catch (const std::invalid_argument& error) {
      const std::string key = std::string(yaml).substr(0, std::string(yaml).find(':'));
      EXPECT_THAT(error.what(), testing::HasSubstr(key));
    }
  }
}

TEST(EdgeDetectorParameters, SectionsReachTheTuning) {
  const EdgeDetectorParameters parameters = read(
      "{corner_threshold: 0.25, ends: {few_points: 3}, objects: {depth_share: 0.5}, "
      "bends: {bend_gain: 9}, segmentation: {lone_reading_m: 0.5}, "
      "two_lines: {margin_sigmas: 2, leg_lengths_m: [0.2, 1.0], line: {refinements: 1}}, "
      "markers: {circle_steps: 12}}");
  EXPECT_EQ(parameters.ends.few_points, 3);
  EXPECT_EQ(parameters.objects.depth_share, 0.5);
  EXPECT_EQ(parameters.bends.bend_gain, 9.0);
  EXPECT_EQ(parameters.segmentation.lone_reading_m, 0.5);
  EXPECT_EQ(parameters.two_lines.leg_lengths_m, (std::vector<double>{0.2, 1.0}));
  EXPECT_EQ(parameters.two_lines.line.refinements, 1);
  EXPECT_EQ(parameters.node.markers.circle_steps, 12);
}

TEST(EdgeDetectorParameters, CornerModelIsThatOfTheParameters) {
  const EdgeDetectorParameters parameters = read("{laser_range_sigma: 0.01, significance_min: 9}");
  const CornerModel model = parameters.cornerModel();
  EXPECT_EQ(model.range_sigma_m, 0.01);
  EXPECT_EQ(model.significance_min, 9.0);
  EXPECT_EQ(model.corner_threshold, parameters.corner_threshold);
  EXPECT_EQ(&model.tuning, &parameters.two_lines);
}

}  // namespace
}  // namespace ramscout_feature_detector
