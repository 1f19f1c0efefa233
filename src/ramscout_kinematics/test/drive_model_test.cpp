// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/drive_model.hpp"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ramscout_kinematics {
namespace {

TEST(DriveModels, AreKnownByName) {
  for (const char* name : {"ackermann", "differential", "holonomic"}) {
    EXPECT_EQ(driveModels().count(name), 1U) << name;
    EXPECT_NE(makeDriveModel(name), nullptr);
  }
}

TEST(DriveModels, UnknownNameIsRefusedWithTheNamesThereAre) {
  try {
    makeDriveModel("tank");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("ackermann, differential, holonomic"));
    EXPECT_THAT(error.what(), testing::HasSubstr("'tank'"));
  }
}

TEST(DriveModels, ParametersOfEveryModelAreDocumented) {
  for (const auto& [name, type] : driveModels()) {
    const auto rows = type.rows();
    EXPECT_FALSE(rows.empty()) << name;
    for (const auto& row : rows) {
      EXPECT_FALSE(row.text.empty()) << name << "/" << row.key;
      EXPECT_FALSE(row.unit.empty()) << name << "/" << row.key;
      EXPECT_FALSE(row.range.empty()) << name << "/" << row.key;
    }
  }
}

TEST(DriveModels, EachReadsItsOwnParametersOnly) {
  for (const auto& [name, type] : driveModels()) {
    ram_parameters::ParameterReader unknown(YAML::Load("{unknown_key: 1}"), name);
    EXPECT_THROW(type.read(unknown), std::invalid_argument) << name;
    ram_parameters::ParameterReader negative(YAML::Load("{" + type.rows()[0].key + ": -1}"), name);
    EXPECT_THROW(type.read(negative), std::invalid_argument) << name;
  }
}

TEST(DriveModels, NoiseOfEveryModelGrowsWithTheDistanceOnly) {
  const Eigen::Vector3d increment(0.3, 0.0, 0.1);
  for (const auto& [name, type] : driveModels()) {
    const auto model = makeDriveModel(name);
    EXPECT_TRUE(model->noise(4.0 * increment).isApprox(4.0 * model->noise(increment), 1e-12))
        << name;
    EXPECT_EQ(model->noise(Eigen::Vector3d::Zero()), Eigen::Matrix3d::Zero()) << name;
  }
}

}  // namespace
}  // namespace ramscout_kinematics
