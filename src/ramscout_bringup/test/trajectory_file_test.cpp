// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/trajectory_file.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace ramscout_bringup {
namespace {

class TrajectoryFile : public testing::Test {
protected:
  std::string write(const std::string& text) {
    std::ofstream(path_) << text;
    return path_;
  }
  void TearDown() override { std::remove(path_.c_str()); }

  std::string path_ = testing::TempDir() + "trajectory_file_test.tum";
};

TEST_F(TrajectoryFile, RoundTripKeepsStampsExactlyAndPosesToTheWrittenDigits) {
  const Trajectory written{{1700000000123456789, {1.25, -2.5, 3.0}},
                           {1700000000999999999, {0.0, 0.0, -3.14}}};
  const Trajectory read = readTrajectory(write(toTum(written)));
  ASSERT_EQ(read.size(), 2u);
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].stamp_ns, written[i].stamp_ns);
    EXPECT_NEAR(read[i].pose.x_m, written[i].pose.x_m, 1e-6);
    EXPECT_NEAR(read[i].pose.y_m, written[i].pose.y_m, 1e-6);
    EXPECT_NEAR(read[i].pose.yaw_rad, written[i].pose.yaw_rad, 1e-8);
  }
  EXPECT_EQ(toTum(read), toTum(written));
}

TEST_F(TrajectoryFile, CommentsAreSkippedAndPosesSorted) {
  const Trajectory read = readTrajectory(
      write("# stamp x y z qx qy qz qw\n\n2.5 1 0 0 0 0 0 1 # b\n1 2 0 0 0 0 0 1\n"));
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].stamp_ns, 1000000000);
  EXPECT_EQ(read[1].stamp_ns, 2500000000);
}

TEST_F(TrajectoryFile, StampsWithExponentsAreTheSameNumbers) {
  const Trajectory read = readTrajectory(
      write("1.600000000029999971e+09 0 0 0 0 0 0 1\n1.6E9 0 0 0 0 0 0 1\n25e-1 0 0 0 0 0 0 1\n"));
  ASSERT_EQ(read.size(), 3u);
  EXPECT_EQ(read[0].stamp_ns, 2500000000);
  EXPECT_EQ(read[1].stamp_ns, 1600000000000000000);
  EXPECT_EQ(read[2].stamp_ns, 1600000000029999971);
  for (const char* stamp : {"1e99", "1e", "e9", "1.5e+x"})
    EXPECT_THROW(readTrajectory(write(std::string(stamp) + " 0 0 0 0 0 0 1\n")), std::runtime_error)
        << stamp;
}

TEST_F(TrajectoryFile, TrajectoryInTheAxesOfACameraIsRefused) {
  EXPECT_THROW(readTrajectory(write("1 0 0 0 0 0.7071068 0 0.7071068\n")), std::runtime_error);
  EXPECT_THROW(readTrajectory(write("1 0 0 0 0 0 0 1\n2 1 0 8 0 0 0 1\n")), std::runtime_error);
  EXPECT_EQ(readTrajectory(write("1 0 0 90 0 0 0 1\n2 9 0 90.8 0 0.04 0 0.9992\n")).size(), 2u)
      << "a ramp on the thirtieth floor";
}

TEST_F(TrajectoryFile, MalformedLinesAreNamed) {
  for (const char* text :
       {"1 2 3\n", "1 2 3 0 0 0 0 nan\n", "x 1 2 3 4 5 6 7\n", "1 2 3 0 0 0 0 1,0\n"}) {
    try {
      readTrajectory(write(text));
      FAIL() << text;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(":1:"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(readTrajectory(write("# nothing\n")), std::runtime_error);
  EXPECT_THROW(readTrajectory("/does/not/exist"), std::runtime_error);
}

TEST_F(TrajectoryFile, ATrajectoryThatIsNotPlanarIsRefused) {
  const auto refusalOf = [this](const std::string& text) -> std::string {
    try {
      readTrajectory(write(text));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string camera = "1 0 0 0 0.5 0.5 0.5 0.5\n2 0 0 1 0.5 0.5 0.5 0.5\n";
  EXPECT_NE(refusalOf(camera).find("does not lie in the x-y plane"), std::string::npos);
  const std::string climbs = "1 0 0 0 0 0 0 1\n2 1 0 50 0 0 0 1\n";
  EXPECT_NE(refusalOf(climbs).find("z over 50"), std::string::npos);
  EXPECT_EQ(refusalOf("1 0 0 0.5 0 0 0 1\n2 9 0 0.6 0.01 0 0 1\n"), "accepted");
}

TEST_F(TrajectoryFile, AYawIsTwiceTheAngleOfItsQuaternion) {
  const Trajectory read = readTrajectory(write("1 0 0 0 0 0 0.5 0.8660254037844386\n"));
  EXPECT_NEAR(read[0].pose.yaw_rad, M_PI / 3.0, 1e-12);
  EXPECT_NEAR(std::abs(readTrajectory(write("1 0 0 0 0 0 -1 0\n"))[0].pose.yaw_rad), M_PI, 1e-12);
}

TEST_F(TrajectoryFile, OfNothingIsAnEmptyText) {
  EXPECT_EQ(toTum({}), "");
  EXPECT_EQ(toTum({{1'000'000'007, {0.5, -1.0, 0.0}}}),
            "1.000000007 0.500000 -1.000000 0 0 0 0.000000000 1.000000000\n");
}

}  // namespace
}  // namespace ramscout_bringup
