// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/parameter_files.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ramscout_bringup {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ParameterFolder : public testing::Test {
protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_ + "/robots");
    std::filesystem::create_directories(folder_ + "/lidars");
    write("simulator", "seed: 7\nlidar: {beams: 100, scan_rate_hz: 40}\n");
    write("robots/car", "kinematics: {model: ackermann}\nsimulator: {laser_frame: front}\n");
    write("lidars/small", "simulator: {lidar: {beams: 10}}\n");
    write("kinematics", "{}\n");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& yaml) const {
    std::ofstream(folder_ + "/" + name + ".yaml") << yaml;
  }
  std::string refusal(const std::string& robot, const std::string& lidar) const {
    try {
      ParameterFiles(folder_, robot, lidar);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "accepted";
  }

  std::string folder_ = testing::TempDir() + "parameter_files_test_" +
                        testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(ParameterFolder, GivesTheNodesOwnValuesWithoutRobotAndLidar) {
  int beams = 0;
  ParameterFiles(folder_).reader("simulator").read("lidar/beams", beams);
  EXPECT_EQ(beams, 100);
}

TEST_F(ParameterFolder, OverridesOnlyWhatRobotAndLidarState) {
  const ParameterFiles files(folder_, "car", "small");
  int beams = 0;
  int seed = 0;
  double rate_hz = 0.0;
  std::string frame;
  std::string model;
  ram_parameters::ParameterReader simulator = files.reader("simulator");
  simulator.read("lidar/beams", beams);
  simulator.read("lidar/scan_rate_hz", rate_hz);
  simulator.read("seed", seed);
  simulator.read("laser_frame", frame);
  files.reader("kinematics").read("model", model);
  EXPECT_EQ(beams, 10);
  EXPECT_EQ(rate_hz, 40.0);
  EXPECT_EQ(seed, 7);
  EXPECT_EQ(frame, "front");
  EXPECT_EQ(model, "ackermann");
  EXPECT_EQ(files.urdf(), folder_ + "/robots/car.urdf");
}

TEST_F(ParameterFolder, TakesARobotByItsPath) {
  std::string model;
  ParameterFiles(folder_, folder_ + "/robots/car").reader("kinematics").read("model", model);
  EXPECT_EQ(model, "ackermann");
}

TEST_F(ParameterFolder, ReadsASectionOfANodeThatRunsAnotherProgram) {
  write("ekf_slam", "{}\n");
  write("lidars/small", "fast_slam: {association_gate: 3}\n");
  double gate = 0.0;
  ParameterFiles(folder_, "", "small")
      .reader("ekf_slam", "fast_slam")
      .read("association_gate", gate);
  EXPECT_EQ(gate, 3.0);
}

TEST_F(ParameterFolder, RefusesAMissingFileAndASectionOfNoNode) {
  EXPECT_EQ(refusal("car", "small"), "accepted");
  EXPECT_THAT(refusal("cart", ""), HasSubstr("robots/cart.yaml"));
  write("lidars/small", "simulater: {}\n");
  EXPECT_THAT(refusal("", "small"), AllOf(HasSubstr("small.yaml"), HasSubstr("'simulator'")));
  write("lidars/small", "simulator: 3\n");
  EXPECT_THAT(refusal("", "small"), HasSubstr("small.yaml/simulator"));
}

TEST_F(ParameterFolder, NamesAllFilesInTheRefusalOfAValue) {
  write("lidars/small", "simulator: {lidar: {beams: many}}\n");
  int beams = 0;
  try {
    ParameterFiles(folder_, "", "small").reader("simulator").read("lidar/beams", beams);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("simulator.yaml"), HasSubstr("small.yaml")));
  }
}

}  // namespace
}  // namespace ramscout_bringup
