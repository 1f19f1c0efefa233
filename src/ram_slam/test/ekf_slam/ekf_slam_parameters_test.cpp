// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ekf_slam/ekf_slam_parameters.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace ram_slam {
namespace {

EkfSlamParameters parametersFrom(const char* yaml) {
  ram_parameters::ParameterReader reader(YAML::Load(yaml), "test");
  return readEkfSlamParameters(reader);
}

TEST(EkfSlamParameters, AreThoseOfLandmarksAndItsOwn) {
  const EkfSlamParameters parameters =
      parametersFrom("{max_landmarks: 7, association_gate: 5.0, node: {a: 1}, relocalisation: {}}");
  EXPECT_EQ(parameters.max_landmarks, 7);
  EXPECT_EQ(parameters.common.association_gate, 5.0);
}

TEST(EkfSlamParameters, RefuseWhatOnlyParticlesHave) {
  EXPECT_THROW(parametersFrom("{particle_amount: 7}"), std::invalid_argument);
  EXPECT_THROW(parametersFrom("{max_landmarks: 0}"), std::invalid_argument);
  EXPECT_THROW(parametersFrom("{creation_gate: 1.0}"), std::invalid_argument)
      << "< association_gate";
}

}  // namespace
}  // namespace ram_slam
