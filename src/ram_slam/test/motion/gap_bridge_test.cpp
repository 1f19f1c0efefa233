// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/motion/gap_bridge.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// 1 m/s along x without noise, known from a stamp on.
class KnownFrom : public MotionModel {
public:
  explicit KnownFrom(std::int64_t from_ns) : from_ns_(from_ns) {}
  PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const override {
    if (from_ns < from_ns_) throw std::out_of_range("too old");
    PoseWithCovariance2 motion;
    motion.pose.x_m = static_cast<double>(to_ns - from_ns) * 1e-9;
    return motion;
  }
  std::vector<Pose2> sample(const std::vector<Pose2>& map_from_base,
                            std::int64_t from_ns,
                            std::int64_t to_ns,
                            std::uint64_t /*seed*/) const override {
    std::vector<Pose2> moved;
    for (const Pose2& pose : map_from_base) moved.push_back(pose * motion(from_ns, to_ns).pose);
    return moved;
  }

private:
  std::int64_t from_ns_;
};

TEST(GapBridge, PassesOnWhatTheModelKnows) {
  const KnownFrom model(kSecond);
  const GapBridge bridge(model);
  EXPECT_EQ(bridge.motion(kSecond, 3 * kSecond).pose.x_m, 2.0);
  EXPECT_TRUE(bridge.motion(kSecond, 3 * kSecond).covariance.isZero());
}

TEST(GapBridge, RefusesAGapThatItWasNotToldOf) {
  const KnownFrom model(5 * kSecond);
  const GapBridge bridge(model);
  EXPECT_THROW(bridge.motion(kSecond, 6 * kSecond), std::out_of_range);
}

TEST(GapBridge, StandsStillDuringTheGapAndIsTheLessCertainTheLongerItWas) {
  const KnownFrom model(5 * kSecond);
  GapBridge bridge(model);
  bridge.interruptedUntil(5 * kSecond);
  const PoseWithCovariance2 longer = bridge.motion(1 * kSecond, 6 * kSecond);
  const PoseWithCovariance2 shorter = bridge.motion(4 * kSecond, 6 * kSecond);
  EXPECT_EQ(longer.pose.x_m, 1.0);
  EXPECT_EQ(shorter.pose.x_m, 1.0);
  EXPECT_GT(shorter.covariance(0, 0), 0.01);
  EXPECT_GT(longer.covariance(0, 0), shorter.covariance(0, 0));
  EXPECT_GT(longer.covariance(2, 2), shorter.covariance(2, 2));
}

TEST(GapBridge, PredictsAcrossTheGap) {
  const KnownFrom model(5 * kSecond);
  GapBridge bridge(model);
  EXPECT_THROW(bridge.predictEach({{}}, kSecond, 6 * kSecond), std::out_of_range);
  bridge.interruptedUntil(5 * kSecond);
  EXPECT_EQ(bridge.predictEach({{}}, kSecond, 6 * kSecond)[0].x_m, 1.0);
  EXPECT_EQ(bridge.predictEach({{}}, 5 * kSecond, 7 * kSecond)[0].x_m, 2.0);
}

TEST(GapBridge, DrawsSamplesApartAcrossTheGap) {
  const KnownFrom model(5 * kSecond);
  GapBridge bridge(model);
  bridge.interruptedUntil(5 * kSecond);
  const std::vector<Pose2> moved = bridge.sample({{}, {}}, 4 * kSecond, 6 * kSecond, 7);
  ASSERT_EQ(moved.size(), 2U);
  EXPECT_NE(moved[0].x_m, moved[1].x_m);
  const std::vector<Pose2> again = bridge.sample({{}, {}}, 4 * kSecond, 6 * kSecond, 7);
  EXPECT_EQ(moved[0].x_m, again[0].x_m);
}

TEST(GapBridge, GoesDuringTheGapAsItIsTold) {
  const KnownFrom model(5 * kSecond);
  GapBridge bridge(model);
  bridge.interruptedUntil(5 * kSecond, Pose2{2.0, 0.0, M_PI_2});
  const PoseWithCovariance2 motion = bridge.motion(1 * kSecond, 6 * kSecond);
  EXPECT_NEAR(motion.pose.x_m, 2.0, 1e-12);
  EXPECT_NEAR(motion.pose.y_m, 1.0, 1e-12);
  // 2 cm and 5 % of 2 m, and what a yaw uncertain by 0.01 rad and 5 % of a quarter turn does in 1
  // m.
  EXPECT_NEAR(motion.covariance(0, 0), 0.12 * 0.12 + std::pow(0.01 + 0.05 * M_PI_2, 2), 1e-9);
  for (const Pose2& pose : bridge.sample({{}, {}}, 1 * kSecond, 6 * kSecond, 7)) {
    EXPECT_NEAR(pose.x_m, 2.0, 0.7);
    EXPECT_NEAR(pose.y_m, 1.0, 0.7);
  }
}

TEST(GapBridge, ToldNothingMoreForASecondItStandsStillAgain) {
  const KnownFrom model(5 * kSecond);
  GapBridge bridge(model);
  bridge.interruptedUntil(5 * kSecond, Pose2{2.0, 0.0, 0.0});
  bridge.interruptedUntil(5 * kSecond + kSecond / 2);
  EXPECT_EQ(bridge.motion(1 * kSecond, 6 * kSecond).pose.x_m, 3.0);
  bridge.interruptedUntil(6 * kSecond);
  EXPECT_EQ(bridge.motion(1 * kSecond, 7 * kSecond).pose.x_m, 1.0);
}

TEST(GapBridge, RefusesAgainOnceTheGapIsForgotten) {
  const KnownFrom model(5 * kSecond);
  GapBridge bridge(model);
  bridge.interruptedUntil(5 * kSecond);
  bridge.forget();
  EXPECT_THROW(bridge.motion(kSecond, 6 * kSecond), std::out_of_range);
}

}  // namespace
}  // namespace ram_slam
