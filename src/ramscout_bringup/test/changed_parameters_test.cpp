// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/changed_parameters.hpp"

#include <gtest/gtest.h>

namespace ramscout_bringup {
namespace {

ram_parameters::ParameterFile exampleFile() {
  ram_parameters::ParameterFile file;
  file.name = "estimator.yaml";
  file.rows.resize(4);
  file.rows[0].key = "particle_amount";
  file.rows[0].value = "100";
  file.rows[1].key = "recovery/window";
  file.rows[1].value = "2.5";
  file.rows[1].unit = "s";
  file.rows[2].key = "base_frame";
  file.rows[2].value = "base_link";
  file.rows[3].key = "weights";
  file.rows[3].value = "[1, 2]";
  return file;
}

TEST(ChangedParameters, AreThoseWithAnotherValueThanTheDefault) {
  const auto changed = changedParameters(
      YAML::Load("{particle_amount: 100, recovery: {window: 4}, weights: [1.0, 3], other: 5}"),
      exampleFile());
  ASSERT_EQ(changed.size(), 2U);
  EXPECT_EQ(changed[0].file, "estimator.yaml");
  EXPECT_EQ(changed[0].key, "recovery/window");
  EXPECT_EQ(changed[0].value, "4");
  EXPECT_EQ(changed[0].default_value, "2.5");
  EXPECT_EQ(changed[0].unit, "s");
  EXPECT_EQ(changed[1].value, "[1, 3]");
  EXPECT_EQ(changed[1].default_value, "[1, 2]");
}

TEST(ChangedParameters, TheSameValueWrittenInAnotherWayIsNoChange) {
  EXPECT_TRUE(changedParameters(YAML::Load("{particle_amount: 1e2, recovery: {window: 2.50}, "
                                           "base_frame: 'base_link', weights: [1.0, 2.0]}"),
                                exampleFile())
                  .empty());
}

TEST(ChangedParameters, OfAnEmptyFileOrAWrongSectionAreNone) {
  EXPECT_TRUE(changedParameters(YAML::Load(""), exampleFile()).empty());
  EXPECT_TRUE(changedParameters(YAML::Load("recovery: 3"), exampleFile()).empty());
}

TEST(ChangedParameters, LeaveTheValuesAsTheyWere) {
  const YAML::Node values = YAML::Load("{recovery: {window: 4}}");
  changedParameters(values, exampleFile());
  EXPECT_EQ(values["recovery"]["window"].as<int>(), 4);
}

}  // namespace
}  // namespace ramscout_bringup
