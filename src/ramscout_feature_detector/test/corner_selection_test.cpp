// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/corner_selection.hpp"

#include <gtest/gtest.h>

#include "contours.hpp"

namespace ramscout_feature_detector {
namespace {

TwoLineCorner lines(const Eigen::Vector2d& position_m) {
  TwoLineCorner lines;
  lines.position_m = position_m;
  lines.covariance_m2 = 1e-4 * Eigen::Matrix2d::Identity();
  lines.cornerness = 0.4;
  lines.significance = 20.0;
  return lines;
}

/// A peak of a response where two lines cross.
ResponsePeak peakAt(const Eigen::Vector2d& position_m, int level, double response) {
  const double ppm = std::ldexp(FeatureDetectorParameters{}.ppm, -level);
  ResponsePeak peak;
  peak.level = level;
  peak.column = static_cast<int>(std::floor(position_m.x() * ppm));
  peak.row = static_cast<int>(std::floor(position_m.y() * ppm));
  peak.min_eigenvalue = response;
  peak.cornerness = 0.3;
  peak.point_m = position_m;
  return peak;
}

Corner corner(double x_m, double y_m, double response) {
  return {lines({x_m, y_m}), peakAt({x_m, y_m}, 0, response)};
}

TEST(IsAdmissible, CornersNearAnEndOfTheSurfaceAreNot) {
  const FeatureDetectorParameters parameters;
  const Contour contour(wallsMeeting(0.5 * M_PI));
  EXPECT_TRUE(isAdmissible(lines({3.0, 0.0}), contour, parameters));
  const Eigen::Vector2d beside_m = contour.front() + Eigen::Vector2d(0.2, 0.0);
  EXPECT_FALSE(isAdmissible(lines(beside_m), contour, parameters));
  EXPECT_TRUE(isAdmissible(lines(beside_m), Contour(wallsMeeting(0.5 * M_PI), true), parameters));
}

TEST(IsAdmissible, FlatInsignificantAndUncertainCornersAreNot) {
  const FeatureDetectorParameters parameters;
  const Contour contour(wallsMeeting(0.5 * M_PI));
  const auto isStill = [&](auto&& change) {
    TwoLineCorner changed = lines({3.0, 0.0});
    change(changed);
    return isAdmissible(changed, contour, parameters);
  };
  EXPECT_FALSE(isStill([](auto& c) { c.cornerness = 0.07; }));
  EXPECT_FALSE(isStill([](auto& c) { c.significance = 15.0; }));
  EXPECT_FALSE(isStill([](auto& c) { c.covariance_m2(0, 0) = 0.8; }));
  EXPECT_FALSE(isStill([](auto& c) { c.covariance_m2(1, 1) = 0.036 * 0.036; }));
  EXPECT_TRUE(isStill([](auto& c) { c.covariance_m2(1, 1) = 0.034 * 0.034; }));
  // The longest axis counts, not the entries: both axes at 45 degrees.
  EXPECT_FALSE(isStill([](auto& c) { c.covariance_m2 << 1e-3, 0.9e-3, 0.9e-3, 1e-3; }));
}

/// Peaks of a corner at (3, 0) on the levels asked for, of all that are there.
struct Levels {
  std::vector<int> levels;
  std::vector<ResponsePeak> operator()(int level) const {
    for (const int known : levels)
      if (known == level) return {peakAt({3.0, 0.0}, level, 1.0)};
    return {};
  }
};

TEST(Confirm, TakesTwoConsecutiveLevels) {
  const FeatureDetectorParameters parameters;
  const auto two = confirm(lines({3.0, 0.0}), Levels{{1, 2}}, parameters);
  ASSERT_TRUE(two);
  EXPECT_EQ(two->peak.level, 1);  // the finest on which it is a corner
  EXPECT_FALSE(confirm(lines({3.0, 0.0}), Levels{{0, 2}}, parameters));
  EXPECT_FALSE(confirm(lines({3.0, 0.0}), Levels{{1}}, parameters));
  EXPECT_FALSE(confirm(lines({3.0, 0.0}), Levels{{}}, parameters));
}

TEST(Confirm, OneLevelIsEnoughForSignificantCornersOrIfThereIsOne) {
  FeatureDetectorParameters parameters;
  TwoLineCorner significant = lines({3.0, 0.0});
  significant.significance = 25.0;
  EXPECT_TRUE(confirm(significant, Levels{{2}}, parameters));
  parameters.single_level_significance = 26.0;
  EXPECT_FALSE(confirm(significant, Levels{{2}}, parameters));
  parameters.scale_levels = 1;
  EXPECT_TRUE(confirm(lines({3.0, 0.0}), Levels{{0}}, parameters));
}

TEST(Confirm, StopsAtTheLevelThatDecides) {
  int asked = 0;
  const auto peaks = [&](int level) {
    ++asked;
    return std::vector<ResponsePeak>{peakAt({3.0, 0.0}, level, 1.0)};
  };
  EXPECT_TRUE(confirm(lines({3.0, 0.0}), peaks, {}));
  EXPECT_EQ(asked, 2);
}

TEST(Confirm, PeaksElsewhereOrOfWeakCornersDoNotCount) {
  const FeatureDetectorParameters parameters;
  const auto confirmedBy = [&](auto&& change) {
    const auto peaks = [&](int level) {
      ResponsePeak peak = peakAt({3.0, 0.0}, level, 1.0);
      change(peak);
      return std::vector<ResponsePeak>{peak};
    };
    return confirm(lines({3.0, 0.0}), peaks, parameters).has_value();
  };
  EXPECT_TRUE(confirmedBy([](auto&) {}));
  EXPECT_FALSE(confirmedBy([](auto& peak) { peak.cornerness = 0.07; }));
  EXPECT_FALSE(confirmedBy([](auto& peak) { peak.column += 9; }));
  EXPECT_FALSE(confirmedBy([](auto& peak) { peak.point_m.x() += 0.3; }));
}

TEST(SuppressNeighbours, KeepsTheStrongestOfEachNeighbourhood) {
  const auto kept = suppressNeighbours(
      {corner(1.0, 0.0, 1.0), corner(1.2, 0.0, 3.0), corner(5.0, 0.0, 2.0)}, 0.3);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0].lines.position_m.x(), 1.2);
  EXPECT_EQ(kept[1].lines.position_m.x(), 5.0);
}

