// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/sensing/field_of_view.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

constexpr int kBeams = 720;

/// A full turn in a rectangular room around the origin, seen from a pose in it.
LaserScan roomScan(double half_length_m, double half_width_m, const Pose2& room_from_laser) {
  LaserScan scan;
  scan.stamp_ns = 1;
  scan.angle_min_rad = -M_PI;
  scan.angle_increment_rad = 2.0 * M_PI / kBeams;
  scan.range_min_m = 0.1F;
  scan.range_max_m = 30.0F;
  for (int i = 0; i < kBeams; ++i) {
    const double angle_rad = room_from_laser.yaw_rad + scan.bearing_rad(i);
    const double dx = std::cos(angle_rad);
    const double dy = std::sin(angle_rad);
    const double to_x =
        (dx > 0 ? half_length_m - room_from_laser.x_m : half_length_m + room_from_laser.x_m) /
        std::abs(dx);
    const double to_y =
        (dy > 0 ? half_width_m - room_from_laser.y_m : half_width_m + room_from_laser.y_m) /
        std::abs(dy);
    scan.ranges_m.push_back(static_cast<float>(std::min(to_x, to_y)));
  }
  return scan;
}

TEST(LaserView, DistinguishesHiddenVisibleAndEmpty) {
  const LaserView view(roomScan(5.0, 3.0, {}), {});
  EXPECT_EQ(view.look({4.95, 0.0}), Sight::kVisible);
  EXPECT_EQ(view.look({3.0, 0.0}), Sight::kEmpty);
  EXPECT_EQ(view.look({6.0, 0.0}), Sight::kHidden);
  EXPECT_EQ(view.look({0.05, 0.0}), Sight::kHidden);  // nearer than the sensor sees
  EXPECT_EQ(view.look({29.8, 0.0}), Sight::kHidden);  // at the end of its range
}

TEST(LaserView, HidesPointsBehindInvalidReadings) {
  LaserScan scan = roomScan(5.0, 3.0, {});
  scan.ranges_m[kBeams / 2] = std::numeric_limits<float>::quiet_NaN();
  const LaserView view(scan, {});
  EXPECT_EQ(view.look({3.0, 0.0}), Sight::kHidden);
}

TEST(LaserView, KnowsWhereItIsMounted) {
  const Pose2 base_from_laser{0.3, 0.0, 0.5};
  const LaserView view(roomScan(5.0, 3.0, base_from_laser), base_from_laser);
  EXPECT_EQ(view.look({4.95, 0.0}), Sight::kVisible);
  for (const Eigen::Vector2d& point_m : view.surface_m()) {
    EXPECT_NEAR(std::max(std::abs(point_m.x()) / 5.0, std::abs(point_m.y()) / 3.0), 1.0, 1e-4);
  }
}

TEST(Discontinuity, IsNoneOfTwoViewsOfOnePlace) {
  const Pose2 later{0.4, 0.1, 0.3};
  const LaserView before(roomScan(5.0, 3.0, {}), {});
  const LaserView now(roomScan(5.0, 3.0, later), {});
  const auto share = discontinuity(before, now, later);
  ASSERT_TRUE(share);
  EXPECT_LT(*share, 0.01);
}

TEST(Discontinuity, IsLargeOfViewsOfTwoPlaces) {
  const LaserView before(roomScan(5.0, 3.0, {}), {});
  const LaserView now(roomScan(2.0, 6.0, {}), {});
  const auto share = discontinuity(before, now, {});
  ASSERT_TRUE(share);
  EXPECT_GT(*share, 0.3);
}

TEST(Discontinuity, IsUnknownIfTheViewsHaveTooLittleInCommon) {
  LaserScan blind = roomScan(5.0, 3.0, {});
  for (float& range_m : blind.ranges_m) range_m = std::numeric_limits<float>::quiet_NaN();
  const LaserView nothing(blind, {});
  EXPECT_FALSE(discontinuity(nothing, LaserView(roomScan(5.0, 3.0, {}), {}), {}));
}

}  // namespace
}  // namespace ram_slam
