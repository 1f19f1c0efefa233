// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/pose2.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace ramscout_sim {
namespace {

void expectNear(const Pose2& a, const Pose2& b) {
  EXPECT_NEAR(a.x_m, b.x_m, 1e-12);
  EXPECT_NEAR(a.y_m, b.y_m, 1e-12);
  EXPECT_NEAR(wrapAngle(a.yaw_rad - b.yaw_rad), 0.0, 1e-12);
}

TEST(WrapAngle, KeepsTheDirectionWithinHalfATurn) {
  for (int i = -40; i <= 40; ++i) {
    const double angle_rad = 0.37 * i;
    const double wrapped_rad = wrapAngle(angle_rad);
    EXPECT_LE(std::abs(wrapped_rad), M_PI);
    EXPECT_NEAR(std::cos(wrapped_rad), std::cos(angle_rad), 1e-12);
    EXPECT_NEAR(std::sin(wrapped_rad), std::sin(angle_rad), 1e-12);
  }
}

TEST(Pose2, ComposesAsAStepInTheAxesOfTheFirst) {
  expectNear(Pose2{1.0, 2.0, M_PI_2} * Pose2{3.0, 1.0, M_PI_2}, {0.0, 5.0, M_PI});
}

TEST(Pose2, ComposesLikeItsIsometry) {
  const Pose2 a{1.0, -2.0, 0.7};
  const Pose2 b{-0.3, 4.0, 2.9};
  expectNear(a * b, toPose2(toIsometry(a) * toIsometry(b)));
}

TEST(Pose2, OfATiltedBodyIsTheDirectionOfItsXAxisFromAbove) {
  const Eigen::Isometry3d tilted =
      toIsometry({1.0, 2.0, 0.5}) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY());
  expectNear(toPose2(tilted), {1.0, 2.0, 0.5});
}

}  // namespace
}  // namespace ramscout_sim
