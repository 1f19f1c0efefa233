// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/loop_closer.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

#include "key_scan_drive.hpp"

namespace ram_slam {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Parameters with which a short drive closes a loop.
LoopCloserParameters shortLoops() {
  LoopCloserParameters parameters;
  parameters.search.min_path_m = 4.0;
  parameters.search.neighbour_count = 2;
  return parameters;
}

const KeyScans& drive() {
  static const KeyScans scans = scansAt(pillarRoom(), thereAndBack(30), thereAndBack(30));
  return scans;
}

void ignore(std::size_t, const Pose2&) {}

LoopCloser closedOnce() {
  LoopCloser loops(shortLoops(), {}, {});
  loops.searchIfDue(drive().keys(), ignore);
  return loops;
}

TEST(LoopCloser, ClosesALoopWithThePlaceWhereTheDriveBegan) {
  std::size_t closed_key = 0;
  Pose2 correction;
  LoopCloser loops(shortLoops(), {}, {});
  loops.searchIfDue(drive().keys(), [&](std::size_t key, const Pose2& by) {
    closed_key = key;
    correction = by;
  });
  ASSERT_THAT(loops.closures(), SizeIs(1));
  const LoopClosure& closure = loops.closures()[0];
  EXPECT_EQ(closed_key, drive().keys().size() - 1);
  EXPECT_EQ(closure.edge.to, closed_key);
  EXPECT_EQ(closure.new_stamp_ns, drive().keys().back().stamp_ns);
  EXPECT_EQ(closure.old_stamp_ns, drive().keys()[closure.edge.from].stamp_ns);
  EXPECT_EQ(closure.state, ClosureState::kAccepted);
  EXPECT_LT(correction.translation().norm(), 0.03);  // the poses are right already
  EXPECT_DOUBLE_EQ(closure.correction_m, correction.translation().norm());
}

TEST(LoopCloser, WaitsForSomePathBetweenTwoSearches) {
  LoopCloser loops = closedOnce();
  int count = 0;
  loops.searchIfDue(drive().keys(), [&](std::size_t, const Pose2&) { ++count; });
  EXPECT_EQ(count, 0);
}

TEST(LoopCloser, DoesNotCloseTheSameLoopTwice) {
  LoopCloserParameters parameters = shortLoops();
  parameters.search_distance_m = 1e-9;  // each key scan
  parameters.accepted_reach = 1000;
  LoopCloser loops(parameters, {}, {});
  EXPECT_TRUE(loops.sweep(drive().keys(), ignore));
  EXPECT_THAT(loops.closures(), SizeIs(1));
  EXPECT_FALSE(loops.sweep(drive().keys(), ignore));
}

TEST(LoopCloser, DoesNotFindARefusedClosureAgain) {
  LoopCloser loops = closedOnce();
  loops.refuse(0);
  EXPECT_EQ(loops.closures()[0].state, ClosureState::kRefused);
  EXPECT_THAT(loops.acceptedEdges(), IsEmpty());
  EXPECT_FALSE(loops.sweep(drive().keys(), ignore));
  loops.accept(0);
  EXPECT_THAT(loops.acceptedEdges(), SizeIs(1));
  EXPECT_THROW(loops.refuse(1), std::out_of_range);
  EXPECT_THROW(loops.accept(1), std::out_of_range);
}

TEST(LoopCloser, OutvotesClosuresThatAreNotBelieved) {
  LoopCloser loops = closedOnce();
  loops.judge({0.6}, 0.5);
  EXPECT_EQ(loops.closures()[0].state, ClosureState::kAccepted);
  EXPECT_FALSE(loops.candidateEdges()[0].was_outvoted);
  loops.judge({0.4}, 0.5);
  EXPECT_EQ(loops.closures()[0].state, ClosureState::kOutvoted);
  EXPECT_THAT(loops.acceptedEdges(), IsEmpty());
  ASSERT_THAT(loops.candidateEdges(), SizeIs(1));
  EXPECT_TRUE(loops.candidateEdges()[0].was_outvoted);
}

TEST(LoopCloser, AcceptsAnOutvotedClosureThatIsBelievedLater) {
  LoopCloser loops = closedOnce();
  loops.judge({0.4}, 0.5);
  loops.judge({0.6}, 0.5);
  EXPECT_THAT(loops.acceptedEdges(), SizeIs(1));
}

TEST(LoopCloser, DoesNotFindAnOutvotedClosureAgain) {
  LoopCloser loops = closedOnce();
  loops.judge({0.4}, 0.5);
  EXPECT_FALSE(loops.sweep(drive().keys(), ignore));
  EXPECT_THAT(loops.closures(), SizeIs(1));
}

TEST(LoopCloser, FindsNothingWithinTheLeastPath) {
  LoopCloserParameters parameters = shortLoops();
  parameters.search.min_path_m = 100.0;
  LoopCloser loops(parameters, {}, {});
  loops.searchIfDue(drive().keys(), ignore);
  EXPECT_FALSE(loops.sweep(drive().keys(), ignore));
  EXPECT_THAT(loops.closures(), IsEmpty());
}

TEST(LoopCloser, AddsTheDeviationOfClosuresToWhatTheScansLeave) {
  LoopCloserParameters parameters = shortLoops();
  parameters.closure_deviation_m = 0.5;
  parameters.closure_deviation_rad = 0.2;
  LoopCloser loops(parameters, {}, {});
  loops.searchIfDue(drive().keys(), ignore);
  ASSERT_THAT(loops.closures(), SizeIs(1));
  // Walls hold the pose to millimetres: what is left is the deviation of closures.
  const Eigen::Matrix3d covariance = loops.closures()[0].edge.information.inverse();
  EXPECT_NEAR(covariance(0, 0), 0.25, 0.001);
  EXPECT_NEAR(covariance(2, 2), 0.04, 0.001);
}

TEST(LoopCloser, CorrectionIsHowFarTheLaterKeyScanHasToMove) {
  std::vector<KeyScan> keys = drive().keys();
  const Pose2 drift{0.2, -0.15, 0.02};
  for (KeyScan& key : keys) {
    if (key.path_m > 3.0) key.map_from_laser = key.map_from_laser * drift;
  }
  Pose2 correction;
  LoopCloser loops(shortLoops(), {}, {});
  loops.searchIfDue(keys, [&](std::size_t, const Pose2& by) { correction = by; });
  const Pose2 wanted = drift.inverse();
  EXPECT_NEAR(correction.x_m, wanted.x_m, 0.02);
  EXPECT_NEAR(correction.y_m, wanted.y_m, 0.02);
  EXPECT_NEAR(correction.yaw_rad, wanted.yaw_rad, 0.005);
}

TEST(LoopCloser, TakesFeaturesBeforeThereIsAnyScan) {
  LoopCloser loops(shortLoops(), {}, {});
  FeatureList list;
  list.stamp_ns = 1;
  loops.addFeatures(list);
  loops.useFeatures({});
  loops.useFeatures(drive().keys());  // the list is older than the newest key scan
  loops.searchIfDue(drive().keys(), ignore);
  EXPECT_THAT(loops.closures(), SizeIs(1));
}

}  // namespace
}  // namespace ram_slam
