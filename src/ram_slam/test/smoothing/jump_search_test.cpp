// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/jump_search.hpp"

#include <algorithm>

#include <gmock/gmock.h>

#include "key_scan_drive.hpp"

namespace ram_slam {
namespace {

using ::testing::Eq;
using ::testing::Optional;

const Pose2 kWrong{20.0, -7.0, 1.2};  ///< by which the second half of a drive is displaced

/// A drive through a room, and the same again; the robot was carried back in between, which its
/// poses do not show.
std::vector<KeyScan> drivenTwice() {
  const std::vector<Pose2> poses = thereAndBack(30);
  std::vector<KeyScan> keys = scansAt(pillarRoom(), poses, poses).keys();
  const std::size_t count = keys.size();
  const double path_m = keys.back().path_m;
  for (std::size_t i = 0; i < count; ++i) {
    KeyScan key = keys[i];
    key.map_from_laser = kWrong * key.map_from_laser;
    key.path_m += path_m;
    key.may_be_jump = i == 0;
    keys.push_back(key);
  }
  return keys;
}

JumpSearch searchFor() {
  JumpSearchParameters parameters;
  parameters.support_path_m = 2.0;
  parameters.place_distance_m = 1.0;
  LoopSearchParameters loops;
  loops.neighbour_count = 2;
  return JumpSearch(parameters, loops, {});
}

/// That a key scan of the second drive is where the same one of the first is.
LoopMatch samePlace(const std::vector<KeyScan>& keys, std::size_t key) {
  LoopMatch match;
  match.edge.from = key;
  match.edge.to = keys.size() / 2 + key;
  return match;
}

LoopClosure closureBetween(std::size_t from, std::size_t to) {
  LoopClosure closure;
  closure.edge.from = from;
  closure.edge.to = to;
  return closure;
}

TEST(JumpSearch, FindsThePossibleJumpOnceThereIsEnoughAfterIt) {
  std::vector<KeyScan> keys = drivenTwice();
  const std::size_t jump = keys.size() / 2;
  EXPECT_THAT(searchFor().possibleJump(keys, {}), Optional(Eq(jump)));
  keys.resize(jump + 2);
  EXPECT_FALSE(searchFor().possibleJump(keys, {}));
  keys[jump].may_be_jump = false;
  EXPECT_FALSE(searchFor().possibleJump(keys, {}));
}

TEST(JumpSearch, BelievesTwoClosuresFarApartThatTheRobotWasNotCarried) {
  const std::vector<KeyScan> keys = drivenTwice();
  const std::size_t jump = keys.size() / 2;
  const LoopClosure first = closureBetween(2, jump + 2);
  const LoopClosure beside = closureBetween(2, jump + 3);
  LoopClosure apart = closureBetween(4, keys.size() - 1);
  EXPECT_TRUE(searchFor().possibleJump(keys, {first, beside}));
  EXPECT_FALSE(searchFor().possibleJump(keys, {first, apart}));
  apart.state = ClosureState::kOutvoted;
  EXPECT_TRUE(searchFor().possibleJump(keys, {first, apart}));
  // Both of its key scans are after the jump: it shows nothing.
  EXPECT_TRUE(searchFor().possibleJump(keys, {first, closureBetween(jump + 1, keys.size() - 1)}));
}

TEST(JumpSearch, GivesUpAfterALongWay) {
  std::vector<KeyScan> keys = drivenTwice();
  keys.back().path_m = keys[keys.size() / 2].path_m + JumpSearchParameters{}.search_path_m + 1.0;
  EXPECT_FALSE(searchFor().possibleJump(keys, {}));
}

TEST(JumpSearch, ComparesWithPlacesOfTheSameShapeBeforeTheJump) {
  std::vector<KeyScan> keys = drivenTwice();
  const std::size_t jump = keys.size() / 2;
  keys.resize(jump + 6);
  JumpSearch search = searchFor();
  const std::vector<std::size_t> places = search.alikePlaces(keys, jump);
  ASSERT_FALSE(places.empty());
  EXPECT_EQ(places.front(), 5U);  // of which the newest one is a copy
  for (const std::size_t place : places) EXPECT_LT(place, jump);
}

TEST(JumpSearch, NeedsTwoPlacesThatAgree) {
  const std::vector<KeyScan> keys = drivenTwice();
  const std::size_t jump = keys.size() / 2;
  JumpSearch search = searchFor();
  EXPECT_FALSE(search.isShownBy(keys, samePlace(keys, 2), jump));
  EXPECT_FALSE(search.isShownBy(keys, samePlace(keys, 3), jump));  // beside the first
  EXPECT_TRUE(search.isShownBy(keys, samePlace(keys, 10), jump));
}

TEST(JumpSearch, NeedsOnePlaceIfTheEstimatorHasFoundTheRobotThere) {
  const std::vector<KeyScan> keys = drivenTwice();
  const std::size_t jump = keys.size() / 2;
  JumpSearch search = searchFor();
  search.addFoundPlace(keys[jump].stamp_ns, Pose2{});  // the drive was given as it was
  EXPECT_TRUE(search.isShownBy(keys, samePlace(keys, 2), jump));
  search.addFoundPlace(keys[jump].stamp_ns, kWrong);
  EXPECT_FALSE(search.isShownBy(keys, samePlace(keys, 3), jump));
  search.addFoundPlace(keys[jump].stamp_ns - 1'000'000'000'000, Pose2{});  // before the jump
  EXPECT_FALSE(search.isShownBy(keys, samePlace(keys, 3), jump));
}

TEST(JumpSearch, DoesNotBelieveTwoPlacesThatContradictEachOther) {
  const std::vector<KeyScan> keys = drivenTwice();
  const std::size_t jump = keys.size() / 2;
  JumpSearch search = searchFor();
  LoopMatch other = samePlace(keys, 10);
  other.edge.from_from_to = {0.0, 0.0, 2.0};
  EXPECT_FALSE(search.isShownBy(keys, samePlace(keys, 2), jump));
  EXPECT_FALSE(search.isShownBy(keys, other, jump));
}

TEST(JumpSearch, DoesNotBelievePlacesWhereTheOtherScansDoNotFit) {
  // Two places agree on a pose that puts all other key scans across walls.
  std::vector<KeyScan> keys = drivenTwice();
  const std::size_t jump = keys.size() / 2;
  LoopMatch first = samePlace(keys, 2);
  LoopMatch second = samePlace(keys, 10);
  const Pose2 turned{0.0, 0.0, M_PI_2};
  const Pose2 old_from_new =
      keys[2].map_from_laser * turned * keys[jump + 2].map_from_laser.inverse();
  for (LoopMatch* match : {&first, &second})
    match->edge.from_from_to = keys[match->edge.from].map_from_laser.inverse() * old_from_new *
                               keys[match->edge.to].map_from_laser;
  JumpSearch search = searchFor();
  EXPECT_FALSE(search.isShownBy(keys, first, jump));
  EXPECT_FALSE(search.isShownBy(keys, second, jump));
}

}  // namespace
}  // namespace ram_slam
