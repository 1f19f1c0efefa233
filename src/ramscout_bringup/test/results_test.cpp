// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/results.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <system_error>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "ram_slam/occupancy/map_file.hpp"
#include "ramscout_bringup/report.hpp"

namespace ramscout_bringup {
namespace {

namespace fs = std::filesystem;

MapLandmark exampleLandmark() {
  MapLandmark landmark;
  landmark.id = 7;
  landmark.type = "corner";
  landmark.classifier = "pg1:8x24:4.0:\"quoted\" #no comment";
  landmark.position_m = {1.25, -3.5};
  landmark.covariance_m2 << 0.25, 0.01, 0.01, 0.5;
  landmark.existence_log_odds = 4.5;
  return landmark;
}

/// A room of 2 x 1 m, driven through in two seconds.
Results exampleResults() {
  Results results;
  results.map.width = 40;
  results.map.height = 20;
  results.map.cells.assign(800, ram_slam::kFreeCell);
  results.map.cells[5] = ram_slam::kOccupiedCell;
  results.map.cells[6] = ram_slam::kUnknownCell;
  for (std::int64_t second = 1; second <= 3; ++second) {
    results.trajectory.push_back(
        {second * 1'000'000'000, {0.5 * static_cast<double>(second), 0.5, 0.0}});
  }
  results.trajectory_online = results.trajectory;
  results.landmarks = {exampleLandmark()};
  results.summary = {{"poses", 3}};
  return results;
}

class WriteResults : public testing::Test {
protected:
  void SetUp() override { fs::create_directory(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_))
      names.insert(entry.path().filename().string());
    return names;
  }

  std::string folder_ = testing::TempDir() + "results_test";
};

TEST(ToYaml, HasEachFieldOfEachLandmark) {
  const YAML::Node list = YAML::Load(toYaml({exampleLandmark(), MapLandmark()}))["landmarks"];
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0]["id"].as<int>(), 7);
  EXPECT_EQ(list[0]["type"].as<std::string>(), "corner");
  EXPECT_EQ(list[0]["classifier"].as<std::string>(), exampleLandmark().classifier);
  EXPECT_EQ(list[0]["position_m"].as<std::vector<double>>(), (std::vector<double>{1.25, -3.5}));
  EXPECT_EQ(list[0]["covariance_m2"].as<std::vector<double>>(),
            (std::vector<double>{0.25, 0.01, 0.01, 0.5}));
  EXPECT_EQ(list[0]["existence_log_odds"].as<double>(), 4.5);
}

TEST(ToYaml, OfNoLandmarksIsAnEmptyList) {
  const YAML::Node list = YAML::Load(toYaml({}))["landmarks"];
  ASSERT_TRUE(list.IsSequence());
  EXPECT_EQ(list.size(), 0U);
}

TEST_F(WriteResults, LeavesTheFilesOfARunAndNoOthers) {
  writeResults(exampleResults(), folder_);
  EXPECT_EQ(files(), (std::set<std::string>{"map.pgm", "map.yaml", "map.png", "trajectory.tum",
                                            "trajectory_online.tum", "landmarks.yaml",
                                            "summary.json", "report.html"}));
}

TEST_F(WriteResults, AddsWhatElseIsKnown) {
  Results results = exampleResults();
  results.trajectory_filter = results.trajectory;
  results.ground_truth = results.trajectory;
  results.pose_graph_g2o = "VERTEX_SE2 0 0 0 0\n";
  writeResults(results, folder_);
  for (const char* name : {"trajectory_filter.tum", "ground_truth.tum", "pose_graph.g2o"})
    EXPECT_EQ(files().count(name), 1U) << name;
}

TEST_F(WriteResults, MapTrajectoryAndSummaryAreReadBackTheSame) {
  const Results results = exampleResults();
  writeResults(results, folder_);
  EXPECT_EQ(ram_slam::loadMap(folder_ + "/map.yaml").cells, results.map.cells);
  const Trajectory read = readTrajectory(folder_ + "/trajectory.tum");
  ASSERT_EQ(read.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read[i].stamp_ns, results.trajectory[i].stamp_ns);
    EXPECT_NEAR(read[i].pose.x_m, results.trajectory[i].pose.x_m, 1e-6);
  }
  std::ifstream summary(folder_ + "/summary.json");
  EXPECT_EQ(nlohmann::json::parse(summary)["poses"], 3);
  std::ifstream report(folder_ + "/report.html");
  const std::string html((std::istreambuf_iterator<char>(report)),
                         std::istreambuf_iterator<char>());
  EXPECT_EQ(html, toHtml(results));
}

TEST_F(WriteResults, ReplacesTheFilesOfARunBefore) {
  Results results = exampleResults();
  writeResults(results, folder_);
  results.landmarks.clear();
  writeResults(results, folder_);
  EXPECT_EQ(YAML::LoadFile(folder_ + "/landmarks.yaml")["landmarks"].size(), 0U);
}

TEST_F(WriteResults, AFolderThatDoesNotExistIsAnError) {
  EXPECT_THROW(writeResults(exampleResults(), folder_ + "/none"), std::system_error);
}

}  // namespace
}  // namespace ramscout_bringup
