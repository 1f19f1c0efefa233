// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/tour.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <gmock/gmock.h>

#include "ramscout_sim/office.hpp"

#include "temporary_folder.hpp"

namespace ramscout_sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::refusalOf;
using testing::TemporaryFolder;

Tour angle() {
  Tour tour;
  tour.waypoints_m = {{0, 0}, {4, 0}, {4, 3}};
  return tour;
}

/// Moves a robot that obeys at once. \return the largest distance from the way
double driveAlong(TourDriver& driver, Pose2& pose) {
  constexpr double kStep_s = 0.01;
  double farthest_m = 0.0;
  for (int i = 0; i < 3000 && driver.progress() < 1.0; ++i) {
    const Twist2 twist = driver.drive(pose);
    EXPECT_LE(twist.forward_mps, 0.8);
    EXPECT_LE(std::abs(twist.turn_radps), 1.0);
    pose = pose * Pose2{twist.forward_mps * kStep_s, 0.0, twist.turn_radps * kStep_s};
    const double to_first_m = pose.x_m < 4.0 ? std::abs(pose.y_m) : 10.0;
    const double to_second_m = pose.y_m > 0.0 ? std::abs(pose.x_m - 4.0) : 10.0;
    farthest_m = std::max(farthest_m, std::min(to_first_m, to_second_m));
  }
  return farthest_m;
}

TEST(Tour, IsAsLongAsItsLegs) {
  EXPECT_NEAR(angle().length_m(), 7.0, 1e-12);
}

TEST(TourDriver, FollowsTheWayToItsEndAndStops) {
  TourDriver driver(angle());
  EXPECT_EQ(driver.progress(), 0.0);
  Pose2 pose;
  EXPECT_LT(driveAlong(driver, pose), 0.5);  // cuts corners by less than its lookahead
  EXPECT_EQ(driver.progress(), 1.0);
  EXPECT_NEAR(std::hypot(pose.x_m - 4.0, pose.y_m - 3.0), 0.0, 0.06);
  const Twist2 stopped = driver.drive(pose);
  EXPECT_EQ(stopped.forward_mps, 0.0);
  EXPECT_EQ(stopped.turn_radps, 0.0);
}

TEST(TourDriver, TurnsOnTheSpotWhenTheWayLiesBehind) {
  TourDriver driver(angle());
  const Twist2 twist = driver.drive({0.0, 0.0, 3.0});
  EXPECT_EQ(twist.forward_mps, 0.0);
  EXPECT_EQ(twist.turn_radps, -1.0);
}

TEST(TourDriver, PassesACrossingOfTheWayWithoutAShortcut) {
  // The way meets itself at (2, 0): progress must not jump from the first passage to the second.
  Tour eight;
  eight.waypoints_m = {{0, 0}, {4, 0}, {4, 2}, {2, 2}, {2, -2}};
  TourDriver driver(eight);
  Pose2 pose;
  double largest_jump = 0.0;
  double last = 0.0;
  for (int i = 0; i < 4000 && driver.progress() < 1.0; ++i) {
    const Twist2 twist = driver.drive(pose);
    pose = pose * Pose2{twist.forward_mps * 0.01, 0.0, twist.turn_radps * 0.01};
    largest_jump = std::max(largest_jump, driver.progress() - last);
    last = driver.progress();
  }
  EXPECT_EQ(last, 1.0);
  EXPECT_LT(largest_jump, 0.5 / eight.length_m());
}

TEST(Tour, IsWrittenAndReadBackTheSame) {
  const TemporaryFolder folder;
  Tour tour = angle();
  tour.speed_mps = 0.6;
  writeTour(tour, folder / "tour.yaml");
  const Tour copy = readTour(folder / "tour.yaml");
  EXPECT_EQ(copy.waypoints_m, tour.waypoints_m);
  EXPECT_EQ(copy.speed_mps, 0.6);
}

TEST(Tour, RefusesBadFilesByKey) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& yaml) {
    return refusalOf(readTour, folder.write("tour.yaml", yaml));
  };
  const std::string good = "waypoints: [[0, 0], [1, 0]]\n";
  ASSERT_EQ(refusal(good), "accepted");
  EXPECT_THAT(refusal("{}"), AllOf(HasSubstr("tour.yaml"), HasSubstr("waypoints")));
  EXPECT_THAT(refusal("waypoints: 3"), HasSubstr("waypoints"));
  EXPECT_THAT(refusal("waypoints: [[0, 0]]"), HasSubstr("two waypoints"));
  EXPECT_THAT(refusal("waypoints: [[0, 0], [1]]"), HasSubstr("[x, y]"));
  EXPECT_THAT(refusal("waypoints: [[0, 0], [a, b]]"), HasSubstr("tour.yaml"));
  EXPECT_THAT(refusal("waypoints: [[0, 0], [0, 0]]"), HasSubstr("the same"));
  EXPECT_THAT(refusal("waypoints: [[0, 0], [.nan, 0]]"), HasSubstr("not finite"));
  EXPECT_THAT(refusal(good + "speed_mps: 0"), HasSubstr("speed_mps"));
  EXPECT_THAT(refusal(good + "turn_speed_radps: -1"), HasSubstr("turn_speed_radps"));
  EXPECT_THAT(refusal(good + "speed: 1"), HasSubstr("speed"));
  EXPECT_THAT(refusalOf(readTour, folder / "none.yaml"), HasSubstr("none.yaml"));
}

}  // namespace
}  // namespace ramscout_sim
