// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/topic_choice.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

namespace ramscout_bringup {
namespace {

using ::testing::HasSubstr;

RecordedTopic scan(const std::string& name) {
  return {name, "sensor_msgs/LaserScan", 10};
}
RecordedTopic odometry(const std::string& name) {
  return {name, "nav_msgs/Odometry", 10};
}

std::string errorOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(TopicChoice, TopicNamedScanComesBeforeOneWhoseLastPartIsScan) {
  EXPECT_EQ(chooseScanTopic({scan("/camera/scan"), scan("/scan")}, ""), "/scan");
  EXPECT_EQ(chooseScanTopic({scan("/base/scan"), scan("/front")}, ""), "/base/scan");
}

TEST(TopicChoice, OnlyTopicOfItsTypeIsTakenWhateverItsName) {
  EXPECT_EQ(chooseScanTopic({scan("/front/points"), odometry("/odom")}, ""), "/front/points");
  EXPECT_EQ(chooseOdometryTopic({odometry("/camera/odom/sample")}, "", false),
            "/camera/odom/sample");
  EXPECT_EQ(chooseScanTopic({{"/echoes", "sensor_msgs/MultiEchoLaserScan", 3}}, ""), "/echoes");
}

TEST(TopicChoice, SeveralCandidatesAreNamed) {
  EXPECT_THAT(errorOf([] {
                chooseScanTopic({scan("/a/scan"), scan("/b/scan")}, "");
              }),
              HasSubstr("/a/scan (sensor_msgs/LaserScan), /b/scan"));
  const std::vector<RecordedTopic> topics{odometry("/odometry/filtered"),
                                          odometry("/odometry/gps")};
  EXPECT_THAT(errorOf([&] { chooseOdometryTopic(topics, "", false); }),
              HasSubstr("/odometry/filtered (nav_msgs/Odometry), /odometry/gps"));
  EXPECT_EQ(chooseOdometryTopic(topics, "", true), "") << "tf decides";
}

TEST(TopicChoice, WishedTopicMustBeThereAndOfTheRightType) {
  const std::vector<RecordedTopic> topics{scan("/scan"), odometry("/odom")};
  EXPECT_EQ(chooseScanTopic(topics, "scan"), "/scan");
  EXPECT_THAT(errorOf([&] { chooseOdometryTopic(topics, "/odm", false); }),
              HasSubstr("no topic /odm; topics of type nav_msgs/Odometry: /odom"));
  EXPECT_THAT(errorOf([&] { chooseScanTopic(topics, "/odom"); }),
              HasSubstr("/odom carries nav_msgs/Odometry"));
}

TEST(TopicChoice, GroundTruthIsTakenOnlyIfItIsWishedFor) {
  const std::vector<RecordedTopic> topics{odometry("/ground_truth/odom")};
  EXPECT_EQ(chooseOdometryTopic(topics, "", false), "");
  EXPECT_EQ(chooseOdometryTopic(topics, "/ground_truth/odom", false), "/ground_truth/odom");
}

TEST(TopicChoice, NamesWhatWasNotTaken) {
  EXPECT_EQ(otherTopics({scan("/scan"), scan("/camera/scan"), {"/tf", "tf2_msgs/TFMessage", 1}},
                        "/scan", ""),
            "/camera/scan (sensor_msgs/LaserScan)");
  EXPECT_EQ(otherTopics({scan("/scan")}, "/scan", ""), "");
}

TEST(TopicChoice, WithoutScansTheTopicsThatAreThereAreListed) {
  EXPECT_THAT(
      errorOf([] { chooseScanTopic({odometry("/odom")}, ""); }),
      HasSubstr("has no scans (sensor_msgs/LaserScan); its topics: /odom (nav_msgs/Odometry)"));
  EXPECT_THAT(errorOf([] { chooseScanTopic({}, ""); }), HasSubstr("its topics: none"));
}

TEST(TopicChoice, TheSameNameWithAndWithoutASlashIsOneTopic) {
  EXPECT_TRUE(isSameTopic("/scan", "scan"));
  EXPECT_FALSE(isSameTopic("/base/scan", "scan"));
  EXPECT_FALSE(isSameTopic("//scan", "scan"));
}

}  // namespace
}  // namespace ramscout_bringup
