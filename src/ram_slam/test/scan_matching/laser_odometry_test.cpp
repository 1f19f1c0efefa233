// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/laser_odometry.hpp"

#include <cmath>
#include <stdexcept>

#include <Eigen/LU>
#include <gmock/gmock.h>
#include <sys/resource.h>

#include "walls.hpp"

namespace ram_slam {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr std::int64_t kStepNs = 100000000;
const Pose2 kMount{0.2, -0.05, 0.1};

/// An L-shaped room with a pillar: every direction is held by some wall.
Walls room() {
  return outline({{-4, -3}, {6, -3}, {6, 2}, {2, 2}, {2, 5}, {-4, 5}}) +
         rectangle(3.0, -1.0, 3.5, -0.5);
}

Walls corridor() {
  return {{{-100, -1}, {100, -1}}, {{-100, 1}, {100, 1}}};
}

/// Step i of a drive about the room that turns and advances.
Pose2 drive(int step) {
  const double s = 0.05 * step;
  return {-1.0 + 0.8 * std::sin(0.7 * s), 0.5 * std::sin(1.1 * s), 0.9 * std::sin(0.5 * s)};
}

Eigen::Vector3d difference(const Pose2& a, const Pose2& b) {
  return {a.x_m - b.x_m, a.y_m - b.y_m, wrapAngle(a.yaw_rad - b.yaw_rad)};
}

/// The last estimate of a drive along `truth(i)`, with wheels at `wheels(i)`.
template <typename Truth, typename Wheels>
LaserOdometryEstimate run(const Walls& walls,
                          int steps,
                          const Truth& truth,
                          const Wheels& wheels,
                          const TestLaser& laser = {}) {
  LaserOdometry odometry{LaserOdometryParameters()};
  LaserOdometryEstimate estimate;
  for (int i = 0; i < steps; ++i) {
    const LaserScan scan = scanWalls(walls, truth(i) * kMount, (i + 1) * kStepNs, laser);
    estimate = odometry.update(scan, kMount, wheels(i));
  }
  return estimate;
}

TEST(LaserOdometry, RecoversAMotionFromExactScansWithinAMillimetreWithoutWheels) {
  const auto no_wheels = [](int) { return std::optional<Pose2>(); };
  constexpr int kSteps = 60;
  const LaserOdometryEstimate last = run(room(), kSteps, drive, no_wheels);
  const Pose2 truth = drive(0).inverse() * drive(kSteps - 1);
  const Eigen::Vector3d error = difference(last.odom_from_base.pose, truth);
  EXPECT_LT(error.head<2>().norm(), 1e-3);
  EXPECT_LT(std::abs(error.z()), 5e-4);
}

TEST(LaserOdometry, OfARobotThatIsCarriedAwayGoesOnFromWhereItsWheelsStood) {
  LaserOdometry odometry{LaserOdometryParameters()};
  constexpr std::int64_t kScanNs = 25'000'000;
  const Pose2 moved{0.02, 0.0, 0.0};
  Pose2 truth{-1.0, 0.0, 0.3};
  Pose2 wheels;
  LaserOdometryEstimate estimate;
  const auto look = [&](int step) {
    estimate = odometry.update(scanWalls(room(), truth * kMount, step * kScanNs), kMount, wheels);
  };
  look(1);
  truth = {-2.0, 4.0, -1.5};
  bool jumped = false;
  for (int step = 2; step < 5; ++step) {
    look(step);
    jumped |= estimate.jumped;
    EXPECT_LT(difference(estimate.odom_from_base.pose, {}).norm(), 1e-9);
  }
  EXPECT_TRUE(jumped);
  for (int step = 5; step < 15; ++step) {
    truth = truth * moved;
    wheels = wheels * moved;
    look(step);
    EXPECT_FALSE(estimate.jumped);
  }
  EXPECT_LT(difference(estimate.odom_from_base.pose, {0.2, 0.0, 0.0}).norm(), 1e-3);
}

TEST(LaserOdometry, WheelsThatJumpAreNoCarryingAway) {
  LaserOdometry odometry{LaserOdometryParameters()};
  const LaserScan here = scanWalls(room(), kMount, kStepNs);
  odometry.update(here, kMount, Pose2{});
  LaserScan again = here;
  again.stamp_ns += kStepNs;
  const LaserOdometryEstimate estimate = odometry.update(again, kMount, Pose2{0.4, 0.0, 0.3});
  EXPECT_FALSE(estimate.jumped);
  EXPECT_LT(difference(estimate.odom_from_base.pose, {}).norm(), 0.01);
}

TEST(LaserOdometry, WheelsThatJumpToAndFroByThousandsOfKilometresFillNoMemory) {
  LaserOdometry odometry{LaserOdometryParameters()};
  const auto memory_kb = [] {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
  };
  const long before_kb = memory_kb();
  for (int step = 1; step < 60; ++step) {
    const double x_m = step % 3 == 0 ? 300.0 * step : (step % 2 == 0 ? 1e6 : -1e6);
    odometry.update(scanWalls(room(), drive(step) * kMount, step * kStepNs), kMount,
                    Pose2{x_m, 0.0, 0.0});
  }
  EXPECT_LT(memory_kb() - before_kb, 60'000);
}

TEST(Surfaces, OfALaserThatMovesDuringItsSweepAreWhereTheWallsAre) {
  const Pose2 start{-1.0, 0.5, 0.3};
  const Pose2 last_beam{0.02, 0.005, 0.03};
  const LaserScan scan = scanWalls(room(), start, 1, {}, last_beam);
  const auto farthest_m = [&](const SurfaceScan& surfaces) {
    double farthest = 0.0;
    for (const SurfacePoint& point : surfaces.points) {
      const Eigen::Vector2d place_m = start * Eigen::Vector2d(point.x_m, point.y_m);
      double nearest = 1.0;
      for (const Wall& wall : room()) {
        const Eigen::Vector2d along = wall.to_m - wall.from_m;
        const double share =
            std::clamp(along.dot(place_m - wall.from_m) / along.squaredNorm(), 0.0, 1.0);
        nearest = std::min(nearest, (wall.from_m + share * along - place_m).norm());
      }
      farthest = std::max(farthest, nearest);
    }
    return farthest;
  };
  SurfaceParameters bare;
  bare.max_line_deviation_m = 1e-6;  // so that no point is drawn onto a line across a corner
  EXPECT_LT(farthest_m(extractSurfaces(scan, bare, last_beam)), 1e-3);
  EXPECT_GT(farthest_m(extractSurfaces(scan, bare)), 0.05);
}

TEST(LaserScan, LastsFromItsFirstBeamToItsLast) {
  LaserScan scan;
  scan.time_increment_s = 0.001;
  EXPECT_EQ(scan.duration_ns(), 0);
  scan.ranges_m.resize(101, 1.0F);
  EXPECT_EQ(scan.duration_ns(), 100'000'000);
}

TEST(LaserScan, ABearingTellsWhenItsBeamIsFired) {
  LaserScan scan;
  scan.angle_min_rad = -0.75 * M_PI;
  scan.angle_increment_rad = 0.01;
  scan.time_increment_s = 1e-5;
  EXPECT_EQ(scan.delay_ns(scan.bearing_rad(0)), 0);
  EXPECT_EQ(scan.delay_ns(scan.bearing_rad(300)), 3'000'000);
  EXPECT_EQ(scan.delay_ns(scan.bearing_rad(300) - 2.0 * M_PI), 3'000'000);
  const LaserScan reversed = mirrored(scan);
  EXPECT_EQ(reversed.delay_ns(reversed.bearing_rad(300)), 3'000'000);
}

/// How far the yaw is off after ten turns on the spot, by a laser that sweeps for most of the time
/// between two scans. \param timed  whether its scans hold the times of their beams
double errorOfTenTurns_rad(bool timed) {
  constexpr double kTurnRad = 0.05;
  constexpr double kSweepShare = 0.7;
  LaserOdometry odometry{LaserOdometryParameters()};
  double yaw_rad = 0.0;
  LaserOdometryEstimate last;
  for (int step = 0; yaw_rad < 20.0 * M_PI; ++step) {
    // It stands at first and in the end, so that the pose is that of the whole scan.
    const bool turns = step >= 2 && yaw_rad + kTurnRad < 20.0 * M_PI;
    LaserScan scan = scanWalls(room(), {0.0, 0.0, yaw_rad}, (step + 1) * kStepNs, {},
                               {0.0, 0.0, turns ? kSweepShare * kTurnRad : 0.0});
    if (timed) {
      scan.time_increment_s =
          kSweepShare * 1e-9 * kStepNs / static_cast<double>(scan.ranges_m.size() - 1);
    }
    last = odometry.update(scan, {}, Pose2{0.0, 0.0, wrapAngle(yaw_rad)});
    if (step >= 1) yaw_rad += kTurnRad;
  }
  return std::abs(wrapAngle(last.odom_from_base.pose.yaw_rad - (yaw_rad - kTurnRad)));
}

TEST(LaserOdometry, TurnsRightWithALaserThatTakesTimeToSweep) {
  const double corrected_rad = errorOfTenTurns_rad(true);
  const double uncorrected_rad = errorOfTenTurns_rad(false);
  EXPECT_LT(corrected_rad, 0.02);
  EXPECT_GT(uncorrected_rad, 0.5);  // of the 63 that it turned
}

TEST(LaserOdometry, StartsWhereTheWheelsAre) {
  LaserOdometry odometry{LaserOdometryParameters()};
  const Pose2 start{3.0, 4.0, 1.0};
  const LaserOdometryEstimate first =
      odometry.update(scanWalls(room(), drive(0) * kMount, 1), kMount, start);
  EXPECT_EQ(first.odom_from_base.pose.x_m, 3.0);
  EXPECT_EQ(first.odom_from_base.covariance.norm(), 0.0);
}

TEST(LaserOdometry, BelievesTheScansWhereTheWheelsSlip) {
  // From step 30 to 34 the wheels report 0.5 m and 0.4 rad that never happened.
  const auto slipping = [](int i) {
    const double slip = std::clamp((i - 30) / 4.0, 0.0, 1.0);
    return std::optional<Pose2>(Pose2{0.5 * slip, 0.0, 0.4 * slip} * drive(i));
  };
  const LaserOdometryEstimate last = run(room(), 60, drive, slipping);
  const Eigen::Vector3d error = difference(last.odom_from_base.pose, drive(59));
  EXPECT_LT(error.head<2>().norm(), 4e-3);
  EXPECT_LT(std::abs(error.z()), 2e-3);
}

TEST(LaserOdometry, SearchesASlipAsFarAsTheWheelsMoved) {
  const Pose2 first{-1.0, 0.5, 0.2}, aside = first * Pose2{0.0, 0.8, 0.0};
  LaserOdometry odometry{LaserOdometryParameters()};
  odometry.update(scanWalls(room(), first * kMount, kStepNs), kMount, first);
  const LaserOdometryEstimate last = odometry.update(
      scanWalls(room(), aside * kMount, 30 * kStepNs), kMount, first * Pose2{1.5, 0.0, 0.0});
  EXPECT_LT(difference(last.odom_from_base.pose, aside).norm(), 0.01);
}

/// The deviation of the yaw [rad] of a step of 0.1 m where nothing is seen, after a drive about the
/// room with wheels whose yaw is off by `noise_rad`, to the left and to the right in turn.
double blindYawDeviation(int steps, double noise_rad) {
  LaserOdometry odometry{LaserOdometryParameters()};
  Pose2 wheels;
  for (int i = 0; i < steps; ++i) {
    wheels = drive(i) * Pose2{0.0, 0.0, i % 20 < 10 ? noise_rad : -noise_rad};
    odometry.update(scanWalls(room(), drive(i) * kMount, (i + 1) * kStepNs), kMount, wheels);
  }
  const LaserOdometryEstimate last = odometry.update(scanWalls({}, {}, (steps + 1) * kStepNs),
                                                     kMount, wheels * Pose2{0.1, 0.0, 0.0});
  return std::sqrt(last.motion.covariance(2, 2));
}

TEST(LaserOdometry, BelievesTheYawOfWheelsAsFarAsItWasRight) {
  const double stated_rad = blindYawDeviation(2, 0.0);
  EXPECT_NEAR(stated_rad, 0.005 + 0.1 * 0.1, 1e-3);
  EXPECT_LT(blindYawDeviation(1500, 0.0), 0.6 * stated_rad);
  EXPECT_GT(blindYawDeviation(1500, 0.05), 0.7 * stated_rad);
}

TEST(LaserOdometry, ReportsTheSlip) {
  bool slipped_before = false;
  bool slipped_after = false;
  LaserOdometry odometry{LaserOdometryParameters()};
  for (int i = 0; i < 20; ++i) {
    const Pose2 wheels = i < 10 ? drive(i) : Pose2{0.3, 0.0, 0.2} * drive(i);
    const LaserScan scan = scanWalls(room(), drive(i) * kMount, (i + 1) * kStepNs);
    const bool slipped = odometry.update(scan, kMount, wheels).wheels_slipped;
    (i < 10 ? slipped_before : slipped_after) |= slipped;
  }
  EXPECT_FALSE(slipped_before);
  EXPECT_TRUE(slipped_after);
}

TEST(LaserOdometry, GoesOnAndSaysSoWhenTheWheelsStopCounting) {  // fault F62
  constexpr int kFrozen = 30;
  LaserOdometry odometry{LaserOdometryParameters()};
  LaserOdometryEstimate last;
  std::int64_t reported_ns = 0;
  for (int i = 0; i < 60; ++i) {
    const LaserScan scan = scanWalls(room(), drive(i) * kMount, (i + 1) * kStepNs);
    last = odometry.update(scan, kMount, drive(std::min(i, kFrozen)));
    if (last.wheels_stuck && reported_ns == 0) reported_ns = scan.stamp_ns;
  }
  EXPECT_GT(reported_ns, kFrozen * kStepNs);
  EXPECT_LT(reported_ns, (kFrozen + 1) * kStepNs + 3'000'000'000);
  const Eigen::Vector3d error = difference(last.odom_from_base.pose, drive(59));
  EXPECT_LT(error.head<2>().norm(), 0.02);
  EXPECT_LT(std::abs(error.z()), 0.01);
}

TEST(LaserOdometry, ReplacedWheelsAreWhereTheNextMotionBegins) {
  LaserOdometry odometry{LaserOdometryParameters()};
  odometry.update(scanWalls({}, {}, kStepNs), kMount, Pose2{1.0, 0.0, 0.0});
  odometry.replaceWheels(Pose2{1.2, 0.0, 0.1});
  const Pose2 motion{0.1, 0.0, 0.02};
  const LaserOdometryEstimate estimate =
      odometry.update(scanWalls({}, {}, 2 * kStepNs), kMount, Pose2{1.2, 0.0, 0.1} * motion);
  EXPECT_LT(difference(estimate.motion.pose, motion).norm(), 1e-9);
}

TEST(LaserOdometry, LeavesOutTheWheelsWhileTheyAreStuckAndTheirFirstMotionAfterwards) {
  LaserOdometry odometry{LaserOdometryParameters()};
  // The wheels are read again only at step 30: then they show the motion of all the time.
  LaserOdometryEstimate last;
  for (int i = 0; i < 34; ++i) {
    const LaserScan scan = scanWalls(room(), drive(i) * kMount, (i + 1) * kStepNs);
    last = odometry.update(scan, kMount, i < 30 ? drive(0) : drive(i));
    if (i >= 1) {
      const Pose2 truth = drive(i - 1).inverse() * drive(i);
      EXPECT_LT(difference(last.motion.pose, truth).norm(), 0.03) << i;
    }
  }
  EXPECT_LT(difference(last.odom_from_base.pose, drive(33)).norm(), 0.03);
}

TEST(LaserOdometry, TakesARobotAtRestForOne) {
  LaserOdometry odometry{LaserOdometryParameters()};
  TestLaser noisy;
  noisy.range_deviation_m = 0.02;
  for (int i = 0; i < 100; ++i) {
    const LaserScan scan = scanWalls(room(), kMount, (i + 1) * kStepNs, noisy);
    EXPECT_FALSE(odometry.update(scan, kMount, Pose2{}).wheels_stuck);
  }
}

TEST(LaserOdometry, FollowsTheWheelsAlongACorridorAndSaysThatItDoes) {
  TestLaser laser;
  laser.range_deviation_m = 0.01;
  const auto truth = [](int i) { return Pose2{0.05 * i, 0.0, 0.0}; };
  const auto wheels = [&](int i) { return std::optional<Pose2>(truth(i)); };
  const LaserOdometryEstimate last = run(corridor(), 100, truth, wheels, laser);
  EXPECT_NEAR(last.odom_from_base.pose.x_m, truth(99).x_m, 0.05);
  EXPECT_NEAR(last.odom_from_base.pose.y_m, 0.0, 0.02);
  // Along: the wheels alone. Across: held by the walls.
  const LaserOdometryParameters defaults;
  const double wheels_m =
      defaults.wheel_rest_deviation_m + defaults.wheel_distance_deviation_m_per_m * 0.05;
  EXPECT_NEAR(std::sqrt(last.motion.covariance(0, 0)), wheels_m, 0.1 * wheels_m);
  EXPECT_GT(last.motion.covariance(0, 0), 5.0 * last.motion.covariance(1, 1));
}

TEST(LaserOdometry, CarriesOnWithTheWheelsWhenNothingIsInSight) {
  const auto truth = [](int i) { return Pose2{0.1 * i, 0.0, 0.01 * i}; };
  const LaserOdometryEstimate last =
      run({}, 50, truth, [&](int i) { return std::optional<Pose2>(truth(i)); });
  EXPECT_LT(difference(last.odom_from_base.pose, truth(49)).norm(), 1e-9);
  EXPECT_EQ(last.inlier_ratio, 0.0);
}

TEST(LaserOdometry, GoesStraightOnWithUnequalWheelsOnceItHasSeenWhatTheyDo) {
  const Walls walls = {{{-10, -1}, {15, -1}}, {{-10, 1}, {15, 1}}, {{14, -1}, {14, -0.8}}};
  const auto truth = [](int i) { return Pose2{0.1 * i, 0.0, 0.0}; };
  const auto wheels = [](int i) {
    return std::optional<Pose2>(exponential({0.1 * i, 0.0, -0.005 * i}));
  };
  const auto beyond = [&](int i) { return run(walls, i, truth, wheels).odom_from_base.pose; };
  // The wheels turn by 0.5 rad over the last 10 m, where nothing is in sight.
  EXPECT_NEAR(beyond(160).yaw_rad, 0.0, 0.01);
  EXPECT_NEAR(beyond(260).yaw_rad, 0.0, 0.05);
}

TEST(LaserOdometry, CovarianceCoversTheErrorOfNoisyScans) {
  TestLaser laser;
  laser.range_deviation_m = 0.02;
  const auto wheels = [](int i) { return std::optional<Pose2>(drive(i)); };
  const LaserOdometryEstimate last = run(room(), 100, drive, wheels, laser);
  const Eigen::Vector3d error = difference(last.odom_from_base.pose, drive(99));
  // chi2 of 3 degrees of freedom, 99.9 %.
  EXPECT_LT(error.dot(last.odom_from_base.covariance.inverse() * error), 16.3);
}

TEST(LaserOdometry, SameInputGivesTheSameBits) {
  const auto wheels = [](int i) { return std::optional<Pose2>(drive(i)); };
  TestLaser laser;
  laser.range_deviation_m = 0.02;
  const LaserOdometryEstimate a = run(room(), 30, drive, wheels, laser);
  const LaserOdometryEstimate b = run(room(), 30, drive, wheels, laser);
  EXPECT_EQ(difference(a.odom_from_base.pose, b.odom_from_base.pose).norm(), 0.0);
  EXPECT_EQ(a.odom_from_base.covariance, b.odom_from_base.covariance);
}

TEST(LaserOdometry, RefusesWhatItCannotUseAndGoesOnAsIfItHadNotCome) {
  LaserOdometry with_bad{LaserOdometryParameters()};
  LaserOdometry without{LaserOdometryParameters()};
  for (int i = 0; i < 3; ++i) {
    const LaserScan scan = scanWalls(room(), drive(i) * kMount, (i + 1) * kStepNs);
    with_bad.update(scan, kMount, drive(i));
    without.update(scan, kMount, drive(i));
    EXPECT_THAT([&] { with_bad.update(scan, kMount, drive(i)); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("not later than the last")));
    EXPECT_THROW(with_bad.update(LaserScan(), kMount, drive(i)), std::invalid_argument);
    EXPECT_THROW(with_bad.update(scan, kMount, Pose2{NAN, 0, 0}), std::invalid_argument);
  }
  const LaserScan scan = scanWalls(room(), drive(3) * kMount, 4 * kStepNs);
  EXPECT_EQ(with_bad.update(scan, kMount, drive(3)).odom_from_base.pose.x_m,
            without.update(scan, kMount, drive(3)).odom_from_base.pose.x_m);
}

TEST(LaserOdometryParameters, RefuseValuesOutOfBounds) {
  LaserOdometryParameters parameters;
  parameters.reference_count = 0;
  EXPECT_THAT([&] { LaserOdometry odometry(parameters); },
              ThrowsMessage<std::invalid_argument>(
                  HasSubstr("reference_count must be in [1, key_scan_count], got 0")));
  parameters = {};
  parameters.base_frame = parameters.odom_frame;
  EXPECT_THROW(parameters.validate(), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
