// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include "ram_slam/smoothing/map_smoother.hpp"

namespace ram_slam {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

MapSmootherParameters read(const std::string& yaml) {
  ram_parameters::ParameterReader reader(YAML::Load(yaml), "test");
  return readMapSmootherParameters(reader);
}

TEST(MapSmootherParameters, AreReadIntoTheStructsOfTheirModules) {
  const MapSmootherParameters parameters = read(
      "{key_scan_distance_m: 0.4, motion_deviation_m_per_m: 0.06, loop_min_path_m: 9.0,"
      " loop_constellation_path_m: 0.0, closure_deviation_m: 0.04, closure_tolerance_chi2: 6.0,"
      " graph_max_iterations: 21, refinement_iterations: 4}");
  EXPECT_EQ(parameters.key_scans.distance_m, 0.4);
  EXPECT_EQ(parameters.key_scans.motion_noise.deviation_m_per_m, 0.06);
  EXPECT_EQ(parameters.loops.search.min_path_m, 9.0);
  EXPECT_EQ(parameters.loops.constellation_path_m, 0.0);
  EXPECT_EQ(parameters.loops.closure_deviation_m, 0.04);
  EXPECT_EQ(parameters.graph.closure_tolerance_chi2, 6.0);
  EXPECT_EQ(parameters.graph.max_iterations, 21);
  EXPECT_EQ(parameters.refinement.iterations, 4);
}

TEST(MapSmootherParameters, AreTheDefaultsInTheShippedFile) {
  ram_parameters::ParameterReader reader(
      YAML::LoadFile(std::string(CONFIG_FOLDER) + "/map_smoother.yaml"), "map_smoother.yaml");
  const auto shipped = MapSmootherParameters::table().rows(readMapSmootherParameters(reader));
  const auto defaults = MapSmootherParameters::table().rows();
  for (std::size_t i = 0; i < defaults.size(); ++i)
    EXPECT_EQ(shipped[i].value, defaults[i].value) << defaults[i].key;
}

TEST(MapSmootherParameters, HaveKeysThatOccurOnce) {
  const auto rows = MapSmootherParameters::table().rows();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(rows[i].key, rows[j].key);
  }
}

TEST(MapSmootherParameters, AreRefusedByNameOutOfBounds) {
  EXPECT_THAT([] { read("{loop_min_score: 1.5}"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("loop_min_score must be in [0, 1]")));
  EXPECT_THAT([] { read("{refinement_max_angle_rad: 0.0}"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("refinement_max_angle_rad")));
  EXPECT_THAT([] { read("{last_gate_m: 0.5}"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("last_gate_m")));
  EXPECT_THROW(read("{optimize_period_s: -1.0}"), std::invalid_argument);
  EXPECT_THROW(read("{no_such_key: 1.0}"), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
