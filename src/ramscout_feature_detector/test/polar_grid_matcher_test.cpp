// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/polar_grid_matcher.hpp"

#include <gtest/gtest.h>

#include "ramscout_feature_detector/polar_grid.hpp"

namespace ramscout_feature_detector {
namespace {

/// Ratios that give the distance: 100 at 0, 90 at 0.02, ... 10 at 0.18.
PolarGridMatcher ruler() {
  return PolarGridMatcher({100, 90, 80, 70, 60, 50, 40, 30, 20, 10});
}

PolarGrid filled(PolarGrid::Cell cell) {
  PolarGrid grid;
  for (int ring = 0; ring < PolarGrid::kRings; ++ring)
    for (int sector = 0; sector < PolarGrid::kSectors; ++sector) grid.set(ring, sector, cell);
  return grid;
}

double ratio(const PolarGrid& a, const PolarGrid& b) {
  const PolarGridMatcher matcher = ruler();
  return matcher.logLikelihoodRatio(*matcher.parse(a.toString()), *matcher.parse(b.toString()));
}

TEST(PolarGridMatcher, RatioIsLinearBetweenThePlacesOfTheTable) {
  PolarGrid other = filled(PolarGrid::kFree);
  for (int sector = 0; sector < PolarGrid::kSectors; ++sector)
    other.set(0, sector, PolarGrid::kOccupied);
  const double distance =
      ComparableGrid(filled(PolarGrid::kFree)).distance(ComparableGrid(other)).value();
  EXPECT_NEAR(distance, (24.0 + 20.0 * 0.12) / (192.0 + 20.0), 1e-12);
  EXPECT_NEAR(ratio(filled(PolarGrid::kFree), other), 100.0 - distance / 0.02 * 10.0, 1e-9);
}

TEST(PolarGridMatcher, BeyondTheTableTheLastRatioCounts) {
  EXPECT_DOUBLE_EQ(ratio(filled(PolarGrid::kFree), filled(PolarGrid::kOccupied)), 10.0);
}

TEST(PolarGridMatcher, WithoutACommonPartThereIsNoDecision) {
  EXPECT_EQ(ratio(filled(PolarGrid::kUnknown), filled(PolarGrid::kFree)), 0.0);
}

TEST(PolarGridMatcher, OtherTextsAreNoDescriptor) {
  EXPECT_EQ(ruler().parse("pg2:8x48:8.0:100:" + std::string(128, 'V')), nullptr);
  EXPECT_EQ(ruler().parse(""), nullptr);
}

TEST(ComparableGrid, WeightsDecideHowMuchEachDifferenceCounts) {
  const ComparableGrid free(filled(PolarGrid::kFree));
  PolarGrid half = filled(PolarGrid::kFree);
  for (int ring = 4; ring < PolarGrid::kRings; ++ring)
    for (int sector = 0; sector < PolarGrid::kSectors; ++sector)
      half.set(ring, sector, PolarGrid::kUnknown);
  GridComparison weights;
  weights.prior_difference = 0.0;
  weights.one_sided = 0.4;
  EXPECT_NEAR(free.distance(ComparableGrid(half), weights).value(), 0.5 * 0.4, 1e-12);
  weights.least_common_cells = 97;
  EXPECT_FALSE(free.distance(ComparableGrid(half), weights));
}

}  // namespace
}  // namespace ramscout_feature_detector