TEST(Select, KeepsTheMostSignificantOfThoseThatShareAPeak) {
  Corner a = corner(1.0, 0.0, 1.0);
  Corner b = a;
  b.lines.significance = 99.0;
  const auto kept = select({a, b}, {});
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].lines.significance, 99.0);
}

TEST(Select, LimitsTheNumberPerSurface) {
  FeatureDetectorParameters parameters;
  parameters.max_features = 3;
  std::vector<Corner> corners;
  for (int i = 0; i < 8; ++i) corners.push_back(corner(i, 0.0, 1.0 + i));
  const auto kept = select(corners, parameters);
  ASSERT_EQ(kept.size(), 3U);
  EXPECT_EQ(kept[0].lines.position_m.x(), 7.0);
}

TEST(Select, RelativeThresholdLetsAStrongCornerHideWeakerOnes) {
  FeatureDetectorParameters parameters;
  const std::vector<Corner> corners{corner(0.0, 0.0, 1.0), corner(2.0, 0.0, 0.85)};
  EXPECT_EQ(select(corners, parameters).size(), 2U);
  parameters.relative_threshold = true;
  EXPECT_EQ(select(corners, parameters).size(), 1U);
  parameters.feature_threshold = 0.8;
  EXPECT_EQ(select(corners, parameters).size(), 2U);
}

}  // namespace
}  // namespace ramscout_feature_detector
