// SPDX-License-Identifier: BSD-3-Clause
#include "../benchmark/scenario.hpp"

#include <filesystem>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ramscout_bringup {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ScenarioFile : public testing::Test {
protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    write("world.yaml", "");
    write("tour.yaml", "");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ + "/" + name) << text;
    return folder_ + "/" + name;
  }
  std::string scenario(const std::string& more) const {
    return write("slip.yaml", "world: world.yaml\ntour: tour.yaml\n" + more);
  }
  std::string refusal(const std::string& more) const {
    try {
      readScenario(scenario(more));
    } catch (const std::exception& error) {
      return error.what();
    }
    return "accepted";
  }

  std::string folder_ = testing::TempDir() + "scenario_test_" +
                        testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(ScenarioFile, HasItsNameItsFilesBesideItItsFaultsAndItsLimits) {
  const Scenario read = readScenario(
      scenario("estimator: ekf_slam\nmost_s: 60\nfaults: [{kind: wheel_slip, start_s: 2, amount: "
               "0.3}]\nlimits: {ate_m: 0.1}\n"));
  EXPECT_EQ(read.name, "slip");
  EXPECT_EQ(read.world, folder_ + "/world.yaml");
  EXPECT_EQ(read.tour, folder_ + "/tour.yaml");
  EXPECT_EQ(read.estimator, "ekf_slam");
  EXPECT_DOUBLE_EQ(read.most_s, 60.0);
  ASSERT_EQ(read.faults.size(), 1U);
  EXPECT_EQ(read.faults[0].kind, ramscout_sim::FaultKind::kWheelSlip);
  EXPECT_DOUBLE_EQ(read.limits.at("ate_m"), 0.1);
}

TEST_F(ScenarioFile, IsOfTheReferenceRobotWithItsOwnLidarUnlessItNamesOthers) {
  const Scenario plain = readScenario(scenario("limits: {ate_m: 0.1}\n"));
  EXPECT_EQ(plain.robot, kReferenceRobot);
  EXPECT_EQ(plain.lidar, "");
  const Scenario other =
      readScenario(scenario("robot: car\nlidar: mine/lidar\nheading_offset_rad: 0.2\nestimator: "
                            "ukf_localiser\nmap_by: fast_slam\nlimits: {ate_m: 0.1}\n"));
  EXPECT_EQ(other.robot, "car");
  EXPECT_EQ(other.lidar, folder_ + "/mine/lidar");
  EXPECT_EQ(other.estimator, "ukf_localiser");
  EXPECT_EQ(other.map_by, "fast_slam");
  EXPECT_DOUBLE_EQ(other.heading_offset_rad, 0.2);
}

TEST_F(ScenarioFile, IsRefusedWithTheKeyThatIsWrong) {
  EXPECT_THAT(refusal("limits: {ate: 0.1}\n"), HasSubstr("ate"));
  EXPECT_THAT(refusal("limits: {ate_m: far}\n"), HasSubstr("ate_m"));
  EXPECT_THAT(refusal("limits: {ate_m: 0.1}\nspeed: 2\n"), HasSubstr("speed"));
  EXPECT_THAT(refusal("limits: {ate_m: 0.1}\nmost_s: 0\n"), HasSubstr("most_s"));
  EXPECT_THAT(refusal("limits: {ate_m: 0.1}\nrobots: car\n"), HasSubstr("'robot'"));
  EXPECT_THAT(refusal("limits: {ate_m: 0.1}\nrobot: ''\n"), HasSubstr("robot"));
  EXPECT_THAT(refusal("limits: {ate_m: 0.1}\nfaults: [{kind: rain}]\n"), HasSubstr("faults[0]"));
  EXPECT_THAT(refusal(""), HasSubstr("limits"));
}

TEST_F(ScenarioFile, IsRefusedIfAFileThatItNamesIsMissing) {
  std::filesystem::remove(folder_ + "/tour.yaml");
  EXPECT_THAT(refusal("limits: {ate_m: 0.1}\n"), HasSubstr("there is no file"));
}

TEST(ShippedScenarios, AreReadAndLimitTheTourAndTheLosses) {
  int count = 0;
  for (const auto& file : std::filesystem::directory_iterator(CONFIG_FOLDER "/scenarios")) {
    const Scenario scenario = readScenario(file.path());
    EXPECT_EQ(scenario.limits.count("tour_driven"), 1U) << file.path();
    EXPECT_EQ(scenario.limits.count("times_lost"), 1U) << file.path();
    ++count;
  }
  EXPECT_GT(count, 0);
}

TEST(Limits, AreTheMostOfAnErrorAndTheLeastOfAQuality) {
  Scenario scenario;
  scenario.limits = {{"ate_m", 0.1}, {"map_iou", 0.8}};
  EXPECT_THAT(brokenLimits(scenario, {{"ate_m", 0.1}, {"map_iou", 0.8}}), IsEmpty());
  EXPECT_THAT(brokenLimits(scenario, {{"ate_m", 0.2}, {"map_iou", 0.9}}),
              ElementsAre("ate_m is 0.2, must be at most 0.1"));
  EXPECT_THAT(brokenLimits(scenario, {{"ate_m", 0.05}, {"map_iou", 0.7}}),
              ElementsAre("map_iou is 0.7, must be at least 0.8"));
}

TEST(Limits, AreBrokenByAFigureThatIsMissingOrNoNumber) {
  Scenario scenario;
  scenario.limits = {{"ate_m", 0.1}};
  EXPECT_EQ(brokenLimits(scenario, {}).size(), 1U);
  EXPECT_EQ(brokenLimits(scenario, {{"ate_m", std::numeric_limits<double>::quiet_NaN()}}).size(),
            1U);
}

}  // namespace
}  // namespace ramscout_bringup
