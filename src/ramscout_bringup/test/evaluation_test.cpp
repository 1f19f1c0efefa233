// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>

namespace ramscout_bringup {
namespace {

using ram_slam::Pose2;

constexpr std::int64_t kSecond = 1000000000;

/// 101 poses along a circle of radius 5 m, one per second.
Trajectory circle() {
  Trajectory trajectory;
  for (int i = 0; i <= 100; ++i) {
    const double angle = 0.0628 * i;
    trajectory.push_back(
        {kSecond * (i + 1),
         {5.0 * std::cos(angle), 5.0 * std::sin(angle), ram_slam::wrapAngle(angle + M_PI_2)}});
  }
  return trajectory;
}

TEST(Statistics, OfThreeFourFive) {
  const ErrorStatistics statistics = statisticsOf({5.0, 3.0, 4.0});
  EXPECT_EQ(statistics.count, 3u);
  EXPECT_DOUBLE_EQ(statistics.mean, 4.0);
  EXPECT_DOUBLE_EQ(statistics.standard_deviation, 1.0);
  EXPECT_DOUBLE_EQ(statistics.rms, std::sqrt(50.0 / 3.0));
  EXPECT_DOUBLE_EQ(statistics.median, 4.0);
  EXPECT_DOUBLE_EQ(statistics.max, 5.0);
  EXPECT_EQ(statisticsOf({}).count, 0u);
}

TEST(CompareWithTruth, ARigidMotionOfTheWholeTrajectoryIsNoError) {
  const Trajectory truth = circle();
  const Pose2 truth_from_map{3.0, -7.0, 2.5};
  Trajectory estimate = truth;
  for (auto& pose : estimate) pose.pose = truth_from_map.inverse() * pose.pose;
  const TruthComparison comparison = compareWithTruth(estimate, truth);
  EXPECT_LT(comparison.position_m.max, 1e-9);
  EXPECT_LT(comparison.yaw_rad.max, 1e-9);
  EXPECT_NEAR(comparison.truth_from_map.x_m, 3.0, 1e-9);
}

TEST(TruthInMap, LiesOnTheEstimateAndIsEmptyWithoutCommonStamps) {
  const Trajectory truth = circle();
  const Pose2 map_from_truth{3.0, -7.0, 2.5};
  Trajectory estimate = truth;
  for (auto& pose : estimate) pose.pose = map_from_truth * pose.pose;
  const Trajectory aligned = truthInMap(estimate, truth);
  ASSERT_EQ(aligned.size(), truth.size());
  for (std::size_t i = 0; i < aligned.size(); ++i) {
    EXPECT_NEAR(aligned[i].pose.x_m, estimate[i].pose.x_m, 1e-9);
    EXPECT_NEAR(aligned[i].pose.y_m, estimate[i].pose.y_m, 1e-9);
  }
  EXPECT_TRUE(truthInMap({}, truth).empty());
  EXPECT_TRUE(truthInMap(estimate, {}).empty());
}

TEST(CompareWithTruth, AlternatingOffsetsAreFoundAsTheyAre) {
  Trajectory truth;
  Trajectory estimate;
  for (int i = 0; i < 100; ++i) {
    truth.push_back({kSecond * (i + 1), {0.1 * i, 0.0, 0.0}});
    const double side = (i % 4 == 0 || i % 4 == 3) ? 1.0 : -1.0;
    estimate.push_back({kSecond * (i + 1), {0.1 * i, 0.02 * side, 0.01 * side}});
  }
  const TruthComparison comparison = compareWithTruth(estimate, truth);
  EXPECT_NEAR(comparison.position_m.rms, 0.02, 1e-5);
  EXPECT_NEAR(comparison.yaw_rad.rms, 0.01, 1e-5);
}

TEST(CompareWithTruth, TruthIsInterpolatedAndStampsOutsideItAreLeftOut) {
  const Trajectory truth{{kSecond, {0.0, 0.0, 0.0}}, {2 * kSecond, {1.0, 0.0, 0.0}}};
  const Trajectory estimate{{0, {-9.0, 0.0, 0.0}},
                            {kSecond, {0.0, 0.0, 0.0}},
                            {kSecond * 3 / 2, {0.5, 0.0, 0.0}},
                            {3 * kSecond, {9.0, 0.0, 0.0}}};
  const TruthComparison comparison = compareWithTruth(estimate, truth);
  EXPECT_EQ(comparison.position_m.count, 2u);
  EXPECT_LT(comparison.position_m.max, 1e-12);
  EXPECT_THROW(compareWithTruth({estimate.front()}, truth), std::invalid_argument);
}

TEST(CompareWithTruth, TruthIsNotInterpolatedOverAGap) {
  Trajectory truth;
  for (const std::int64_t i : {0, 1, 2, 3, 30, 31, 32})
    truth.push_back({i * kSecond, {static_cast<double>(i), 0.0, 0.0}});
  Trajectory estimate = truth;
  estimate.push_back({15 * kSecond, {15.0, 7.0, 0.0}});  // where the robot was is not known
  const TruthComparison comparison = compareWithTruth(estimate, truth);
  EXPECT_EQ(comparison.without_truth_count, 1u);
  EXPECT_LT(comparison.position_m.max, 1e-12);
}

TEST(RelativeErrors, AScaleErrorIsItsShareOfTheLength) {
  Trajectory truth;
  Trajectory estimate;
  for (int i = 0; i <= 100; ++i) {
    truth.push_back({kSecond * (i + 1), {0.1 * i, 0.0, 0.0}});
    estimate.push_back({kSecond * (i + 1), {0.103 * i, 0.0, 0.0}});
  }
  const auto rows = relativeErrors(estimate, truth, {5.0}, {10.0});
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].interval, "5 m");
  EXPECT_EQ(rows[1].interval, "10 s");
  EXPECT_NEAR(rows[0].position_m.mean, 0.15, 4e-3);
  EXPECT_NEAR(rows[1].position_m.mean, 0.03, 1e-9);
  EXPECT_EQ(rows[1].position_m.count, 91u);
}

