// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/simulator_node_parameters.hpp"

#include <gmock/gmock.h>

#include "ramscout_sim/parameter_files.hpp"

namespace ramscout_sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

SimulatorNodeParameters readText(const std::string& yaml) {
  ram_parameters::ParameterReader reader(YAML::Load(yaml), "simulator");
  return readSimulatorNodeParameters(reader);
}

std::string refusalOf(const std::string& yaml) {
  try {
    readText(yaml);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

std::vector<std::string> namesOf(const SimulatorNodeParameters& parameters) {
  std::vector<std::string> names;
  for (const RobotParameters& robot : parameters.robots) names.push_back(robot.name);
  return names;
}

TEST(SimulatorNodeParameters, WithoutNamesHaveOneRobotWithout) {
  const SimulatorNodeParameters p = readText("{start: [1, 2, 3], laser_frame: lidar}");
  ASSERT_THAT(p.robots, SizeIs(1));
  EXPECT_THAT(p.robots[0].name, IsEmpty());
  EXPECT_THAT(p.robots[0].start, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_EQ(p.robots[0].laser_frame, "lidar");
}

TEST(SimulatorNodeParameters, OfARobotOverrideThoseOfAllRobots) {
  const SimulatorNodeParameters p = readText(
      "{robots: [alpha, beta], tour: round.yaml, alpha: {start: [1, 6, 0]}, "
      "beta: {start: [5, 6, 3.1], tour: straight.yaml}}");
  EXPECT_THAT(namesOf(p), ElementsAre("alpha", "beta"));
  EXPECT_EQ(p.robots[0].tour, "round.yaml");
  EXPECT_EQ(p.robots[1].tour, "straight.yaml");
  EXPECT_THAT(p.robots[1].start, ElementsAre(5.0, 6.0, 3.1));
}

TEST(SimulatorNodeParameters, RefuseNamesThatNoTopicCanHave) {
  for (const char* name : {"a/b", "~a", "1st", "a b", "a-b"}) {
    EXPECT_THAT(refusalOf("{robots: ['" + std::string(name) + "']}"),
                HasSubstr("is no name for a robot"));
  }
  EXPECT_THAT(refusalOf("{robots: [a, a]}"), HasSubstr("two called 'a'"));
}

TEST(SimulatorNodeParameters, RefuseUnknownKeysOnEveryLevel) {
  EXPECT_THAT(refusalOf("{wrold: x.yaml}"), HasSubstr("wrold"));
  EXPECT_THAT(refusalOf("{lidar: {baems: 3}}"), HasSubstr("baems"));
  EXPECT_THAT(refusalOf("{robots: [a], a: {name: b}}"), HasSubstr("name"));
  EXPECT_THAT(refusalOf("{alpha: {start: [1, 6, 0]}}"), HasSubstr("alpha"));
}

TEST(SimulatorNodeParameters, RefuseValuesOutOfBoundsByTheirName) {
  EXPECT_THAT(refusalOf("{start: [1, 2]}"), HasSubstr("start must be [x, y, yaw] or empty"));
  EXPECT_THAT(refusalOf("{robots: [a], a: {start: [1]}}"), HasSubstr("start must be"));
  EXPECT_THAT(refusalOf("{real_time_factor: -1}"), HasSubstr("real_time_factor must be in"));
  EXPECT_THAT(refusalOf("{real_time_factor: 1001}"), HasSubstr("in [0, 1000]"));
  EXPECT_THAT(refusalOf("{clock_rate_hz: 2000}"), HasSubstr("clock_rate_hz must be"));
  EXPECT_THAT(refusalOf("{lock_step_timeout_s: 0}"), HasSubstr("lock_step_timeout_s must be"));
  EXPECT_THAT(refusalOf("{lock_step_start_timeout_s: -1}"), HasSubstr("lock_step_start_timeout_s"));
  EXPECT_THAT(refusalOf("{lidar: {beams: 1}}"), HasSubstr("lidar/beams must be in [2, 20000]"));
  EXPECT_THAT(refusalOf("{drive: {max_speed_mps: 0}}"), HasSubstr("drive/max_speed_mps"));
}

TEST(SimulatorNodeParameters, PresetOfTheLidarHoldsUntilAKeyOverridesIt) {
  const SimulatorNodeParameters p = readText("{lidar: {preset: urg_04lx, range_max_m: 4.0}}");
  EXPECT_EQ(p.simulation.lidar.beams, 682);
  EXPECT_EQ(p.simulation.lidar.range_max_m, 4.0);
  EXPECT_EQ(p.simulation.lidar.range_min_m, 0.02);
  EXPECT_THAT(refusalOf("{lidar: {preset: unknown}}"), HasSubstr("lidar/preset must be"));
}

TEST(ParameterFiles, ShippedFileHoldsTheDefaultsOfEveryKeyThatIsNotForExperts) {
  const auto files = parameterFiles();
  ASSERT_THAT(files, SizeIs(1));
  EXPECT_EQ(files[0].name, "simulator.yaml");
  const std::string path = std::string(CONFIG_FOLDER) + "/" + files[0].name;
  const YAML::Node shipped = ram_parameters::readYamlFile(path);
  ram_parameters::ParameterReader reader(shipped, path);
  const auto rows = SimulatorNodeParameters::table().rows(readSimulatorNodeParameters(reader));
  ASSERT_EQ(rows.size(), files[0].rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].value, files[0].rows[i].value) << rows[i].key;
    ram_parameters::ParameterReader keys(shipped, path);
    EXPECT_EQ(keys.has(rows[i].key), !rows[i].is_expert) << rows[i].key;
  }
}

TEST(ParameterFiles, GeneratedFileReadsBackAsTheDefaults) {
  const auto rows = SimulatorNodeParameters::table().rows(
      readText(ram_parameters::toYaml(parameterFiles().front())));
  const auto defaults = SimulatorNodeParameters::table().rows();
  for (std::size_t i = 0; i < rows.size(); ++i)
    EXPECT_EQ(rows[i].value, defaults[i].value) << rows[i].key;
}

}  // namespace
}  // namespace ramscout_sim
