// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/carmen_recording.hpp"

#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <variant>

#include <gmock/gmock.h>

namespace ramscout_bringup {
namespace {

using ram_slam::MountedScan;
using ram_slam::StampedPose2;
using ::testing::Contains;
using ::testing::HasSubstr;

class CarmenRecordingTest : public ::testing::Test {
protected:
  void TearDown() override { std::remove(path_.c_str()); }

  std::string write(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return path_;
  }
  /// A line of a base at (x, 2) m with its laser 0.1 m ahead.
  static std::string line(double x_m, int stamp_s) {
    return "FLASER 2 1.0 2.0 " + std::to_string(x_m + 0.1) + " 2.0 0.0 " + std::to_string(x_m) +
           " 2.0 0.0 " + std::to_string(stamp_s) + " host 7.5\n";
  }

  std::string path_ = ::testing::TempDir() + "carmen_recording_test.clf";
};

TEST_F(CarmenRecordingTest, EachScanFollowsTheOdometryOfItsStamp) {
  CarmenRecording recording(write(line(1.0, 10) + line(1.5, 11)));
  for (const std::int64_t stamp_ns : {10'000'000'000, 11'000'000'000}) {
    const auto odometry = recording.next();
    ASSERT_TRUE(odometry && std::holds_alternative<StampedPose2>(*odometry));
    EXPECT_EQ(std::get<StampedPose2>(*odometry).stamp_ns, stamp_ns);
    const auto scan = recording.next();
    ASSERT_TRUE(scan && std::holds_alternative<MountedScan>(*scan));
    EXPECT_EQ(std::get<MountedScan>(*scan).scan.stamp_ns, stamp_ns);
    EXPECT_NEAR(std::get<MountedScan>(*scan).base_from_laser.x_m, 0.1, 1e-9);
  }
  EXPECT_FALSE(recording.next());
  EXPECT_FALSE(recording.next()) << "the end stays the end";
}

TEST_F(CarmenRecordingTest, OdometryThatNeverMovesIsLeftOut) {
  CarmenRecording recording(write(line(1.0, 10) + line(1.0, 11)));
  for (int i = 0; i < 2; ++i) {
    const auto reading = recording.next();
    ASSERT_TRUE(reading);
    EXPECT_TRUE(std::holds_alternative<MountedScan>(*reading));
  }
  EXPECT_FALSE(recording.next());
}

TEST_F(CarmenRecordingTest, ProgressIsTheShareOfTheScans) {
  CarmenRecording recording(write(line(1.0, 10) + line(1.5, 11) + line(2.0, 12) + line(2.5, 13)));
  EXPECT_EQ(recording.progress(), 0.0);
  recording.next();
  EXPECT_EQ(recording.progress(), 0.0) << "odometry only";
  recording.next();
  EXPECT_EQ(recording.progress(), 0.25);
  while (recording.next()) continue;
  EXPECT_EQ(recording.progress(), 1.0);
}

TEST_F(CarmenRecordingTest, NotesStateCountsMountAndWhatWasLeftOut) {
  const CarmenRecording recording(
      write(line(1.0, 10) + line(1.5, 11) + line(1.6, 11) + "FLASER 2 1.0\n" + line(2.0, 12)));
  const auto notes = recording.notes();
  EXPECT_THAT(notes, Contains("scans: 3"));
  EXPECT_THAT(notes, Contains("odometry: 3"));
  EXPECT_THAT(notes, Contains(HasSubstr("x 0.1 m")));
  EXPECT_THAT(notes, Contains(HasSubstr("left out 1 laser lines: damaged")));
  EXPECT_THAT(notes, Contains(HasSubstr("1 scans with the stamp of another")));
}

TEST_F(CarmenRecordingTest, AFileWithoutScansIsRefusedByName) {
  try {
    CarmenRecording recording(write("# nothing\n"));
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("carmen_recording_test.clf"));
  }
}

}  // namespace
}  // namespace ramscout_bringup
