// SPDX-License-Identifier: BSD-3-Clause
#include "wheel_contact.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace ramscout_sim {
namespace {

constexpr double kStep_s = 1e-3;
constexpr double kRadius_m = 0.1;
constexpr double kInertia_kgm2 = 0.02;

Wheel exampleWheel(double max_torque_nm) {
  Wheel wheel;
  wheel.center_in_base_m = {0.0, 0.2, kRadius_m};
  wheel.radius_m = kRadius_m;
  wheel.mass.mass_kg = 1.0;
  wheel.mass.inertia_kgm2 = Eigen::Vector3d(0.5, kInertia_kgm2, 0.7).asDiagonal();
  wheel.max_torque_nm = max_torque_nm;
  return wheel;
}

class WheelContactTest : public ::testing::Test {
protected:
  /// The wheel 1 mm deep in the floor, with its axle to the left.
  void touchFloor(WheelContact& wheel, double friction = 0.8) const {
    wheel.touch(ground_, {0.0, 0.2, kRadius_m - 1e-3}, Eigen::Vector3d::UnitY(), friction);
  }
  /// What ODE reports as the force on the wheel.
  static void setForce(WheelContact& wheel, double forward_n, double up_n) {
    wheel.force.f1[0] = forward_n;
    wheel.force.f1[1] = 0.0;
    wheel.force.f1[2] = up_n;
  }

