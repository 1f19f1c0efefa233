// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/causes.hpp"

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

InputFacts scans() {
  InputFacts input;
  input.link = Link::kScan;
  input.content = "scans";
  input.topic = "/scan";
  input.argument = "scan";
  input.source = "the driver of the lidar";
  input.type = "sensor_msgs/LaserScan";
  input.publishers = {"/lidar"};
  input.newest_publisher = "/lidar";
  input.published_type = input.type;
  input.age_s = 0.02;
  input.interval_s = 0.1;
  return input;
}

InputFacts odometry() {
  InputFacts input = scans();
  input.link = Link::kOdometry;
  input.content = "odometry";
  input.topic = "/odom";
  input.argument = "odom";
  input.source = "the driver of the wheels";
  input.type = input.published_type = "nav_msgs/Odometry";
  input.publishers = {"/wheels"};
  return input;
}

TransformFacts mount() {
  TransformFacts transform;
  transform.parent = "base_link";
  transform.parent_parameter = "base_frame";
  transform.child = "laser";
  transform.remedy = "start robot_state_publisher";
  transform.parent_exists = true;
  return transform;
}

TransformFacts odomToBase() {
  TransformFacts transform;
  transform.parent = "odom";
  transform.parent_parameter = "odom_frame";
  transform.child = "base_link";
  transform.child_parameter = "base_frame";
  transform.remedy = "the node that publishes the odometry must also publish it";
  transform.parent_exists = true;
  return transform;
}

NodeFacts healthy() {
  NodeFacts node;
  node.link = Link::kOdometry;
  node.running_s = 60.0;
  node.inputs = {scans(), odometry()};
  node.transforms = {mount(), odomToBase()};
  node.output = "/laser_odom";
  node.output_age_s = 0.03;
  return node;
}

/// The newest message never came, and nobody publishes it.
InputFacts absent(InputFacts input) {
  input.publishers.clear();
  input.newest_publisher.clear();
  input.published_type.clear();
  input.age_s = kNever_s;
  input.interval_s = 0.0;
  return input;
}

/// The only cause has this link and name, and its text states these two.
auto onlyCause(Link link,
               const std::string& name,
               const std::string& what,
               const std::string& todo) {
  return ElementsAre(AllOf(Field(&Cause::link, link), Field(&Cause::name, name),
                           Field(&Cause::text, AllOf(HasSubstr(what), HasSubstr(todo)))));
}

TEST(Causes, OfANodeThatDoesWhatItShouldThereAreNone) {
  EXPECT_THAT(CauseFinder::find(healthy()), IsEmpty());
}

TEST(Causes, NoScanIsNamedWithWhatToStart) {
  NodeFacts node = healthy();
  node.inputs[0] = absent(scans());
  EXPECT_THAT(CauseFinder::find(node), onlyCause(Link::kScan, "no publisher",
                                                 "no node publishes /scan", "driver of the lidar"));
}

TEST(Causes, OfAWrongScanTopicTheRightOneIsNamed) {
  NodeFacts node = healthy();
  node.inputs[0] = absent(scans());
  node.inputs[0].elsewhere = {"/front/scan of /lidar"};
  EXPECT_THAT(CauseFinder::find(node),
              onlyCause(Link::kScan, "wrong topic", "/front/scan of /lidar",
                        "start with scan:=/front/scan"));
}

TEST(Causes, OfSeveralTopicsThatMayBeMeantAllAreNamed) {
  NodeFacts node = healthy();
  node.inputs[0] = absent(scans());
  node.inputs[0].elsewhere = {"/front of /lidar", "/rear of /lidar"};
  EXPECT_THAT(
      CauseFinder::find(node),
      onlyCause(Link::kScan, "wrong topic", "/front of /lidar, /rear of /lidar", "set scan:="));
}

TEST(Causes, ATopicOfAnotherTypeIsNamedWithBothTypes) {
  NodeFacts node = healthy();
  node.inputs[0].age_s = kNever_s;
  node.inputs[0].published_type = "sensor_msgs/PointCloud2";
  EXPECT_THAT(
      CauseFinder::find(node),
      onlyCause(Link::kScan, "wrong type", "sensor_msgs/PointCloud2", "not sensor_msgs/LaserScan"));
}

TEST(Causes, AWrongBaseFrameIsNamedWithTheFramesThatThereAre) {
  NodeFacts node = healthy();
  node.transforms[0].missing_s = 1.5;
  node.transforms[0].parent_exists = false;
  node.transforms[0].above = {"base_footprint", "odom"};
  EXPECT_THAT(
      CauseFinder::find(node),
      onlyCause(Link::kTf, "wrong base_frame",
                "there is no frame base_link, but above laser there is base_footprint, odom",
                "set base_frame"));
}

