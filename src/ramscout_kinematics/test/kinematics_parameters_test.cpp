// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/kinematics_parameters.hpp"

#include <algorithm>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ramscout_kinematics/kinematics.hpp"
#include "ramscout_kinematics/parameter_files.hpp"

#include "drives.hpp"

namespace ramscout_kinematics {
namespace {

ram_parameters::ParameterReader reader(const std::string& yaml) {
  return {YAML::Load(yaml), "test"};
}

TEST(ReadKinematicsParameters, ChoosesTheModelAndReadsItsSection) {
  auto source = reader(
      "{model: differential, differential: {left_noise_m2_per_m: 4.0, right_noise_m2_per_m: 0}}");
  const auto parameters = readKinematicsParameters(source);
  EXPECT_EQ(parameters.drive_model->noise({1.0, 0.0, 0.0})(0, 0), 1.0);
}

struct SledgeParameters {
  double noise_m2_per_m = 1.0;

  static const ram_parameters::ParameterTable<SledgeParameters>& table() {
    static const auto table = ram_parameters::ParameterTable<SledgeParameters>().add(
        "noise_m2_per_m", &SledgeParameters::noise_m2_per_m, "m^2/m", ram_parameters::positive(),
        "Variance of every direction per metre.");
    return table;
  }
  void validate() const { table().check(*this); }
};

/// A platform of the test's own: it slides.
class Sledge : public DriveModel {
public:
  explicit Sledge(const SledgeParameters& parameters) : parameters_(parameters) {}
  Eigen::Matrix3d noise(const Eigen::Vector3d& increment) const override {
    return parameters_.noise_m2_per_m * increment.norm() * Eigen::Matrix3d::Identity();
  }

private:
  SledgeParameters parameters_;
};
const DriveModelRegistration kSledge("sledge", driveModelType<Sledge, SledgeParameters>());

TEST(ReadKinematicsParameters, ModelIsKnownByItsRegistrationAlone) {
  auto source = reader("{model: sledge, sledge: {noise_m2_per_m: 3.0}}");
  Kinematics kinematics(readKinematicsParameters(source));
  addAll(kinematics, drive({1.0, 0.0, 0.0}, 1.0, 0.1));
  EXPECT_NEAR(kinematics.motion(after(0.0), after(1.0)).covariance(2, 2), 3.0, 1e-9);
}

TEST(ReadKinematicsParameters, RefusesWhatItDoesNotKnow) {
  for (const char* yaml :
       {"{model: tank}", "{modell: differential}", "{differential: {wheel_seperation_m: 0.4}}",
        "{differential: {wheel_separation_m: 0}}", "{buffer_duration_s: -1}", "{max_gap_s: 0.1}",
        "{standing_sigma_m: -1}", "{max_states: 0}"}) {
    auto source = reader(yaml);
    EXPECT_THROW(readKinematicsParameters(source), std::invalid_argument) << yaml;
  }
}

TEST(ReadKinematicsParameters, ReadsEveryPart) {
  auto source = reader(
      "{standing_sigma_m: 0.5, gap_s: 0.75, odom_frame: wheels, base_frame: '', seed: 7, "
      "standing_speed_mps: 0.25, jump_slack_m: 0.125, max_states: 3}");
  const KinematicsParameters parameters = readKinematicsParameters(source);
  EXPECT_EQ(parameters.standing_sigma_m, 0.5);
  EXPECT_EQ(parameters.standing_speed_mps, 0.25);
  EXPECT_EQ(parameters.buffer.gap_s, 0.75);
  EXPECT_EQ(parameters.buffer.jump_slack_m, 0.125);
  EXPECT_EQ(parameters.node.odom_frame, "wheels");
  EXPECT_EQ(parameters.node.base_frame, "");
  EXPECT_EQ(parameters.node.seed, 7);
  EXPECT_EQ(parameters.node.max_states, 3);
}

TEST(KinematicsParameters, AreInvalidWithoutADriveModel) {
  KinematicsParameters parameters;
  parameters.drive_model = nullptr;
  EXPECT_THROW(Kinematics{parameters}, std::invalid_argument);
}

TEST(KinematicsParameters, ShippedFileHoldsTheDefaults) {
  ram_parameters::ParameterReader source(ram_parameters::readYamlFile(CONFIG_FILE), CONFIG_FILE);
  const auto shipped = KinematicsParameters::table().rows(readKinematicsParameters(source));
  const auto defaults = KinematicsParameters::table().rows();
  ASSERT_EQ(shipped.size(), defaults.size());
  for (std::size_t i = 0; i < shipped.size(); ++i)
    EXPECT_EQ(shipped[i].value, defaults[i].value) << defaults[i].key;
}

TEST(KinematicsParameterFiles, ContainTheSectionOfEveryModel) {
  const auto files = parameterFiles();
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0].name, "kinematics.yaml");
  std::vector<std::string> keys;
  for (const auto& row : files[0].rows) keys.push_back(row.key);
  for (const char* key :
       {"model", "seed", "gap_s", "ackermann/wheelbase_m", "differential/left_noise_m2_per_m",
        "holonomic/turn_noise_rad2_per_m", "sledge/noise_m2_per_m"}) {
    EXPECT_THAT(keys, testing::Contains(key));
  }
}

TEST(KinematicsParameterFiles, ReadBackAsTheDefaults) {
  ram_parameters::ParameterReader source(YAML::Load(ram_parameters::toYaml(parameterFiles()[0])),
                                         "made from the table");
  const auto made = KinematicsParameters::table().rows(readKinematicsParameters(source));
  const auto defaults = KinematicsParameters::table().rows();
  for (std::size_t i = 0; i < made.size(); ++i) EXPECT_EQ(made[i].value, defaults[i].value);
}

}  // namespace
}  // namespace ramscout_kinematics
