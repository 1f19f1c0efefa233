// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/graph_paths.hpp"

#include <limits>

#include <gmock/gmock.h>

#include "key_scan_drive.hpp"

namespace ram_slam {
namespace {

using ::testing::ElementsAre;

TEST(PathLengthsTo, AreThoseOfTheDriveWithoutShortcuts) {
  EXPECT_THAT(pathLengthsTo(3, blindKeyScans(5, 2.0), {}, 0.5),
              ElementsAre(6.0, 4.0, 2.0, 0.0, 2.0));
}

TEST(PathLengthsTo, UseAShortcutInBothDirections) {
  const std::vector<KeyScan> keys = blindKeyScans(6, 1.0);
  EXPECT_THAT(pathLengthsTo(5, keys, {{0, 5}}, 0.5), ElementsAre(0.5, 1.5, 2.5, 2.0, 1.0, 0.0));
  EXPECT_THAT(pathLengthsTo(0, keys, {{0, 5}}, 0.5), ElementsAre(0.0, 1.0, 2.0, 2.5, 1.5, 0.5));
}

TEST(PathLengthsTo, ChainShortcuts) {
  EXPECT_THAT(pathLengthsTo(6, blindKeyScans(7, 10.0), {{3, 6}, {0, 3}}, 0.5),
              ElementsAre(1.0, 11.0, 10.5, 0.5, 10.5, 10.0, 0.0));
}

TEST(PathLengthsTo, LeadAcrossAJumpOnlyByAShortcut) {
  std::vector<KeyScan> keys = blindKeyScans(4, 1.0);
  keys[2].is_jump = true;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  EXPECT_THAT(pathLengthsTo(3, keys, {}, 0.5), ElementsAre(kNone, kNone, 1.0, 0.0));
  EXPECT_THAT(pathLengthsTo(3, keys, {{0, 3}}, 0.5), ElementsAre(0.5, 1.5, 1.0, 0.0));
}

TEST(PathLengthsTo, LeaveOutShortcutsThatAreLongerThanTheDrive) {
  EXPECT_THAT(pathLengthsTo(2, blindKeyScans(3, 0.1), {{0, 2}}, 0.5), ElementsAre(0.2, 0.1, 0.0));
}

TEST(PathLengthsTo, ALoadedMapDoesNotDrift) {
  std::vector<KeyScan> keys = blindKeyScans(10, 1.0);
  for (std::size_t i = 0; i < 6; ++i) keys[i].is_loaded = true;
  const std::vector<double> lengths_m = pathLengthsTo(9, keys, {}, 0.5);
  EXPECT_DOUBLE_EQ(lengths_m[5], 4.0);
  EXPECT_DOUBLE_EQ(lengths_m[0], 4.0);
}

}  // namespace
}  // namespace ram_slam
