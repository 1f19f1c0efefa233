// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/pose_monitor.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

#include "rooms.hpp"

namespace ram_slam {
namespace {

using Finding = PoseMonitor::Finding;

/// A robot that stands in a room whose map has views, and no landmarks.
class Monitored : public testing::Test {
protected:
  /// One reading every 0.1 s of a robot that takes itself for being `believed`.
  Finding check(const Pose2& truth, const Pose2& believed, PoseSource source) {
    now_ns_ += 100'000'000;
    now_ = {now_ns_, {}, viewIn(room_, truth)};
    FeatureList list;
    list.stamp_ns = now_ns_;
    const Finding finding = monitor_.check({list, now_.view.get(), particle_, registry_},
                                           {now_, believed, 12.0, source}, map_);
    if (finding == Finding::kConsistent) monitor_.add(now_);
    return finding;
  }

  /// Readings until something is found, at most so many.
  int countUntilFound(const Pose2& truth, const Pose2& believed, PoseSource source, int most) {
    for (int i = 0; i < most; ++i)
      if (check(truth, believed, source) != Finding::kConsistent) return i;
    return most;
  }

  const Walls room_ = oddRoom();
  const Pose2 here_{6.2, 1.5, 0.0};
  const Pose2 wrong_{9.2, 1.5, 0.0};
  MapViews map_ = viewsOf(room_);
  Particle particle_;
  LandmarkRegistry registry_;
  TrackedView now_;
  std::int64_t now_ns_ = 1'000'000'000;
  PoseMonitor monitor_{PoseMonitorParameters{}, MapViewsParameters{}, 2.0};
};

TEST_F(Monitored, IsConsistentWhereThePoseIsTrue) {
  for (const PoseSource source : {PoseSource::kTracking, PoseSource::kOdometry, PoseSource::kMap})
    EXPECT_EQ(countUntilFound(here_, here_, source, 30), 30);
  EXPECT_EQ(monitor_.inconsistency_s(), 0.0);
}

TEST_F(Monitored, IsContradictedSoonAtAPlaceThatWasFoundNewly) {
  const int count = countUntilFound(here_, wrong_, PoseSource::kMap, 100);
  EXPECT_GT(count, 1);
  EXPECT_LT(count, 30);
  EXPECT_EQ(monitor_.inconsistency_s(), 0.0);  // it begins again
}

TEST_F(Monitored, DriftsWithOdometryWhoseContradictionNeedsMoreEvidence) {
  const int from_map = countUntilFound(here_, wrong_, PoseSource::kMap, 100);
  monitor_.clear();
  const int tracked = countUntilFound(here_, wrong_, PoseSource::kTracking, 100);
  monitor_.clear();
  const int from_odometry = countUntilFound(here_, wrong_, PoseSource::kOdometry, 100);
  EXPECT_GT(tracked, 2 * from_map);
  EXPECT_EQ(from_odometry, tracked);
}

TEST_F(Monitored, AddsUpInconsistencyAndLetsItFade) {
  check(here_, wrong_, PoseSource::kMap);
  check(here_, wrong_, PoseSource::kMap);
  const double inconsistency_s = monitor_.inconsistency_s();
  EXPECT_GT(inconsistency_s, 0.0);
  check(here_, here_, PoseSource::kMap);
  check(here_, here_, PoseSource::kMap);
  EXPECT_LT(monitor_.inconsistency_s(), inconsistency_s);
  monitor_.clearMapEvidence();
  EXPECT_EQ(monitor_.inconsistency_s(), 0.0);
}

TEST_F(Monitored, FindsAJumpWithoutASlip) {
  countUntilFound(here_, here_, PoseSource::kTracking, 12);
  const int count = countUntilFound({11.0, 1.8, 3.0}, here_, PoseSource::kTracking, 10);
  EXPECT_LE(count, 3);
  EXPECT_FALSE(monitor_.slip(now_));
}

TEST_F(Monitored, MeasuresASlipOfTheOdometry) {
  countUntilFound(here_, here_, PoseSource::kTracking, 12);
  const Pose2 slip{0.15, -0.1, 0.1};
  check(here_ * slip, here_, PoseSource::kTracking);
  const auto measured = monitor_.slip(now_);
  ASSERT_TRUE(measured);
  EXPECT_NEAR(measured->x_m, slip.x_m, 0.06);
  EXPECT_NEAR(measured->y_m, slip.y_m, 0.06);
  EXPECT_NEAR(measured->yaw_rad, slip.yaw_rad, 0.03);
}

TEST_F(Monitored, KeepsTheOldestViewUntilCleared) {
  EXPECT_FALSE(monitor_.oldestView());
  countUntilFound(here_, here_, PoseSource::kTracking, 3);
  ASSERT_TRUE(monitor_.oldestView());
  EXPECT_EQ(monitor_.oldestView()->stamp_ns, 1'100'000'000);
  monitor_.clearMapEvidence();
  EXPECT_TRUE(monitor_.oldestView());  // the odometry goes on
  monitor_.clear();
  EXPECT_FALSE(monitor_.oldestView());
}

TEST_F(Monitored, FindsNothingWithoutViews) {
  FeatureList list;
  list.stamp_ns = 2'000'000'000;
  const TrackedView blind{list.stamp_ns, {}, nullptr};
  EXPECT_EQ(monitor_.check({list, nullptr, particle_, registry_},
                           {blind, wrong_, 0.0, PoseSource::kMap}, map_),
            Finding::kConsistent);
  EXPECT_FALSE(monitor_.slip(blind));
}

TEST(PoseMonitorParameters, RefuseAThresholdOfZero) {
  PoseMonitorParameters parameters;
  parameters.contradiction_threshold = 0.0;
  EXPECT_THROW(PoseMonitor(parameters, {}, 2.0), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
