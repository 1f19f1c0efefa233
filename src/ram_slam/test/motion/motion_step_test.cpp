// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/motion/motion_step.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

/// Refuses everything, so that a test sees whether it was asked.
class Refusing : public MotionModel {
public:
  PoseWithCovariance2 motion(std::int64_t, std::int64_t) const override {
    throw std::out_of_range("asked");
  }
  std::vector<Pose2> sample(const std::vector<Pose2>&,
                            std::int64_t,
                            std::int64_t,
                            std::uint64_t) const override {
    throw std::out_of_range("asked");
  }
};

TEST(MotionStep, IsTheIdentityWithoutAskingBeforeTheFirstReadingAndWithinOne) {
  const Refusing model;
  EXPECT_EQ(motionStep(model, 0, 100).motion.pose.x_m, 0.0);
  EXPECT_TRUE(motionStep(model, 100, 100).motion.covariance.isZero());
  EXPECT_THROW(motionStep(model, 100, 200), std::out_of_range);
}

TEST(MotionStep, KeepsItsStampsAndItsModel) {
  const Refusing model;
  const MotionStep step = motionStep(model, 0, 100);
  EXPECT_EQ(step.from_ns, 0);
  EXPECT_EQ(step.to_ns, 100);
  EXPECT_EQ(step.model, &model);
}

}  // namespace
}  // namespace ram_slam
