// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/loop_search.hpp"

#include <gmock/gmock.h>

#include "key_scan_drive.hpp"

namespace ram_slam {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Ten key scans along the x axis, 1 m apart; their paths to the last one are 100 m.
struct Line {
  std::vector<KeyScan> keys = blindKeyScans(10, 1.0);
  std::vector<double> paths_m = std::vector<double>(10, 100.0);
  LoopSearchParameters parameters;

  Line() {
    parameters.max_view_distance_m = 1.5;
    parameters.drift_m_per_m = 0.0;
  }

  std::vector<std::size_t> candidates() const {
    return findLoopCandidates(keys, 9, paths_m, parameters);
  }
};

TEST(FindLoopCandidates, TakeTheNearestKeyScanOfAPassage) {
  Line line;
  line.keys[9].map_from_laser = {3.2, 0.0, 0.0};
  EXPECT_THAT(line.candidates(), ElementsAre(3));
}

TEST(FindLoopCandidates, TakeOneOfEachPassageTheNearestFirst) {
  Line line;
  line.keys[9].map_from_laser = {3.2, 0.0, 0.0};
  line.keys[8].map_from_laser = {3.1, 0.0, 0.0};  // a second passage
  EXPECT_THAT(line.candidates(), ElementsAre(8, 3));
}

TEST(FindLoopCandidates, LeaveOutWhatTheGraphKnowsAnyway) {
  Line line;
  line.keys[9].map_from_laser = {3.2, 0.0, 0.0};
  line.paths_m.assign(10, line.parameters.min_path_m - 0.1);
  EXPECT_THAT(line.candidates(), IsEmpty());
}

TEST(FindLoopCandidates, AllowForDriftUpToTheGreatestDistance) {
  Line line;
  line.keys[9].map_from_laser = {0.0, 4.0, 0.0};
  EXPECT_THAT(line.candidates(), IsEmpty());
  line.parameters.drift_m_per_m = 0.03;  // 1.5 m + 0.03 * 100 m reach beyond 4 m
  EXPECT_THAT(line.candidates(), ElementsAre(0));
  line.parameters.max_distance_m = 2.0;
  EXPECT_THAT(line.candidates(), IsEmpty());
}

TEST(FindLoopCandidates, CompareWhatScansSeeNotWhereTheyAre) {
  Line line;
  line.keys[9].map_from_laser = {3.0, 20.0, 0.0};
  line.keys[9].view_centre_in_laser_m = {0.0, -20.0};
  EXPECT_THAT(line.candidates(), ElementsAre(3));
}

TEST(SearchWindow, GrowsWithThePathUpToItsLimits) {
  LoopSearchParameters parameters;
  EXPECT_DOUBLE_EQ(searchWindow(0.0, parameters).distance_m, parameters.dense.reserve_m);
  EXPECT_DOUBLE_EQ(searchWindow(0.0, parameters).angle_rad, parameters.dense.reserve_rad);
  EXPECT_DOUBLE_EQ(searchWindow(10.0, parameters).distance_m,
                   parameters.dense.reserve_m + 10.0 * parameters.drift_m_per_m);
  EXPECT_DOUBLE_EQ(searchWindow(10.0, parameters).angle_rad, 0.1 + 0.01 * 10.0);
  EXPECT_DOUBLE_EQ(searchWindow(1e6, parameters).distance_m, parameters.max_distance_m);
  EXPECT_DOUBLE_EQ(searchWindow(1e6, parameters).angle_rad, parameters.max_angle_rad);
  EXPECT_DOUBLE_EQ(searchWindow(1e6, parameters).angle_step_rad, parameters.dense.angle_step_rad);
}

}  // namespace
}  // namespace ram_slam
