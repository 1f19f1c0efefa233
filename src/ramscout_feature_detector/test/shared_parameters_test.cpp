// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/shared_parameters.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace ramscout_feature_detector {
namespace {

template <typename Parameters>
void expectDocumented() {
  EXPECT_NO_THROW(Parameters::table().check(Parameters{}));
  for (const auto& row : Parameters::table().rows()) EXPECT_FALSE(row.text.empty()) << row.key;
}

TEST(SharedParameters, DefaultsAreValidAndDocumented) {
  expectDocumented<SegmentationParameters>();
  expectDocumented<LineParameters>();
  expectDocumented<TwoLineParameters>();
  expectDocumented<MarkerParameters>();
  expectDocumented<DetectorNodeParameters>();
}

TEST(SharedParameters, LegsGetLonger) {
  TwoLineParameters parameters;
  for (const std::vector<double>& bad :
       {std::vector<double>{}, std::vector<double>{0.0, 0.1}, std::vector<double>{0.2, 0.1}}) {
    parameters.leg_lengths_m = bad;
    EXPECT_THROW(TwoLineParameters::table().check(parameters), std::invalid_argument);
  }
}

TEST(SharedParameters, FramesHaveNoLeadingSlash) {
  DetectorNodeParameters parameters;
  for (const char* bad : {"", "/base_link"}) {
    parameters.base_frame = bad;
    EXPECT_THROW(DetectorNodeParameters::table().check(parameters), std::invalid_argument) << bad;
  }
}

TEST(SharedParameters, SectionsAreOfTheirStruct) {
  TwoLineParameters parameters;
  parameters.line.refinements = 11;
  EXPECT_THROW(TwoLineParameters::table().check(parameters), std::invalid_argument);
}

}  // namespace
}  // namespace ramscout_feature_detector
