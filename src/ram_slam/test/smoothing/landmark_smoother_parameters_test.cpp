// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/landmark_smoother_parameters.hpp"

#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

namespace ram_slam {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

LandmarkSmootherParameters read(const std::string& yaml) {
  ram_parameters::ParameterReader reader(YAML::Load(yaml), "test");
  return readLandmarkSmootherParameters(reader);
}

TEST(LandmarkSmootherParameters, AreReadByTheirNames) {
  const LandmarkSmootherParameters parameters =
      read("{map_frame: world, reading_share: 0.5, round_count: 3, attempt_count: 0}");
  EXPECT_EQ(parameters.map_frame, "world");
  EXPECT_EQ(parameters.base_frame, "base_link");
  EXPECT_EQ(parameters.reading_share, 0.5);
  EXPECT_EQ(parameters.round_count, 3);
  EXPECT_EQ(parameters.attempt_count, 0);
}

TEST(LandmarkSmootherParameters, AreTheDefaultsInTheShippedFile) {
  ram_parameters::ParameterReader reader(
      YAML::LoadFile(std::string(CONFIG_FOLDER) + "/landmark_smoother.yaml"),
      "landmark_smoother.yaml");
  const auto& table = LandmarkSmootherParameters::table();
  const auto shipped = table.rows(readLandmarkSmootherParameters(reader));
  const auto defaults = table.rows();
  for (std::size_t i = 0; i < defaults.size(); ++i)
    EXPECT_EQ(shipped[i].value, defaults[i].value) << defaults[i].key;
}

TEST(LandmarkSmootherParameters, AreRefusedByNameOutOfBounds) {
  EXPECT_THAT([] { read("{reading_share: 0.0}"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("reading_share must be in (0, 1]")));
  EXPECT_THAT([] { read("{first_deviation_m: 0.01}"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr(">= last_deviation_m")));
  EXPECT_THROW(read("{least_evidence: 0.0}"), std::invalid_argument);
  EXPECT_THROW(read("{attempt_count: -1}"), std::invalid_argument);
  EXPECT_THROW(read("{no_such_key: 1.0}"), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
