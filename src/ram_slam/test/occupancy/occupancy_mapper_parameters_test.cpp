// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/occupancy/occupancy_mapper_parameters.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

OccupancyMapperParameters read(const std::string& yaml) {
  ram_parameters::ParameterReader reader(YAML::Load(yaml), "test");
  return readOccupancyMapperParameters(reader);
}

TEST(OccupancyMapperParameters, ShippedFileHasTheDefaults) {
  ram_parameters::ParameterReader reader(
      ram_parameters::readYamlFile(CONFIG_FOLDER "/occupancy_mapper.yaml"), "shipped");
  const auto& table = OccupancyMapperParameters::table();
  const auto shipped = table.rows(readOccupancyMapperParameters(reader));
  const auto defaults = table.rows();
  for (std::size_t i = 0; i < defaults.size(); ++i)
    EXPECT_EQ(shipped[i].value, defaults[i].value) << defaults[i].key;
}

TEST(OccupancyMapperParameters, AreReadWholeOrRefused) {
  const OccupancyMapperParameters parameters = read("{resolution: 0.1, min_visits: 2}");
  EXPECT_EQ(parameters.resolution, 0.1);
  EXPECT_EQ(parameters.min_visits, 2);
  for (const char* yaml : {"{resolution: 0}", "{resolution: -0.05}", "{resolution: .nan}",
                           "{resolution: fine}", "{min_visits: 0}", "{occupied_threshold: 1.5}",
                           "{clear_max_range_m: 100.0}", "{map_frame: /map}", "{map_folder: ''}",
                           "{resolution: 2.0, max_range_m: 1.0}", "{resolutoin: 0.05}"}) {
    EXPECT_THROW(read(yaml), std::invalid_argument) << yaml;
  }
}

TEST(OccupancyMapperParameters, AcceptTheEndsOfTheirRanges) {
  EXPECT_NO_THROW(read("{key_distance_m: 0.0, key_angle_rad: 0.0, clear_max_range_m: 0.0}"));
  EXPECT_NO_THROW(read("{clear_max_range_m: 30.0}"));
  EXPECT_NO_THROW(read("{max_scan_count: 1, max_cell_count: 4096, min_visits: 1000000}"));
}

}  // namespace
}  // namespace ram_slam
