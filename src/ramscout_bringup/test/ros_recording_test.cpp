// SPDX-License-Identifier: BSD-3-Clause
// What is found out about a recording: each test is a kind of recording that robots leave.
#include "../ros/ros_recording.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <gmock/gmock.h>

#include "recorded_drive.hpp"

namespace ramscout_bringup_ros {
namespace {

using ramscout_bringup::RecordingOptions;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

RosRecording open(const Drive& drive, const RecordingOptions& options = {}) {
  return {std::make_unique<Memory>(drive.messages), options};
}

std::string errorOf(const Drive& drive, const RecordingOptions& options = {}) {
  try {
    open(drive, options);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

struct Content {
  std::vector<ram_slam::MountedScan> scans;
  std::vector<ram_slam::StampedPose2> odometry;
  bool is_in_order = true;
};
Content readAll(RosRecording& recording) {
  Content content;
  std::int64_t last_ns = 0;
  while (auto reading = recording.next()) {
    std::int64_t stamp_ns = 0;
    if (auto* mounted = std::get_if<ram_slam::MountedScan>(&*reading)) {
      stamp_ns = mounted->scan.stamp_ns;
      content.scans.push_back(std::move(*mounted));
    } else {
      stamp_ns = std::get<ram_slam::StampedPose2>(*reading).stamp_ns;
      content.odometry.push_back(std::get<ram_slam::StampedPose2>(*reading));
    }
    content.is_in_order = content.is_in_order && stamp_ns >= last_ns;
    last_ns = stamp_ns;
  }
  return content;
}

TEST(RosRecording, GivesScansAndOdometryInTheOrderOfTheirStampsHoweverTheFileWasWritten) {
  RosRecording recording = open(Drive().withOdometry().withScans());  // one topic after the other
  const Content content = readAll(recording);
  EXPECT_THAT(content.scans, SizeIs(100U));
  EXPECT_THAT(content.odometry, SizeIs(201U));
  EXPECT_TRUE(content.is_in_order);
  EXPECT_NEAR(content.scans[0].base_from_laser.x_m, 0.2, 1e-12);
  EXPECT_THAT(recording.notes(), Contains("odometry: 201 of /odom"));
  EXPECT_THAT(recording.notes(), Contains("scans: 100 of /scan, 5.0 Hz, 5 beams over 143 deg"));
}

TEST(RosRecording, ATopicMayCarryMessagesOfOtherTypesBetweenTheScans) {
  Drive drive = Drive().withScans();
  drive.messages.insert(drive.messages.begin() + 5, message("/scan", 0.5, odometry(0.5, 0.0)));
  RosRecording recording = open(drive);
  EXPECT_THAT(readAll(recording).scans, SizeIs(100U));
}

/// Gives one more scan when it is read again, as a database does whose index is damaged.
class Growing : public Memory {
public:
  using Memory::Memory;
  void restart(const std::vector<std::string>& topics) override {
    Memory::restart(topics);
    ++readings_;
    is_extended_ = false;
  }
  std::optional<RecordedMessage> next() override {
    auto message_read = Memory::next();
    if (message_read || readings_ < 2 || is_extended_) return message_read;
    is_extended_ = true;
    return message("/scan", 30.0, scan(30.0));
  }

private:
  int readings_ = 0;
  bool is_extended_ = false;
};

TEST(RosRecording, AScanThatOnlyTheSecondReadingGivesIsLeftOutAndCounted) {
  const Drive drive = Drive().withScans();
  RosRecording recording(std::make_unique<Growing>(drive.messages), {});
  EXPECT_THAT(readAll(recording).scans, SizeIs(100U));
  std::size_t readings = 0;
  while (recording.next()) ++readings;
  EXPECT_EQ(readings, 0U);
  EXPECT_THAT(recording.notes(), Contains(HasSubstr("left out 1 scans: the damaged file")));
}

TEST(RosRecording, ScanInTheBaseFrameNeedsNoTf) {
  Drive drive = Drive().withScans().withOdometry();
  drive.messages.erase(drive.messages.begin());
  drive.change<sensor_msgs::LaserScan>([](auto& scan) { scan.header.frame_id = "base_link"; });
  RosRecording recording = open(drive);
  EXPECT_EQ(readAll(recording).scans.front().base_from_laser.x_m, 0.0);
}

TEST(RosRecording, WithoutAnyTfTheMountIsAssumedAndSaidSo) {
  Drive drive = Drive().withScans().withOdometry();
  drive.messages.erase(drive.messages.begin());
  EXPECT_THAT(open(drive).notes(),
              Contains(HasSubstr("laser frame 'laser' is assumed at 'base_link'")));
  RecordingOptions options;
  options.base_from_laser = ram_slam::Pose2{0.3, 0.0, M_PI};
  RosRecording recording = open(drive, options);
  EXPECT_EQ(readAll(recording).scans.front().base_from_laser.x_m, 0.3);
}

TEST(RosRecording, TransformWhoseRotationIsAllZerosIsLeftOutAndCounted) {
  Drive drive = Drive().withScans();
  drive.messages.push_back(message("/tf_static", 0.0, transform("base_link", "mast", 0.0, 0.0)));
  drive.change<tf2_msgs::TFMessage>([](auto& tf) {
    if (tf.transforms[0].child_frame_id == "laser") tf.transforms[0].transform.rotation.w = 0.0;
  });
  EXPECT_THAT(errorOf(drive), HasSubstr("frames: base_link, mast"));
  RecordingOptions options;
  options.base_from_laser = ram_slam::Pose2{};
  EXPECT_THAT(open(drive, options).notes(), Contains(HasSubstr("left out 1 transforms")));
}

TEST(RosRecording, LaserThatTfDoesNotKnowIsRefusedWithTheFramesThereAre) {
  Drive drive = Drive().withScans();
  drive.change<sensor_msgs::LaserScan>([](auto& scan) { scan.header.frame_id = "lidar"; });
  EXPECT_THAT(errorOf(drive),
              HasSubstr("laser's frame 'lidar' to 'base_link'; frames: base_link, laser"));
}

TEST(RosRecording, EachLaserOfATopicHasItsOwnMount) {
  Drive drive = Drive().withScans();
  drive.messages.push_back(
      message("/tf_static", 0.0, transform("base_link", "rear", 0.0, -0.2, M_PI)));
  drive.messages.push_back(message("/scan", 3.05, scan(3.05, "rear")));
  std::stable_sort(drive.messages.begin(), drive.messages.end(),
                   [](const auto& a, const auto& b) { return a.received_ns < b.received_ns; });
  RosRecording recording = open(drive);
  const Content content = readAll(recording);
  EXPECT_NEAR(content.scans[16].base_from_laser.x_m, -0.2, 1e-12);
  EXPECT_NEAR(content.scans[17].base_from_laser.x_m, 0.2, 1e-12);
  EXPECT_THAT(recording.notes(), Contains(HasSubstr("several lasers")));
}

TEST(RosRecording, LaserUpsideDownIsTurnedUp) {
  Drive drive = Drive().withScans();
  auto& rotation = std::get<tf2_msgs::TFMessage>(drive.messages.front().content)
                       .transforms[0]
                       .transform.rotation;
  rotation.x = 1.0;
  rotation.w = 0.0;
  RosRecording recording = open(drive);
  EXPECT_DOUBLE_EQ(readAll(recording).scans.front().scan.angle_min_rad, 1.0);
}

TEST(RosRecording, OdometryOnTfIsFollowedOverTheChain) {
  Drive drive = Drive().withScans();
  for (int i = 0; i <= 200; ++i)
    drive.messages.push_back(
        message("/tf", 0.1 * i, transform("odom", "base_footprint", 0.1 * i, 0.05 * i)));
  drive.messages.push_back(
      message("/tf_static", 0.0, transform("base_footprint", "base_link", 0.0, 0.0)));
  RosRecording recording = open(drive);
  EXPECT_THAT(recording.notes(), Contains("odometry: 201 of tf odom -> base_link"));
  EXPECT_NEAR(readAll(recording).odometry.back().pose.x_m, 10.0, 1e-9);
}

TEST(RosRecording, FramesOfOtherNamesAreFoundFromTheLaserUpwards) {
  Drive drive;
  drive.messages = {message("/tf_static", 0.0, transform("chassis", "laser", 0.0, 0.4))};
  drive.withScans();
  for (int i = 0; i <= 200; ++i) {
    drive.messages.push_back(
        message("/tf", 0.1 * i, transform("world", "chassis", 0.1 * i, 0.05 * i)));
  }
  RosRecording recording = open(drive);
  EXPECT_THAT(recording.notes(), Contains("odometry: 201 of tf world -> chassis"));
  EXPECT_NEAR(readAll(recording).scans[0].base_from_laser.x_m, 0.4, 1e-12);
}

TEST(RosRecording, OdometryOfACameraIsBroughtToTheBase) {
  Drive drive = Drive().withScans().withOdometry("/camera/odom", "camera");
  drive.messages.push_back(
      message("/tf_static", 0.0, transform("base_link", "camera", 0.0, 0.3, M_PI)));
  RosRecording recording = open(drive);
  const Content content = readAll(recording);
  const ram_slam::Pose2 moved =
      content.odometry.front().pose.inverse() * content.odometry.back().pose;
  EXPECT_NEAR(moved.x_m, -10.0, 1e-9) << "the camera looks back";
  EXPECT_THAT(recording.notes(),
              Contains(HasSubstr("odometry of 'camera' is brought to 'base_link'")));
}

TEST(RosRecording, OdometryOfAFrameThatTfDoesNotKnowIsRefused) {
  EXPECT_THAT(errorOf(Drive().withScans().withOdometry("/odom", "camera")),
              HasSubstr("/odom gives the pose of 'camera'"));
}

TEST(RosRecording, TwistIsIntegratedWhereThePoseIsNeverFilledIn) {
  Drive drive = Drive().withScans().withOdometry();
  drive.change<nav_msgs::Odometry>([](auto& odometry) {
    odometry.pose.pose.position.x = 0.0;
    odometry.twist.twist.linear.x = 0.5;
  });
  RosRecording recording = open(drive);
  EXPECT_THAT(recording.notes(),
              Contains("odometry: 201 of /odom, its twist integrated: its poses never move"));
  EXPECT_NEAR(readAll(recording).odometry.back().pose.x_m, 10.0, 1e-9);
}

TEST(RosRecording, OdometryThatNeverMovesIsLeftOut) {
  Drive drive = Drive().withScans().withOdometry();
  drive.change<nav_msgs::Odometry>([](auto& odometry) { odometry.pose.pose.position.x = 1.0; });
  EXPECT_THAT(open(drive).notes(), Contains("no odometry: /odom never moves"));
}

TEST(RosRecording, OdometryThatEndsEarlyIsNoted) {
  Drive drive = Drive().withScans().withOdometry();
  drive.messages.resize(drive.messages.size() - 100);
  EXPECT_THAT(open(drive).notes(), Contains(HasSubstr("odometry ends 9.8 s before the scans")));
}

TEST(RosRecording, ClocksApartAreNamedWithTheirOffset) {
  Drive drive = Drive().withScans().withOdometry();
  drive.change<sensor_msgs::LaserScan>(
      [](auto& scan) { scan.header.stamp += ros::Duration(3624.0); });
  EXPECT_THAT(errorOf(drive), HasSubstr("3624.0 s ahead of those of /odom"));
  RecordingOptions options;
  options.scan_clock_offset_s = -3624.0;
  RosRecording recording = open(drive, options);
  EXPECT_TRUE(readAll(recording).is_in_order);
  EXPECT_THAT(recording.notes(), Contains("stamps of the scans shifted by -3624.000 s"));
}

TEST(RosRecording, StampsThatRepeatAreReplacedByTheTimesOfRecording) {
  Drive drive = Drive().withScans();
  drive.change<sensor_msgs::LaserScan>(
      [](auto& scan) { scan.header.stamp = ros::Time(scan.header.stamp.sec, 0); });
  RosRecording recording = open(drive);
  EXPECT_THAT(recording.notes(),
              Contains(HasSubstr("100 messages of /scan have only 20 different stamps")));
  EXPECT_NEAR(1e-9 * static_cast<double>(readAll(recording).scans[7].scan.stamp_ns), 1001.4, 1e-6);
}

TEST(RosRecording, DriveAfterTheClockWasSetBackIsReadByItself) {
  Drive drive = Drive().withScans();
  for (int i = 0; i < 50; ++i)
    drive.messages.push_back(message("/scan", 30.0 + 0.2 * i, scan(0.2 * i)));
  EXPECT_THAT(errorOf(drive), HasSubstr("read one of them with --part 1 to 2"));
  RecordingOptions options;
  options.part = 2;
  RosRecording recording = open(drive, options);
  EXPECT_THAT(readAll(recording).scans, SizeIs(50U));
}

TEST(RosRecording, ScanThatIsRefusedIsCountedWithItsReason) {
  Drive drive = Drive().withScans();
  drive.change<sensor_msgs::LaserScan>([](auto& scan) { scan.angle_increment = 28.6F; });
  RosRecording recording = open(drive);
  EXPECT_THAT(readAll(recording).scans, SizeIs(0U));
  EXPECT_THAT(recording.notes(), Contains(HasSubstr("left out 100 scans: scan over 114.4")));
  EXPECT_EQ(recording.scanCount(), 100U);
}

TEST(RosRecording, ReadingsAtTheLimitAndScansWithoutLimitAreNoted) {
  Drive drive = Drive().withScans();
  drive.change<sensor_msgs::LaserScan>([](auto& scan) { scan.ranges[0] = 8.0F; });
  RosRecording recording = open(drive);
  EXPECT_EQ(readAll(recording).scans[0].scan.ranges_m[0], kInfinity);
  EXPECT_THAT(recording.notes(),
              Contains("100 readings at range_max (8.00 m) mean that nothing came back"));
  drive.change<sensor_msgs::LaserScan>([](auto& scan) { scan.range_max = kInfinity; });
  EXPECT_THAT(open(drive).notes(),
              Contains("100 scans name no limit of their range: 100 m is assumed"));
}

TEST(RosRecording, CodeForNothingBelowTheLimitIsRecognised) {
  Drive drive = Drive().withScans();
  drive.change<sensor_msgs::LaserScan>([](auto& scan) {
    scan.range_max = 100.0F;
    scan.ranges[1] = 81.83F;
  });
  RosRecording recording = open(drive);
  EXPECT_EQ(readAll(recording).scans[5].scan.ranges_m[1], kInfinity);
  EXPECT_THAT(recording.notes(),
              Contains("readings of 81.83 m and more mean that nothing came back"));
}

TEST(RosRecording, ReadingsThatScatterBelowACodeAtTheLimitMeanTheSame) {
  Drive drive = Drive().withScans();
  int count = 0;
  drive.change<sensor_msgs::LaserScan>([&count](auto& scan) {
    scan.ranges[1] = ++count % 2 == 0 ? 8.0F : 7.95F + 0.0001F * static_cast<float>(count);
  });
  RosRecording recording = open(drive);
  for (const ram_slam::MountedScan& mounted : readAll(recording).scans)
    EXPECT_EQ(mounted.scan.ranges_m[1], kInfinity);
}

TEST(RosRecording, SweepComesFromTheRateWhereTimeIncrementCannotBeTrue) {
  Drive drive = Drive().withScans();
  drive.change<sensor_msgs::LaserScan>([](auto& scan) { scan.time_increment = 150000.0F; });
  RosRecording recording = open(drive);
  const double share = 5 * 0.5 / (2.0 * M_PI);  // of a turn
  EXPECT_NEAR(readAll(recording).scans[0].scan.time_increment_s, 0.2 * share / 5, 1e-9);
  EXPECT_THAT(recording.notes(), Contains(HasSubstr("assumed from the rate of the scans")));
}

TEST(RosRecording, ReadingsAreTakenInTheDirectionThatIsAskedFor) {
  RecordingOptions options;
  options.sweep_direction = ram_slam::SweepDirection::kClockwise;
  Drive drive = Drive().withScans();
  drive.change<sensor_msgs::LaserScan>([](auto& scan) { scan.ranges[0] = 4.0F; });
  RosRecording recording = open(drive, options);
  const ram_slam::LaserScan scan = readAll(recording).scans[0].scan;
  EXPECT_DOUBLE_EQ(scan.angle_min_rad, 1.0);
  EXPECT_EQ(scan.ranges_m.back(), 4.0F);
}

TEST(RosRecording, TopicsThatAreNotUsedAreNamed) {
  Drive drive = Drive().withScans().withOdometry();
  drive.messages.push_back(message("/camera/scan", 0.0, scan(0.0)));
  EXPECT_THAT(open(drive).notes(), Contains("not used: /camera/scan (sensor_msgs/LaserScan)"));
}

TEST(RosRecording, BaseFrameComesFromTheOdometryWhereThereIsNoBaseLink) {
  Drive drive;
  drive.messages = {message("/tf_static", 0.0, transform("chassis", "laser", 0.0, 0.4))};
  drive.withScans().withOdometry("/odom", "chassis");
  RosRecording recording = open(drive);
  EXPECT_THAT(recording.notes(), Contains("base frame: chassis"));
  EXPECT_NEAR(readAll(recording).scans[0].base_from_laser.x_m, 0.4, 1e-12);
  RecordingOptions options;
  options.base_frame = "base";
  EXPECT_THAT(errorOf(drive, options),
              HasSubstr("no frame 'base' (--base-frame); its frames: chassis, laser"));
}

}  // namespace
}  // namespace ramscout_bringup_ros
