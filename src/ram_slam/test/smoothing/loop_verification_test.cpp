// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/loop_verification.hpp"

#include <gmock/gmock.h>

#include "key_scan_drive.hpp"

namespace ram_slam {
namespace {

constexpr int kSteps = 30;

/// There and back in a place: the first key scan is the candidate, the last one the newest.
struct ThereAndBack {
  std::vector<KeyScan> keys;
  LoopQuery query;
  LoopSearchParameters parameters;

  explicit ThereAndBack(const Walls& walls) {
    const std::vector<Pose2> truth = thereAndBack(kSteps);
    keys = scansAt(walls, truth, truth).keys();
    parameters.neighbour_count = 2;
    query.candidate = 1;
    query.newest = keys.size() - 2;
    query.map_from_laser_guess = keys[query.newest].map_from_laser;
    query.window = searchWindow(0.0, parameters);
  }

  std::optional<LoopMatch> verify() const { return verifyLoop(keys, query, {}, parameters); }
};

/// A corridor without anything that fixes where along it the robot is.
Walls corridor() {
  return {{{-100.0, 1.0}, {100.0, 1.0}}, {{-100.0, -1.0}, {100.0, -1.0}}};
}

TEST(VerifyLoop, FindsTheRelativePoseFromAGuessThatIsOff) {
  ThereAndBack drive(pillarRoom());
  drive.query.map_from_laser_guess = drive.query.map_from_laser_guess * Pose2{0.3, -0.25, 0.06};
  const auto match = drive.verify();
  ASSERT_TRUE(match);
  const Pose2 truth =
      relativePose(drive.keys[drive.query.candidate], drive.keys[drive.query.newest]);
  EXPECT_NEAR(match->edge.from_from_to.x_m, truth.x_m, 0.01);
  EXPECT_NEAR(match->edge.from_from_to.y_m, truth.y_m, 0.01);
  EXPECT_NEAR(match->edge.from_from_to.yaw_rad, truth.yaw_rad, 0.005);
  EXPECT_EQ(match->edge.from, drive.query.candidate);
  EXPECT_EQ(match->edge.to, drive.query.newest);
  EXPECT_TRUE(match->edge.may_be_false);
  EXPECT_FALSE(match->is_ambiguous);
}

TEST(VerifyLoop, HoldsNothingAlongACorridor) {
  const auto match = ThereAndBack(corridor()).verify();
  ASSERT_TRUE(match);
  EXPECT_TRUE(match->is_ambiguous);
  EXPECT_LT(match->edge.information(0, 0), 1e-3 * match->edge.information(1, 1));
}

TEST(VerifyLoop, FindsNothingWhereTheNewestScanIsOfAnotherPlace) {
  ThereAndBack drive(pillarRoom());
  const Walls other = rectangle(-0.7, -9.0, 0.9, 0.8);
  const std::vector<Pose2> poses = thereAndBack(0);
  drive.keys[drive.query.newest].surfaces = scansAt(other, poses, poses).keys()[0].surfaces;
  EXPECT_FALSE(drive.verify());
}

TEST(VerifyLoop, FindsNothingBelowTheLeastScore) {
  ThereAndBack drive(pillarRoom());
  drive.parameters.min_score = 1.0;
  EXPECT_FALSE(drive.verify());
}

TEST(VerifyLoop, RecognisesAPlaceWhoseWallsAreFarAway) {
  // Nothing is within the range that suffices in rooms.
  const Walls square = rectangle(-20.0, -25.0, 24.0, 22.0) + rectangle(14.0, 15.0, 18.0, 17.0) +
                       rectangle(-17.0, -20.0, -14.0, -18.0);
  ThereAndBack drive(square);
  drive.query.map_from_laser_guess = drive.query.map_from_laser_guess * Pose2{0.5, -0.4, 0.08};
  const auto match = drive.verify();
  ASSERT_TRUE(match);
  const Pose2 truth =
      relativePose(drive.keys[drive.query.candidate], drive.keys[drive.query.newest]);
  EXPECT_NEAR(match->edge.from_from_to.x_m, truth.x_m, 0.02);
  EXPECT_NEAR(match->edge.from_from_to.y_m, truth.y_m, 0.02);
  EXPECT_NEAR(match->edge.from_from_to.yaw_rad, truth.yaw_rad, 0.005);
}

TEST(VerifyLoop, PutsMoreKeyScansTogetherWhereTheySeeLittle) {
  // One beam in four beside the two key scans: with few neighbours there are too few points.
  ThereAndBack drive(pillarRoom());
  for (std::size_t i = 0; i < drive.keys.size(); ++i) {
    if (i == drive.query.candidate || i == drive.query.newest) continue;
    SurfaceScan& surfaces = drive.keys[i].surfaces;
    SurfaceScan few = surfaces;
    few.points.clear();
    for (std::size_t beam = 0; beam < surfaces.point_of_beam.size(); ++beam) {
      few.point_of_beam[beam] = static_cast<std::int32_t>(few.points.size());
      if (beam % 4 == 0)
        few.points.push_back(
            surfaces.points.at(static_cast<std::size_t>(surfaces.point_of_beam[beam])));
    }
    surfaces = few;
  }
  drive.parameters.min_points = drive.parameters.dense.query_point_count = 800;
  drive.parameters.max_neighbour_count = drive.parameters.neighbour_count;
  EXPECT_FALSE(drive.verify());
  drive.parameters.max_neighbour_count = 10;
  EXPECT_TRUE(drive.verify());
}

TEST(VerifyLoop, FindsNothingFromTooFewPoints) {
  ThereAndBack drive(pillarRoom());
  ASSERT_TRUE(drive.verify());
  drive.parameters.min_points = 100'000;
  EXPECT_FALSE(drive.verify());
}

TEST(VerifyLoop, NeedsPassagesThatDoNotOverlap) {
  ThereAndBack drive(pillarRoom());
  drive.query.candidate = drive.query.newest - 2;
  EXPECT_FALSE(drive.verify());
}

}  // namespace
}  // namespace ram_slam
