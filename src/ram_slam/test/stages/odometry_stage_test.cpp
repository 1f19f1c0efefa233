// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/odometry_stage.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "../scan_matching/walls.hpp"
#include "room.hpp"

namespace ram_slam {
namespace {

constexpr std::int64_t kPeriodNs = 100'000'000;
constexpr double kStepM = 0.05;  // per period, along x

/// The robot starts in the middle of a room.
MountedScan scanAt(std::int64_t i) {
  return scanInRoom((i + 10) * kPeriodNs, kStepM * static_cast<double>(i));
}

/// Wheels that go ten per cent too far.
StampedPose2 wheelsAt(std::int64_t i) {
  return {(i + 10) * kPeriodNs, {1.1 * kStepM * static_cast<double>(i), 0.0, 0.0}};
}

TEST(OdometryStage, ScansCorrectTheWheels) {
  OdometryStage stage{LaserOdometryParameters{}};
  std::optional<OdometryStep> last;
  for (std::int64_t i = 0; i < 20; ++i) {
    stage.add(scanAt(i));
    EXPECT_FALSE(stage.next());
    EXPECT_TRUE(stage.addWheels(wheelsAt(i)));
    last = stage.next();
    ASSERT_TRUE(last);
    EXPECT_EQ(last->scan.scan.stamp_ns, wheelsAt(i).stamp_ns);
  }
  EXPECT_NEAR(last->estimate.odom_from_base.pose.x_m, 19 * kStepM, 0.01);
  EXPECT_EQ(stage.drops().total(), 0u);
}

TEST(OdometryStage, PassesTheWheelsAsTheyAreIfAskedTo) {
  OdometryStage stage(LaserOdometryParameters{}, false);
  for (std::int64_t i = 0; i < 3; ++i) {
    stage.add(scanAt(i));
    stage.addWheels(wheelsAt(i));
    EXPECT_EQ(stage.next()->estimate.odom_from_base.pose.x_m, wheelsAt(i).pose.x_m);
  }
}

TEST(OdometryStage, WithoutWheelsScansAloneGiveTheMotion) {
  LaserOdometryParameters parameters;
  parameters.use_wheels = false;
  OdometryStage stage(parameters);
  std::optional<OdometryStep> last;
  for (std::int64_t i = 0; i < 20; ++i) {
    stage.add(scanAt(i));
    last = stage.next();
    ASSERT_TRUE(last);
  }
  EXPECT_NEAR(last->estimate.odom_from_base.pose.x_m, 19 * kStepM, 0.01);
  EXPECT_FALSE(stage.hasWheels());
}

TEST(OdometryStage, UnusableScansAreDroppedAndTheNextOnesUsed) {
  OdometryStage stage{LaserOdometryParameters{}};
  stage.addWheels(wheelsAt(0));
  stage.addWheels(wheelsAt(2));
  stage.add(scanAt(0));
  MountedScan empty = scanAt(1);
  empty.scan.ranges_m.clear();
  stage.add(empty);
  stage.add(scanAt(2));
  EXPECT_TRUE(stage.next());
  EXPECT_EQ(stage.next()->scan.scan.stamp_ns, scanAt(2).scan.stamp_ns);
  ASSERT_EQ(stage.drops().total(), 1u);
  EXPECT_EQ(stage.drops().newest().reason, DropReason::kInvalidScan);
}

TEST(OdometryStage, BeginsAgainWhenTheClockIsSetBack) {
  OdometryStage stage{LaserOdometryParameters{}};
  for (std::int64_t i = 30; i < 35; ++i) {
    stage.add(scanAt(i));
    stage.addWheels(wheelsAt(i));
    ASSERT_TRUE(stage.next());
  }
  stage.add(scanAt(0));
  stage.addWheels(wheelsAt(0));
  const auto first = stage.next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->estimate.odom_from_base.pose.x_m, 0.0);
  EXPECT_EQ(stage.resetCount(), 1);
}

/// A robot that swings to and fro on the spot in a room; its wheels are stamped too late.
class Swing {
public:
  static constexpr double kLate_s = 0.14;

