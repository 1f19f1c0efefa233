// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/recovery_parameters.hpp"

#include <set>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

RecoveryParameters read(const std::string& yaml) {
  ram_parameters::ParameterReader reader(YAML::Load(yaml), "test");
  return readRecoveryParameters(reader);
}

TEST(RecoveryParameters, ReadTheKeysOfTheSection) {
  const RecoveryParameters p = read(
      "{relocalisation: {enabled: false, discontinuity: 0.3, contradiction: 0.2, window: 3.0, "
      "length: 30.0, position_sigma: 0.1, minimum_pairs: 5, map_views: {search: {tile_m: 2.0}}}}");
  EXPECT_FALSE(p.enabled);
  EXPECT_EQ(p.monitor.discontinuity_threshold, 0.3);
  EXPECT_EQ(p.monitor.contradiction_threshold, 0.2);
  EXPECT_EQ(p.monitor.lost.window, 3.0);
  EXPECT_EQ(p.relocaliser.local.length, 30.0);
  EXPECT_EQ(p.relocaliser.constellation.position_sigma, 0.1);
  EXPECT_EQ(p.relocaliser.constellation.minimum_pairs, 5);
  EXPECT_EQ(p.map_views.search.tile_m, 2.0);
}

TEST(RecoveryParameters, AreTheDefaultsInTheShippedFile) {
  const std::string path = std::string(CONFIG_FOLDER) + "/fast_slam.yaml";
  ram_parameters::ParameterReader reader(ram_parameters::readYamlFile(path), path);
  const auto shipped = RecoveryParameters::table().rows(readRecoveryParameters(reader));
  const auto defaults = RecoveryParameters::table().rows();
  ASSERT_EQ(shipped.size(), defaults.size());
  for (std::size_t i = 0; i < shipped.size(); ++i)
    EXPECT_EQ(shipped[i].value, defaults[i].value) << shipped[i].key;
}

TEST(RecoveryParameters, HaveEachKeyOnce) {
  std::set<std::string> keys;
  for (const auto& row : RecoveryParameters::table().rows())
    EXPECT_TRUE(keys.insert(row.key).second) << row.key;
}

TEST(RecoveryParameters, RefuseWhatIsUnknownOrOutOfBounds) {
  EXPECT_THROW(read("{relocalisation: {windwo: 3.0}}"), std::invalid_argument);
  EXPECT_THROW(read("{relocalisation: {window: 0.0}}"), std::invalid_argument);
  EXPECT_THROW(read("{relocalisation: {contradiction: 1.1}}"), std::invalid_argument);
  EXPECT_THROW(read("{relocalisation: {tracking: {probation_m: -1.0}}}"), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