TEST(Causes, AMissingMountIsNamedWithWhatToStart) {
  NodeFacts node = healthy();
  node.transforms[0].missing_s = 1.5;
  EXPECT_THAT(CauseFinder::find(node),
              onlyCause(Link::kTf, "no transform", "no transform base_link -> laser on tf",
                        "start robot_state_publisher"));
}

TEST(Causes, AWrongOdometryFrameIsNamedWithTheFrameThatThereIs) {
  NodeFacts node = healthy();
  node.transforms[1].missing_s = 1.5;
  node.transforms[1].parent_exists = false;
  node.transforms[1].above = {"odom_combined"};
  EXPECT_THAT(CauseFinder::find(node),
              onlyCause(Link::kTf, "wrong odom_frame", "above base_link there is odom_combined",
                        "set odom_frame"));
}

TEST(Causes, ABaseThatIsNotBelowTheOdometryFrameIsNamedWithWhatIs) {
  NodeFacts node = healthy();
  node.transforms[1].missing_s = 1.5;
  node.transforms[1].below = {"base_footprint"};
  EXPECT_THAT(CauseFinder::find(node),
              onlyCause(Link::kTf, "wrong base_frame", "below odom there is base_footprint",
                        "set base_frame"));
}

TEST(Causes, NoOdometryIsNamedWithWhatToStart) {
  NodeFacts node = healthy();
  node.inputs[1] = absent(odometry());
  EXPECT_THAT(CauseFinder::find(node),
              onlyCause(Link::kOdometry, "no publisher", "no node publishes /odom",
                        "start the driver of the wheels"));
}

TEST(Causes, NoTransformFromOdometryToBaseIsNamedWithWhoMustPublishIt) {
  NodeFacts node = healthy();
  node.transforms[1].missing_s = 1.5;
  EXPECT_THAT(CauseFinder::find(node),
              onlyCause(Link::kTf, "no transform", "no transform odom -> base_link on tf",
                        "the node that publishes the odometry must also publish it"));
}

TEST(Causes, ATransformThatIsNoLongerRenewedIsNamed) {
  NodeFacts node = healthy();
  node.transforms[1].stamp_age_s = 1.5;
  EXPECT_THAT(CauseFinder::find(node),
              onlyCause(Link::kTf, "old transform", "odom -> base_link on tf is no longer renewed",
                        "must also publish it"));
}

TEST(Causes, OdometryOfAnotherFrameIsNamedWithTheReasonOfItsRefusal) {
  NodeFacts node = healthy();
  node.inputs[1].refusal = "it is of 'base_footprint' in 'odom': set odom_frame and base_frame";
  EXPECT_THAT(CauseFinder::find(node),
              onlyCause(Link::kOdometry, "refused odometry", "no usable odometry on /odom",
                        "set odom_frame and base_frame"));
}

TEST(Causes, OldStampsAreNamedWithTheirPublisher) {
  NodeFacts node = healthy();
  node.inputs[0].stamp_age_s = 5.0;
  EXPECT_THAT(CauseFinder::find(node),
              onlyCause(Link::kScan, "stamps old",
                        "stamps of scans on /scan from /lidar are 5 s older", "set the clocks"));
}

TEST(Causes, StampsAheadAreNamedWithTheirPublisher) {
  NodeFacts node = healthy();
  node.inputs[1].stamp_age_s = -5.0;
  EXPECT_THAT(CauseFinder::find(node), onlyCause(Link::kOdometry, "stamps ahead",
                                                 "are 5 s newer than the clock", "set the clocks"));
}

TEST(Causes, StampsOfARecordingWithoutItsClockAreTakenForWhatTheyAre) {
  NodeFacts node = healthy();
  node.inputs[0].stamp_age_s = 3e7;
  EXPECT_THAT(CauseFinder::find(node),
              onlyCause(Link::kScan, "other clock", "347 days older", "use_sim_time to true"));
}

TEST(Causes, StampsOfTheWallClockInSimulatedTimeAreTakenForWhatTheyAre) {
  NodeFacts node = healthy();
  node.is_simulated_time = true;
  node.inputs[0].stamp_age_s = -1.7e9;
  EXPECT_THAT(CauseFinder::find(node), onlyCause(Link::kScan, "other clock",
                                                 "its publisher uses another clock", "to false"));
}

TEST(Causes, AFastSimulationMayLagByAsMuchWallTime) {
  NodeFacts node = healthy();
  node.is_simulated_time = true;
  node.clock_speed = 10.0;
  node.inputs[0].stamp_age_s = 5.0;
  EXPECT_THAT(CauseFinder::find(node), IsEmpty());
}

TEST(Causes, SimulatedTimeWithoutAClockHidesAllOthers) {
  NodeFacts node = healthy();
  node.inputs[0] = absent(scans());
  node.has_clock = false;
  EXPECT_THAT(CauseFinder::find(node),
              onlyCause(Link::kClock, "no clock", "use_sim_time is set", "/clock"));
}