  WorldHandle ode_{createOdeWorld()};
  Ground ground_{World()};
  PhysicsParameters parameters_;
};

TEST_F(WheelContactTest, ItsInertiaIsThatAboutTheAxle) {
  EXPECT_DOUBLE_EQ(WheelContact(exampleWheel(1.0), 0, parameters_).inertia_kgm2, kInertia_kgm2);
  Wheel turned = exampleWheel(1.0);
  turned.axle_in_base = Eigen::Vector3d::UnitX();
  EXPECT_DOUBLE_EQ(WheelContact(turned, 0, parameters_).inertia_kgm2, 0.5);
}

TEST_F(WheelContactTest, EachWheelGripsALittleMoreThanTheOneBefore) {
  const WheelContact first(exampleWheel(1.0), 0, parameters_);
  const WheelContact third(exampleWheel(1.0), 2, parameters_);
  EXPECT_EQ(first.friction_share, 1.0);
  EXPECT_DOUBLE_EQ(third.friction_share, 1.0 + 2.0 * parameters_.wheel_tie_breaker);
}

TEST_F(WheelContactTest, SteeringTurnsTheAxleAboutTheVertical) {
  WheelContact wheel(exampleWheel(1.0), 0, parameters_);
  wheel.steering_rad = M_PI / 6.0;
  EXPECT_TRUE(wheel.axleInBody().isApprox(Eigen::Vector3d(-0.5, std::sqrt(0.75), 0.0)));
}

TEST_F(WheelContactTest, RollsAcrossItsAxleAndRubsAsItsLoadAllows) {
  WheelContact wheel(exampleWheel(1.0), 0, parameters_);
  wheel.load_n = 50.0;
  touchFloor(wheel, 0.6);
  ASSERT_TRUE(wheel.touches_ground);
  EXPECT_TRUE(wheel.rolling.isApprox(Eigen::Vector3d::UnitX()));
  EXPECT_DOUBLE_EQ(wheel.contact.surface.mu, 30.0);
  EXPECT_DOUBLE_EQ(wheel.contact.surface.mu2, 30.0);
  EXPECT_DOUBLE_EQ(wheel.contact.surface.soft_cfm, parameters_.wheel_softness);
}

TEST_F(WheelContactTest, AnOmniWheelSlidesAlongItsAxle) {
  Wheel description = exampleWheel(1.0);
  description.omni = true;
  WheelContact wheel(description, 0, parameters_);
  wheel.load_n = 50.0;
  touchFloor(wheel);
  EXPECT_DOUBLE_EQ(wheel.contact.surface.mu, 40.0);
  EXPECT_EQ(wheel.contact.surface.mu2, 0.0);
}

TEST_F(WheelContactTest, AMotorWithinItsTorqueHoldsItsSpeed) {
  WheelContact wheel(exampleWheel(5.0), 0, parameters_);
  touchFloor(wheel);
  wheel.drive(kStep_s, 7.0);
  EXPECT_DOUBLE_EQ(wheel.contact.surface.motion1, kRadius_m * 7.0);
  EXPECT_DOUBLE_EQ(wheel.contact.surface.slip1, parameters_.friction_softness);
}

TEST_F(WheelContactTest, AFreeWheelGivesNoTorque) {
  WheelContact wheel(exampleWheel(0.0), 0, parameters_);
  wheel.speed_radps = 3.0;
  touchFloor(wheel);
  wheel.drive(kStep_s, 7.0);
  EXPECT_DOUBLE_EQ(wheel.contact.surface.motion1, kRadius_m * 3.0) << "as fast as it is";
  EXPECT_DOUBLE_EQ(wheel.contact.surface.slip1,
                   parameters_.friction_softness + kRadius_m * kRadius_m * kStep_s / kInertia_kgm2);
  EXPECT_TRUE(wheel.didAsAssumed(kStep_s, 7.0));
}

TEST_F(WheelContactTest, AMotorBeyondItsTorqueGivesItsMost) {
  constexpr double kMost_nm = 2.0;
  WheelContact wheel(exampleWheel(kMost_nm), 0, parameters_);
  touchFloor(wheel);
  setForce(wheel, 0.0, 50.0);
  // 7 rad/s within a millisecond need 0.02 * 7 / 0.001 = 140 Nm.
  EXPECT_FALSE(wheel.didAsAssumed(kStep_s, 7.0));
  ASSERT_TRUE(wheel.fixed_torque_nm);
  EXPECT_EQ(*wheel.fixed_torque_nm, kMost_nm);
  EXPECT_TRUE(wheel.didAsAssumed(kStep_s, 7.0)) << "the assumption is corrected";
  EXPECT_FALSE(wheel.didAsAssumed(kStep_s, -7.0));
  EXPECT_EQ(*wheel.fixed_torque_nm, -kMost_nm);
  EXPECT_FALSE(wheel.didAsAssumed(kStep_s, 0.0)) << "to stand needs no torque";
  EXPECT_FALSE(wheel.fixed_torque_nm);
}

TEST_F(WheelContactTest, SpinsUpByTorqueLessTraction) {
  constexpr double kMost_nm = 2.0;
  constexpr double kTraction_n = 5.0;
  WheelContact wheel(exampleWheel(kMost_nm), 0, parameters_);
  touchFloor(wheel);
  setForce(wheel, kTraction_n, 50.0);
  wheel.spin(kStep_s, 100.0);
  const double expected_radps2 = (kMost_nm - kRadius_m * kTraction_n) / kInertia_kgm2;
  EXPECT_DOUBLE_EQ(wheel.acceleration_radps2, expected_radps2);
  EXPECT_DOUBLE_EQ(wheel.speed_radps, kStep_s * expected_radps2);
  EXPECT_DOUBLE_EQ(wheel.angle_rad, kStep_s * kStep_s * expected_radps2);
  EXPECT_DOUBLE_EQ(wheel.load_n, 50.0);
}

TEST_F(WheelContactTest, ReachesTheTargetExactlyWhereTheTorqueSuffices) {
  WheelContact wheel(exampleWheel(1000.0), 0, parameters_);
  touchFloor(wheel);
  setForce(wheel, 5.0, 50.0);
  wheel.spin(kStep_s, 7.0);
  EXPECT_NEAR(wheel.speed_radps, 7.0, 1e-12);
}

TEST_F(WheelContactTest, InTheAirItHasNeitherLoadNorTraction) {
  WheelContact wheel(exampleWheel(2.0), 0, parameters_);
  wheel.load_n = 50.0;
  setForce(wheel, 5.0, 50.0);
  wheel.touch(ground_, {0.0, 0.2, 1.0}, Eigen::Vector3d::UnitY(), 0.8);
  EXPECT_FALSE(wheel.touches_ground);
  wheel.spin(kStep_s, 100.0);
  EXPECT_DOUBLE_EQ(wheel.acceleration_radps2, 2.0 / kInertia_kgm2);
  EXPECT_EQ(wheel.load_n, 0.0);
}

}  // namespace
}  // namespace ramscout_sim