TEST(PathLength, OfTwoSides) {
  EXPECT_DOUBLE_EQ(pathLength({{0, {0, 0, 0}}, {1, {3, 0, 0}}, {2, {3, 4, 0}}}), 7.0);
}

TEST(CompareWithRelations, ErrorsOfOneRelationByHand) {
  // The estimate turns by 90 degrees and moves 2 m ahead; the reference states 2.03 m ahead, 0.04 m
  // to the left, 89 deg.
  const Trajectory estimate{{kSecond, {1.0, 1.0, 0.0}}, {50 * kSecond, {3.0, 1.0, M_PI_2}}};
  const double reference_yaw_rad = 89.0 * M_PI / 180.0;
  const Relation relation{kSecond, 50 * kSecond, {2.03, 0.04, reference_yaw_rad}};
  const RelationComparison comparison = compareWithRelations(estimate, {relation}, {});
  EXPECT_NEAR(comparison.all.position_m.mean, 0.05, 1e-12);
  EXPECT_NEAR(comparison.all.yaw_rad.mean, M_PI / 180.0, 1e-12);
  // e ref^-1 has translation t_e - R(yaw_e - yaw_ref) t_ref.
  const double turn_rad = M_PI_2 - reference_yaw_rad;
  const double x = 2.0 - (std::cos(turn_rad) * 2.03 - std::sin(turn_rad) * 0.04);
  const double y = 0.0 - (std::sin(turn_rad) * 2.03 + std::cos(turn_rad) * 0.04);
  EXPECT_NEAR(comparison.all.position_cartographer_m.mean, std::hypot(x, y), 1e-12);
  EXPECT_EQ(comparison.distant.position_m.count, 1u);
}

TEST(CompareWithRelations, AStampFarFromAnyPoseIsBridgedByOdometry) {
  const Trajectory estimate{{kSecond, {0.0, 0.0, M_PI_2}}, {2 * kSecond, {0.0, 1.0, M_PI_2}}};
  const Trajectory odometry{{2 * kSecond, {5.0, 5.0, 0.0}}, {3 * kSecond, {6.5, 5.0, 0.0}}};
  const Relation relation{kSecond, 3 * kSecond, {2.5, 0.0, 0.0}};
  const RelationComparison bridged = compareWithRelations(estimate, {relation}, odometry);
  EXPECT_NEAR(bridged.all.position_m.mean, 0.0, 1e-12);
  EXPECT_EQ(bridged.moved_count, 1u);
  const RelationComparison nearest_only = compareWithRelations(estimate, {relation}, {});
  EXPECT_NEAR(nearest_only.all.position_m.mean, 1.5, 1e-12);
  EXPECT_EQ(nearest_only.far_count, 1u);
  EXPECT_NEAR(nearest_only.max_stamp_gap_s, 1.0, 1e-9);
}