TEST(Causes, WhileAClockStandsStillNothingIsMissing) {
  NodeFacts node = healthy();
  node.clock_standing_s = 1.5;
  node.inputs[0].age_s = 1.5;
  EXPECT_THAT(CauseFinder::find(node),
              ElementsAre(AllOf(Field(&Cause::name, "clock stands"),
                                Field(&Cause::severity, Severity::kWarning))));
}

TEST(Causes, APublisherThatIsDeadIsNamed) {
  NodeFacts node = healthy();
  node.inputs[0].age_s = 1.1;
  node.inputs[0].dead = {"/lidar"};
  EXPECT_THAT(CauseFinder::find(node),
              onlyCause(Link::kScan, "node dead", "/lidar does not answer", "start it again"));
}

TEST(Causes, APublisherThatIsStoppedIsNamed) {
  NodeFacts node = healthy();
  node.inputs[0].age_s = 1.1;
  EXPECT_THAT(CauseFinder::find(node),
              onlyCause(Link::kScan, "node silent", "no scans any more: /lidar", "it is stopped"));
}

TEST(Causes, ASlowSensorIsNotSilentBetweenTwoMessages) {
  NodeFacts node = healthy();
  node.inputs[0].interval_s = 2.0;
  node.inputs[0].age_s = 3.0;
  node.output_age_s = 3.0;
  EXPECT_THAT(CauseFinder::find(node), IsEmpty());
}

TEST(Causes, InTheFirstSecondANodeOnlyStarts) {
  NodeFacts node = healthy();
  node.running_s = 0.5;
  node.inputs[0] = absent(scans());
  node.output_age_s = kNever_s;
  EXPECT_THAT(CauseFinder::find(node),
              ElementsAre(AllOf(Field(&Cause::name, "starting"),
                                Field(&Cause::severity, Severity::kWarning))));
}

TEST(Causes, AnInputThatComesNowAndThenMayBeSilentOnceItHasAPublisher) {
  NodeFacts node = healthy();
  node.inputs[0].is_rare = true;
  node.inputs[0].age_s = kNever_s;
  EXPECT_THAT(CauseFinder::find(node), IsEmpty());
  node.inputs[0].publishers.clear();
  EXPECT_THAT(CauseFinder::find(node),
              onlyCause(Link::kScan, "no publisher", "no node publishes /scan", "start"));
}

TEST(Causes, ANodeThatPublishesNothingIsNotOk) {
  NodeFacts node = healthy();
  node.output_age_s = 3.0;
  EXPECT_THAT(
      CauseFinder::find(node),
      onlyCause(Link::kOdometry, "no output", "nothing is published on /laser_odom", "too slow"));
}

TEST(Causes, WhatANodeFindsItselfComesAfterWhatItLacks) {
  NodeFacts node = healthy();
  node.own = {{Link::kPose, Severity::kError, "lost", "lost"},
              {Link::kMap, Severity::kError, "disk full", "the disk is full"}};
  node.inputs[0] = absent(scans());
  EXPECT_THAT(CauseFinder::find(node),
              ElementsAre(Field(&Cause::name, "no publisher"), Field(&Cause::name, "lost"),
                          Field(&Cause::name, "disk full")));
}

TEST(CauseLog, LogsACauseOnceWhenItHasLasted) {
  CauseLog log;
  const std::vector<Cause> causes = {{Link::kScan, Severity::kError, "node dead", "dead for 1 s"}};
  EXPECT_THAT(log.update(causes, 60.0), IsEmpty());
  EXPECT_THAT(log.update(causes, 62.5), ElementsAre(Field(&Cause::name, "node dead")));
  EXPECT_THAT(log.update({{Link::kScan, Severity::kError, "node dead", "dead for 9 s"}}, 69.0),
              IsEmpty());
  EXPECT_THAT(log.update({}, 72.0), IsEmpty());
  EXPECT_THAT(log.update(causes, 73.0), IsEmpty()) << "it was not gone for long";
}

TEST(CauseLog, LogsACauseAgainThatWasGone) {
  CauseLog log;
  const std::vector<Cause> causes = {{Link::kScan, Severity::kError, "node dead", "dead"}};
  log.update(causes, 60.0);
  EXPECT_EQ(log.update(causes, 63.0).size(), 1U);
  log.update({}, 80.0);
  log.update(causes, 90.0);
  EXPECT_EQ(log.update(causes, 93.0).size(), 1U);
}

TEST(CauseLog, LeavesAStartingNodeTimeForTheOthersToStart) {
  CauseLog log;
  const std::vector<Cause> causes = {{Link::kScan, Severity::kError, "no publisher", "no scans"}};
  log.update(causes, 1.0);
  EXPECT_THAT(log.update(causes, 9.0), IsEmpty());
  EXPECT_EQ(log.update(causes, 10.0).size(), 1U);
}

}  // namespace
}  // namespace ram_slam
