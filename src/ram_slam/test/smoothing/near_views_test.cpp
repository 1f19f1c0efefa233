// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/near_views.hpp"

#include <gmock/gmock.h>

#include "key_scan_drive.hpp"

namespace ram_slam {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Lt;
using ::testing::Not;

/// 20 key scans along x and 20 back, 0.5 m apart; the last one is where the first one was.
std::vector<KeyScan> passages() {
  std::vector<KeyScan> keys = blindKeyScans(40, 0.5);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto from_start = static_cast<double>(i < 20 ? i : 39 - i);
    keys[i].map_from_laser = {0.5 * from_start, 0.0, 0.0};
    keys[i].view_centre_in_laser_m = {1.0, 0.0};
  }
  return keys;
}

TEST(NearViews, AreOfOtherPassagesAndNearestFirst) {
  NearViewParameters parameters;
  parameters.min_passage_gap = 1;
  EXPECT_THAT(nearViews(passages(), 39, parameters), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(nearViews(passages(), 39, {}), ElementsAre(0, 5));
}

TEST(NearViews, LeaveOutTheSamePassage) {
  EXPECT_THAT(nearViews(passages(), 15, {}), IsEmpty());
  EXPECT_THAT(nearViews(passages(), 22, {}), Each(Lt(13U)));
}

TEST(NearViews, AreAskedForInTurnUntilThereAreEnough) {
  NearViewParameters parameters;
  parameters.min_passage_gap = 1;
  parameters.count = 2;
  const auto odd = [](std::size_t key) { return key % 2 == 1; };
  EXPECT_THAT(nearViews(passages(), 39, parameters, odd), ElementsAre(1, 3));
}

TEST(NearViews, MeasureFromTheCentresOfWhatIsSeen) {
  std::vector<KeyScan> keys = passages();
  NearViewParameters parameters;
  parameters.min_passage_gap = 1;
  // The first key scan looks away: what it sees is 2 m behind it, 3 m from what the last one sees.
  keys[0].map_from_laser.yaw_rad = M_PI;
  keys[0].view_centre_in_laser_m = {2.0, 0.0};
  EXPECT_THAT(nearViews(keys, 39, parameters), Not(Contains(0U)));
  keys[0].view_centre_in_laser_m = {1.0, 0.0};
  EXPECT_THAT(nearViews(keys, 39, parameters), Contains(0U));
  parameters.max_angle_rad = 0.5;
  EXPECT_THAT(nearViews(keys, 39, parameters), Not(Contains(0U)));
}

}  // namespace
}  // namespace ram_slam