TEST(CompareWithRelations, TheirOrderDoesNotMatterButStampsDo) {
  const Trajectory truth = circle();
  std::vector<Relation> relations;
  for (std::size_t i = 0; i + 7 < truth.size(); ++i) {
    relations.push_back({truth[i].stamp_ns, truth[i + 7].stamp_ns,
                         truth[i].pose.inverse() * truth[i + 7].pose *
                             Pose2{0.01 * static_cast<double>(i % 3), 0, 0}});
  }
  const double mean_m = compareWithRelations(truth, relations, {}).all.position_m.mean;
  EXPECT_NEAR(mean_m, 0.01, 1e-3);
  std::reverse(relations.begin(), relations.end());
  EXPECT_NEAR(compareWithRelations(truth, relations, {}).all.position_m.mean, mean_m, 1e-12);
  // A circle is the same a second later, but not when it is driven at another speed.
  Trajectory late = truth;
  for (std::size_t i = 0; i < late.size(); ++i)
    late[i].stamp_ns += kSecond + static_cast<std::int64_t>(i * i) * (kSecond / 200);
  EXPECT_GT(compareWithRelations(late, relations, {}).all.position_m.mean, 10.0 * mean_m);
}

TEST(ReadRelations, ReadsLinesAndNamesBadOnes) {
  const std::string path = testing::TempDir() + "evaluation_test.relations";
  std::ofstream(path) << "# comment\n1.5 2.5 1 2 0 0 0 0.5\n";
  const auto relations = readRelations(path);
  ASSERT_EQ(relations.size(), 1u);
  EXPECT_EQ(relations[0].second_ns, 2500000000);
  EXPECT_EQ(relations[0].first_from_second.yaw_rad, 0.5);
  std::ofstream(path) << "1.5 2.5 1 2 0 0 0\n";
  EXPECT_THROW(readRelations(path), std::runtime_error);
  std::remove(path.c_str());
}

TEST(CompareWithTruth, NoOtherAlignmentHasASmallerError) {
  // A bent estimate; the alignment found is compared with its neighbours in x, y and yaw.
  const Trajectory truth = circle();
  Trajectory estimate = truth;
  for (std::size_t i = 0; i < estimate.size(); ++i)
    estimate[i].pose.x_m += 0.01 * static_cast<double>(i % 13) - 0.002 * static_cast<double>(i);
  const TruthComparison best = compareWithTruth(estimate, truth);
  const auto rmsOf = [&](const Pose2& truth_from_map) {
    double squares_m2 = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i)
      squares_m2 += (truth_from_map * estimate[i].pose.translation() - truth[i].pose.translation())
                        .squaredNorm();
    return std::sqrt(squares_m2 / static_cast<double>(truth.size()));
  };
  EXPECT_NEAR(rmsOf(best.truth_from_map), best.position_m.rms, 1e-12);
  for (const double x : {-1e-3, 0.0, 1e-3}) {
    for (const double y : {-1e-3, 0.0, 1e-3}) {
      for (const double yaw : {-1e-3, 0.0, 1e-3}) {
        Pose2 other = best.truth_from_map;
        other.x_m += x;
        other.y_m += y;
        other.yaw_rad += yaw;
        EXPECT_GE(rmsOf(other), best.position_m.rms - 1e-12);
      }
    }
  }
}

TEST(CompareWithTruth, PosesInAGapOfTheTruthAreLeftOutAndCounted) {
  Trajectory truth;
  Trajectory estimate;
  for (int i = 0; i < 60; ++i) {
    const ram_slam::StampedPose2 pose{kSecond + i * (kSecond / 10), {0.1 * i, 0.0, 0.0}};
    if (i < 20 || i >= 40) truth.push_back(pose);
    estimate.push_back({pose.stamp_ns + 1, pose.pose});
  }
  const TruthComparison comparison = compareWithTruth(estimate, truth);
  EXPECT_EQ(comparison.without_truth_count, 22u);  // 19 to 39, and the one behind the end
  EXPECT_LT(comparison.position_m.max, 1e-6);
}

TEST(RelativeErrors, IntervalsLongerThanTheDriveHaveNoErrors) {
  const auto rows = relativeErrors(circle(), circle(), {1000.0}, {1000.0, 0.5});
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].position_m.count, 0u);
  EXPECT_EQ(rows[1].position_m.count, 0u);
  EXPECT_EQ(rows[2].interval, "0.5 s");
  EXPECT_EQ(rows[2].position_m.count, 100u);
}

TEST(CompareWithRelations, NothingToCompareIsRefused) {
  EXPECT_THROW(compareWithRelations({}, {Relation{}}, {}), std::invalid_argument);
  EXPECT_THROW(compareWithRelations(circle(), {}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace ramscout_bringup
