// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/landmarks/local_constellation.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

#include "../tracking/rooms.hpp"

namespace ram_slam {
namespace {

FeatureList listOf(const std::vector<Eigen::Vector2d>& positions_m) {
  FeatureList list;
  list.stamp_ns = 1;
  for (const Eigen::Vector2d& position_m : positions_m) {
    Feature feature;
    feature.type = "pole";
    feature.position_m = position_m;
    feature.covariance_m2 = 1e-4 * Eigen::Matrix2d::Identity();
    list.features.push_back(feature);
  }
  return list;
}

TEST(LocalConstellation, PutsFeaturesOfSeveralReadingsTogether) {
  LocalConstellation local({}, {});
  const Eigen::Vector2d pole_m(5.0, 1.0);
  const Pose2 step{0.5, 0.0, 0.1};
  Pose2 start_from_base;
  local.add(listOf({pole_m}), {}, nullptr);
  EXPECT_TRUE(local.points().empty());  // seen once only
  for (int i = 0; i < 5; ++i) {
    start_from_base = start_from_base * step;
    local.add(listOf({start_from_base.inverse() * pole_m}), step, nullptr);
  }
  const Constellation points = local.points();
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR((points[0].position_m - start_from_base.inverse() * pole_m).norm(), 0.0, 1e-9);
}

TEST(LocalConstellation, KeepsTwoFeaturesOfOneReadingApart) {
  LocalConstellation local({}, {});
  for (int i = 0; i < 3; ++i) local.add(listOf({{5.0, 1.0}, {5.0, 1.15}}), {}, nullptr);
  EXPECT_EQ(local.points().size(), 2U);
}

TEST(LocalConstellation, ForgetsWhatIsFarBehind) {
  LocalConstellationParameters parameters;
  parameters.length = 3.0;
  LocalConstellation local(parameters, {});
  for (int i = 0; i < 2; ++i) local.add(listOf({{1.0, 1.0}}), {}, nullptr);
  for (int i = 0; i < 29; ++i) local.add({}, {0.1, 0.0, 0.0}, nullptr);
  EXPECT_EQ(local.points().size(), 1U);
  for (int i = 0; i < 3; ++i) local.add({}, {0.1, 0.0, 0.0}, nullptr);
  EXPECT_TRUE(local.points().empty());
}

TEST(LocalConstellation, FusesTwoSightingsAsAKalmanFilter) {
  LocalConstellationParameters parameters;
  parameters.min_sigma_m = 0.0;
  LocalConstellation local(parameters, {});
  local.add(listOf({{5.0, 1.0}}), {}, nullptr);
  local.add(listOf({{5.1, 1.0}}), {}, nullptr);
  const Constellation points = local.points();
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR(points[0].position_m.x(), 5.05, 1e-12);  // equal variances: the mean
  EXPECT_NEAR(points[0].covariance_m2(0, 0), 0.5e-4, 1e-12);
}

TEST(LocalConstellation, BlursPointsWithTheWayDriven) {
  LocalConstellationParameters parameters;
  parameters.min_sigma_m = 0.0;
  LocalConstellation local(parameters, {});
  for (int i = 0; i < 2; ++i) local.add(listOf({{5.0, 1.0}}), {}, nullptr);
  const double before_m2 = local.points()[0].covariance_m2(0, 0);
  local.add({}, {2.0, 0.0, 0.0}, nullptr);
  EXPECT_NEAR(local.points()[0].covariance_m2(0, 0), before_m2 + 0.02 * 0.02, 1e-12);
}

TEST(LocalConstellation, TurningCountsAsWay) {
  LocalConstellation local({}, {});
  local.add({}, {0.3, 0.4, -1.0}, nullptr);
  EXPECT_NEAR(local.distance_m(), 0.5 + 0.3, 1e-12);
  local.clear();
  EXPECT_EQ(local.distance_m(), 0.0);
}

TEST(LocalConstellation, KeepsAViewPerHalfMetre) {
  LocalConstellation local({}, {});
  const auto view = std::make_shared<const RoundView>(2.0);
  for (int i = 0; i < 21; ++i) local.add({}, {i == 0 ? 0.0 : 0.125, 0.0, 0.0}, view);
  const auto views = local.views();
  ASSERT_EQ(views.size(), 6U);
  EXPECT_NEAR(views.front().base_from_then.x_m, -2.5, 1e-12);
  EXPECT_NEAR(views.back().base_from_then.x_m, 0.0, 1e-12);
}

TEST(LocalConstellation, KeepsTheNewestPointsWhereThereAreTooMany) {
  LocalConstellationParameters parameters;
  parameters.max_points = 2;
  parameters.minimum_sightings = 1;
  LocalConstellation local(parameters, {});
  for (int i = 0; i < 4; ++i) local.add(listOf({{0.0, 3.0}}), {1.0, 0.0, 0.0}, nullptr);
  local.add({}, {}, nullptr);
  ASSERT_EQ(local.points().size(), 2U);
  EXPECT_NEAR(local.points()[0].position_m.x(), 0.0, 1e-12);
  EXPECT_NEAR(local.points()[1].position_m.x(), -1.0, 1e-12);
}

TEST(LocalConstellationParameters, RefuseNoLength) {
  LocalConstellationParameters parameters;
  parameters.length = 0.0;
  EXPECT_THROW(LocalConstellation(parameters, {}), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