  static Pose2 poseAt(double time_s) { return {0.0, 0.0, 1.5 * std::sin(0.8 * time_s)}; }
  static std::int64_t toNs(double time_s) {
    return static_cast<std::int64_t>(std::llround(time_s * 1e9));
  }
  /// \param is_blind  whether nothing is in sight
  static MountedScan scanAt(double time_s, bool is_blind) {
    const Walls room = rectangle(-2.0, -3.0, 4.0, 2.0) + rectangle(1.0, 0.5, 1.5, 1.0);
    TestLaser laser;
    laser.beam_count = 181;
    return {scanWalls(is_blind ? Walls{} : room, poseAt(time_s), toNs(time_s), laser), {}};
  }
};

TEST(OdometryStage, ALearnedStampOffsetIsNoMotion) {
  OdometryStage stage{LaserOdometryParameters{}};
  double worst_rad = 0.0;
  std::optional<LaserOdometryEstimate> last;
  bool was_blind = false;
  for (int step = 50; step < 4000; ++step) {  // 50 Hz
    const double time_s = 0.02 * step;
    // The scan at which the offset takes effect shows nothing: the wheels alone count.
    const bool is_blind = !was_blind && stage.stampOffset_ns() != 0;
    if (step % 5 == 0) stage.add(Swing::scanAt(time_s, is_blind));
    if (step % 5 == 0) was_blind |= is_blind;
    stage.addWheels({Swing::toNs(time_s), Swing::poseAt(time_s - Swing::kLate_s)});
    while (const auto next = stage.next()) {
      const double now_s = 1e-9 * static_cast<double>(next->estimate.stamp_ns);
      const double error_rad = next->estimate.motion.pose.yaw_rad -
                               (Swing::poseAt(now_s).yaw_rad - Swing::poseAt(now_s - 0.1).yaw_rad);
      if (last) worst_rad = std::max(worst_rad, std::abs(error_rad));
      last = next->estimate;
    }
  }
  EXPECT_TRUE(was_blind);
  EXPECT_NEAR(1e-9 * static_cast<double>(stage.stampOffset_ns()), Swing::kLate_s, 0.02);
  EXPECT_LT(worst_rad, 0.01);
}

/// What is learned of a lidar whose driver states no times, on a robot that swings to and fro.
/// \param mirror_turn_s  counterclockwise
/// \return what is added to the time of a mirror turn [s]
double learnedOfLidar(double mirror_turn_s, bool has_wheels = true) {
  LaserOdometryParameters parameters;
  parameters.use_wheels = has_wheels;
  OdometryStage stage{parameters};
  const Walls room = rectangle(-2.0, -3.0, 4.0, 2.0) + rectangle(1.0, 0.5, 1.5, 1.0);
  TestLaser laser;
  laser.beam_count = 181;
  laser.range_deviation_m = 0.005;
  const double half_turn_s = 0.5 * std::abs(mirror_turn_s);
  for (int step = 50; step < 800; ++step) {
    const double time_s = 0.1 * step;
    const auto poseAt = [](double at_s) {
      return Swing::poseAt(at_s) * Pose2{0.5 * std::sin(0.3 * at_s), 0.0, 0.0};
    };
    // The beam that is stored first is fired first, or last.
    const double first_s = mirror_turn_s > 0.0 ? time_s : time_s + half_turn_s;
    const double last_s = mirror_turn_s > 0.0 ? time_s + half_turn_s : time_s;
    const LaserScan scan = scanWalls(room, poseAt(first_s), Swing::toNs(time_s), laser,
                                     poseAt(first_s).inverse() * poseAt(last_s));
    stage.add({scan, {}});
    if (has_wheels) stage.addWheels({Swing::toNs(time_s), poseAt(time_s)});
    while (stage.next()) {
    }
  }
  return stage.lidarCalibration().addedMirrorTurn_s();
}

TEST(OdometryStage, LearnsHowLongTheMirrorTurns) {
  EXPECT_NEAR(learnedOfLidar(0.04), 0.04, 0.006);
}

TEST(OdometryStage, LearnsThatAMirrorTurnsClockwise) {
  EXPECT_NEAR(learnedOfLidar(-0.04), -0.04, 0.006);
}

TEST(OdometryStage, LearnsNothingOfALidarWithoutWheels) {
  EXPECT_EQ(learnedOfLidar(0.04, false), 0.0);
}

TEST(OdometryStage, LearnsNothingOfALidarThatIsAsStated) {
  EXPECT_EQ(learnedOfLidar(1e-9), 0.0);
}

TEST(OdometryStage, GivesThePosesOfTheWheelsWhereScansAreFarApart) {
  OdometryStage stage{LaserOdometryParameters{}};
  stage.add(scanAt(0));
  for (std::int64_t i = 0; i <= 30; ++i) stage.addWheels(wheelsAt(i));
  stage.add(scanAt(30));
  const auto first = stage.next();
  const auto second = stage.next();
  ASSERT_TRUE(first && second);
  EXPECT_TRUE(first->between.empty());
  ASSERT_EQ(second->between.size(), 5u);  // every half a second, within 3 s
  for (const StampedPose2& pose : second->between) {
    // The wheels go too far; where the scan corrects them, they are corrected all the way.
    const double share = static_cast<double>(pose.stamp_ns - scanAt(0).scan.stamp_ns) /
                         static_cast<double>(30 * kPeriodNs);
    EXPECT_NEAR(pose.pose.x_m, share * second->estimate.odom_from_base.pose.x_m, 1e-6);
  }
}

TEST(OdometryStage, AtTheEndScansThatWaitArePassedOn) {
  OdometryStage stage{LaserOdometryParameters{}};
  stage.addWheels(wheelsAt(0));
  for (std::int64_t i = 0; i < 3; ++i) stage.add(scanAt(i));
  EXPECT_TRUE(stage.next());
  EXPECT_FALSE(stage.next());
  stage.finish();
  EXPECT_TRUE(stage.next());
  EXPECT_TRUE(stage.next());
  EXPECT_FALSE(stage.next());
}

TEST(OdometryStage, CountsScansThatWereAlignedWithoutTheWheels) {
  OdometryStage stage{LaserOdometryParameters{}};
  for (std::int64_t i = 0; i < 5; ++i) stage.add(scanAt(i));
  for (std::int64_t i = 2; i < 5; ++i) stage.addWheels(wheelsAt(i));
  std::optional<OdometryStep> last;
  int count = 0;
  while (auto step = stage.next()) {
    last = std::move(step);
    ++count;
  }
  EXPECT_EQ(count, 5);
  EXPECT_EQ(stage.withoutWheelsCount(), 2u);
  EXPECT_NEAR(last->estimate.odom_from_base.pose.x_m, 4 * kStepM, 0.01);
}

TEST(OdometryStage, RefusesWheelsThatAreOutOfOrderOrNotFinite) {
  OdometryStage stage{LaserOdometryParameters{}};
  EXPECT_TRUE(stage.addWheels(wheelsAt(3)));
  EXPECT_FALSE(stage.addWheels(wheelsAt(3)));
  EXPECT_FALSE(stage.addWheels(wheelsAt(2)));
  StampedPose2 unusable = wheelsAt(4);
  unusable.pose.yaw_rad = std::nan("");
  EXPECT_FALSE(stage.addWheels(unusable));
  EXPECT_TRUE(stage.addWheels(wheelsAt(4)));
  const std::vector<Drops> all = stage.drops().all();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].count, 2u);
  EXPECT_EQ(all[0].detail, "odometry");
  EXPECT_EQ(all[1].reason, DropReason::kInvalidOdometry);
}

TEST(OdometryStage, UnrefinedScansWithoutWheelsStandAtTheOrigin) {
  OdometryStage stage(LaserOdometryParameters{}, false);
  stage.add(scanAt(3));
  stage.finish();
  const auto step = stage.next();
  ASSERT_TRUE(step);
  EXPECT_EQ(step->estimate.odom_from_base.pose.x_m, 0.0);
  EXPECT_EQ(step->estimate.stamp_ns, scanAt(3).scan.stamp_ns);
}

}  // namespace
}  // namespace ram_slam
