// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/constellation_memory.hpp"

#include <gmock/gmock.h>

#include "ram_slam/geometry/random.hpp"

#include "key_scan_drive.hpp"

namespace ram_slam {
namespace {

constexpr double kStepM = 0.5;
constexpr double kStretchM = 10.0;

/// Landmarks about the first 12 m of the x axis.
std::vector<Eigen::Vector2d> landmarks() {
  Random random(4);
  std::vector<Eigen::Vector2d> places_m;
  for (int i = 0; i < 25; ++i)
    places_m.emplace_back(14.0 * random.uniform() - 1.0, 6.0 * random.uniform() - 3.0);
  return places_m;
}

FeatureList seenFrom(const Pose2& map_from_base) {
  FeatureList list;
  for (const Eigen::Vector2d& place_m : landmarks()) {
    Feature feature;
    feature.type = "pole";
    feature.position_m = map_from_base.inverse() * place_m;
    feature.covariance_m2 = 1e-4 * Eigen::Matrix2d::Identity();
    if (feature.position_m.norm() < 4.0) list.features.push_back(feature);
  }
  return list;
}

/// Twice along the landmarks; odometry, and with it the map, moves the second time by `drift`.
struct TwoPasses {
  std::vector<KeyScan> keys;
  ConstellationMemory memory{{}, kStretchM};
  Pose2 truth;

  explicit TwoPasses(const Pose2& drift) {
    pass({}, 40);
    pass(drift, 24);
  }

  void pass(const Pose2& odom_from_map, int steps) {
    for (int i = 0; i < steps; ++i) {
      truth = {kStepM * i, 0.0, 0.0};
      KeyScan key;
      key.odom_from_laser = odom_from_map * truth;
      key.map_from_laser = key.odom_from_laser;
      key.path_m = kStepM * static_cast<double>(keys.size());
      keys.push_back(key);
      memory.add(seenFrom(truth), keys, key.odom_from_base());
    }
  }
};

TEST(ConstellationMemory, RecognisesAPlaceHoweverFarThePosesHaveDrifted) {
  const TwoPasses drive({7.0, -12.0, 0.0});
  const auto place = drive.memory.findPlace(drive.keys, 15.0);
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->x_m, drive.truth.x_m, 0.2);
  EXPECT_NEAR(place->y_m, drive.truth.y_m, 0.2);
  EXPECT_NEAR(place->yaw_rad, 0.0, 0.05);
}

TEST(ConstellationMemory, MovesWithTheKeyScansThatItWasSeenFrom) {
  TwoPasses drive({7.0, -12.0, 0.0});
  const Pose2 shift{1.0, 2.0, 0.0};
  for (KeyScan& key : drive.keys) key.map_from_laser = shift * key.map_from_laser;
  const auto place = drive.memory.findPlace(drive.keys, 15.0);
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->x_m, drive.truth.x_m + 1.0, 0.2);
  EXPECT_NEAR(place->y_m, drive.truth.y_m + 2.0, 0.2);
}

TEST(ConstellationMemory, FindsNothingThatIsNotFarEnoughBack) {
  const TwoPasses drive({7.0, -12.0, 0.0});
  EXPECT_FALSE(drive.memory.findPlace(drive.keys, 1000.0));
}

TEST(ConstellationMemory, FindsNothingWithoutFeatures) {
  ConstellationMemory memory({}, kStretchM);
  const std::vector<KeyScan> keys = blindKeyScans(100, 1.0);
  memory.add({}, keys, {});
  EXPECT_FALSE(memory.findPlace(keys, 10.0));
}

}  // namespace
}  // namespace ram_slam
