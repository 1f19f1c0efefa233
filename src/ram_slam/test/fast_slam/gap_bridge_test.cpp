// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/gap_bridge.hpp"

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

TEST(GapBridge, RefusesAgainOnceTheGapIsForgotten) {
  const KnownFrom model(5 * kSecond);
  GapBridge bridge(model);
  bridge.interruptedUntil(5 * kSecond);
  bridge.forget();
  EXPECT_THROW(bridge.motion(kSecond, 6 * kSecond), std::out_of_range);
}

}  // namespace
}  // namespace ram_slam
