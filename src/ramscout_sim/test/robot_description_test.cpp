// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/robot_description.hpp"

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "ramscout_sim/random.hpp"

#include "shared.hpp"

namespace ramscout_sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string shippedUrdf() {
  std::ifstream stream(std::string(CONFIG_FOLDER) + "/robots/ramscout.urdf");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The shipped robot with one piece of its text exchanged, wherever it occurs.
std::string with(const std::string& before, const std::string& after) {
  std::string text = shippedUrdf();
  std::size_t at = text.find(before);
  EXPECT_NE(at, std::string::npos) << before;
  for (; at != std::string::npos; at = text.find(before, at + after.size()))
    text.replace(at, before.size(), after);
  return text;
}

std::string refusal(const std::string& urdf, const std::string& laser = "laser") {
  try {
    parseRobot(urdf, laser);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(RobotDescription, ReadsTheShippedRobot) {
  const RobotDescription robot = testing::shippedRobot();
  EXPECT_EQ(robot.name, "ramscout");
  EXPECT_EQ(robot.base_frame, "base_link");
  EXPECT_NEAR(robot.trackWidth_m(), 0.36, 1e-12);
  EXPECT_EQ(robot.wheels[0].joint, "left_wheel_joint");
  EXPECT_EQ(robot.wheels[1].joint, "right_wheel_joint");
  EXPECT_NEAR(robot.wheels[0].radius_m, 0.1, 1e-12);
  EXPECT_NEAR(robot.wheels[0].max_torque_nm, 5.0, 1e-12);
  EXPECT_NEAR(robot.chassis.mass_kg, 20.0, 1e-12);
  EXPECT_TRUE(robot.chassis.center_in_base_m.isApprox(Eigen::Vector3d(0, 0, 0.15)));
  EXPECT_EQ(robot.casters.size(), 2U);
  EXPECT_TRUE(robot.base_from_laser.translation().isApprox(Eigen::Vector3d(0.2, 0, 0.37)));
}

TEST(RobotDescription, JoinsTheMassesOfFixedLinksByTheParallelAxisTheorem) {
  // Two balls of 1 kg, 1 m apart across, beside the chassis of 20 kg.
  std::string balls;
  for (const char* side : {"-0.5", "0.5"}) {
    const std::string name = std::string("ball") + side;
    balls += "<joint name='" + name +
             "_joint' type='fixed'><parent link='base_link'/><child link='" + name +
             "'/><origin xyz='0 " + side + " 0.15'/></joint><link name='" + name +
             "'><inertial><mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' "
             "izz='0.01'/></inertial></link>";
  }
  const RobotDescription robot = parseRobot(with("</robot>", balls + "</robot>"));
  EXPECT_NEAR(robot.chassis.mass_kg, 22.0, 1e-12);
  EXPECT_TRUE(robot.chassis.center_in_base_m.isApprox(Eigen::Vector3d(0, 0, 0.15)));
  EXPECT_NEAR(robot.chassis.inertia_kgm2(0, 0), 0.49 + 2 * (0.01 + 0.25), 1e-9);
  EXPECT_NEAR(robot.chassis.inertia_kgm2(1, 1), 0.75 + 2 * 0.01, 1e-9);
  EXPECT_NEAR(robot.chassis.inertia_kgm2(2, 2), 0.94 + 2 * (0.01 + 0.25), 1e-9);
}

TEST(RobotDescription, RefusesWhatIsNoUrdf) {
  EXPECT_THAT(refusal(""), HasSubstr("XML"));
  EXPECT_THAT(refusal("<robot name='x'"), HasSubstr("XML"));
  EXPECT_THAT(refusal("<html/>"), HasSubstr("XML"));
  EXPECT_THAT(refusal(shippedUrdf().substr(0, 900)), HasSubstr("XML"));
}

TEST(RobotDescription, NamesAMissingLink) {
  EXPECT_THAT(refusal(with("<link name=\"rear_caster\">", "<link name=\"rear\">")),
              HasSubstr("rear_caster"));
  EXPECT_THAT(refusal(shippedUrdf(), "camera"), HasSubstr("camera"));
}

TEST(RobotDescription, NamesALinkThatNoJointHolds) {
  std::string urdf = shippedUrdf();
  const std::size_t begin = urdf.find("<joint name=\"left_wheel_joint\"");
  const std::size_t end = urdf.find("</joint>", begin) + std::string("</joint>").size();
  ASSERT_LT(begin, end);
  EXPECT_THAT(refusal(urdf.erase(begin, end - begin)), HasSubstr("left_wheel"));
}

TEST(RobotDescription, RefusesAMeshForAChassisByLink) {
  EXPECT_THAT(refusal(with("<box size=\"0.60 0.45 0.29\"/>", "<mesh filename=\"none.stl\"/>")),
              AllOf(HasSubstr("chassis"), HasSubstr("box")));
}

TEST(RobotDescription, RefusesALaserThatMoves) {
  EXPECT_THAT(refusal(with("<joint name=\"laser_joint\" type=\"fixed\">",
                           "<joint name=\"laser_joint\" type=\"floating\">")),
              HasSubstr("laser_joint"));
}

TEST(RobotDescription, RefusesAbsurdMassProperties) {
  EXPECT_THAT(refusal(with("<mass value=\"20\"/>", "<mass value=\"-20\"/>")),
              AllOf(HasSubstr("chassis"), HasSubstr("mass")));
  EXPECT_THAT(refusal(with("<mass value=\"20\"/>", "<mass value=\"20000\"/>")),
              AllOf(HasSubstr("chassis"), HasSubstr("mass")));
  EXPECT_THAT(refusal(with("ixx=\"0.49\"", "ixx=\"-0.49\"")),
              AllOf(HasSubstr("chassis"), HasSubstr("inertia")));
  EXPECT_THAT(refusal(with("izz=\"0.94\"", "izz=\"9.4\"")),
              AllOf(HasSubstr("chassis"), HasSubstr("inertia")));
  // g and mm instead of kg and m
  EXPECT_THAT(
      refusal(with(
          "<inertia ixx=\"0.49\" ixy=\"0\" ixz=\"0\" iyy=\"0.75\" iyz=\"0\" izz=\"0.94\"/>",
          "<inertia ixx=\"4.9e5\" ixy=\"0\" ixz=\"0\" iyy=\"7.5e5\" iyz=\"0\" izz=\"9.4e5\"/>")),
      AllOf(HasSubstr("chassis"), HasSubstr("units")));
}

TEST(RobotDescription, RefusesMillimetres) {
  EXPECT_THAT(refusal(with("<box size=\"0.60 0.45 0.29\"/>", "<box size=\"600 450 290\"/>")),
              AllOf(HasSubstr("chassis"), HasSubstr("metres")));
  EXPECT_THAT(refusal(with("<box size=\"0.60 0.45 0.29\"/>", "<box size=\"6e-4 4.5e-4 2.9e-4\"/>")),
              AllOf(HasSubstr("chassis"), HasSubstr("metres")));
}

TEST(RobotDescription, RefusesNumbersThatAreNone) {
  for (const char* number : {"nan", "inf", "1e999", "0.2m", ""}) {
    EXPECT_THAT(refusal(with("<origin xyz=\"0 0.18 0.1\"/>",
                             std::string("<origin xyz=\"") + number + " 0.18 0.1\"/>")),
                ::testing::Not("accepted"))
        << number;
    EXPECT_THAT(
        refusal(with("<mass value=\"20\"/>", std::string("<mass value=\"") + number + "\"/>")),
        ::testing::Not("accepted"))
        << number;
  }
}

TEST(RobotDescription, TakesAxesOfEitherSignAndRightAnglesWrittenRoughly) {
  const RobotDescription mirrored =
      parseRobot(with("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 -1 0\"/>"), "laser");
  EXPECT_EQ(mirrored.kind, BaseKind::kDifferential);
  EXPECT_TRUE(mirrored.wheels[0].axle_in_base.isApprox(-Eigen::Vector3d::UnitY()));
  const RobotDescription rough =
      parseRobot(with("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 1 0.0008\"/>"), "laser");
  EXPECT_TRUE(rough.wheels[0].axle_in_base.isApprox(Eigen::Vector3d::UnitY()));
}

TEST(RobotDescription, RefusesWheelsThatCannotDrive) {
  EXPECT_THAT(refusal(with("type=\"continuous\"", "type=\"fixed\"")),
              HasSubstr("two driven wheels"));
  EXPECT_THAT(refusal(with("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 1\"/>")),
              AllOf(HasSubstr("left_wheel_joint"), HasSubstr("axis")));
  EXPECT_THAT(refusal(with("<limit effort=\"5\" velocity=\"30\"/>", "")),
              AllOf(HasSubstr("left_wheel_joint"), HasSubstr("effort")));
  EXPECT_THAT(refusal(with("<origin xyz=\"0 0.18 0.1\"/>", "<origin xyz=\"0 0.18 0.2\"/>")),
              AllOf(HasSubstr("left_wheel_joint"), HasSubstr("floor")));
  EXPECT_THAT(refusal(with("<origin xyz=\"0 0.18 0.1\"/>", "<origin xyz=\"0.1 0.18 0.1\"/>")),
              HasSubstr("midway"));
}

TEST(RobotDescription, ReadsOrRefusesDamagedTextButNeverFailsOtherwise) {
  const std::string original = shippedUrdf();
  int accepted = 0;
  int refused = 0;
  for (std::uint64_t trial = 0; trial < 500; ++trial) {
    Random random(1, Stream::kBuilding, trial);
    std::string text = original;
    const std::size_t at = random.bits() % text.size();
    if (random.uniform() < 0.5) {
      text[at] = static_cast<char>(32 + random.bits() % 95);
    } else {
      text.erase(at, 1 + random.bits() % 20);
    }
    try {
      const RobotDescription robot = parseRobot(text);
      EXPECT_TRUE(std::isfinite(robot.trackWidth_m()));
      EXPECT_GT(robot.chassis.mass_kg, 0.0);
      EXPECT_TRUE(robot.base_from_laser.matrix().allFinite());
      ++accepted;
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  EXPECT_GT(accepted, 20);
  EXPECT_GT(refused, 20);
}

TEST(CombinedMass, IsTheSameInEveryOrderAndOfNothingIsNothing) {
  MassProperties a;
  a.mass_kg = 2.0;
  a.center_in_base_m = {1.0, 0.0, 0.0};
  a.inertia_kgm2 = Eigen::Vector3d(0.1, 0.2, 0.3).asDiagonal();
  MassProperties b;
  b.mass_kg = 6.0;
  b.center_in_base_m = {-1.0, 0.0, 0.0};
  const MassProperties ab = combined(a, b);
  const MassProperties ba = combined(b, a);
  EXPECT_EQ(ab.mass_kg, 8.0);
  EXPECT_NEAR(ab.center_in_base_m.x(), -0.5, 1e-12);
  // Two points 2 m apart: the reduced mass 2 * 6 / 8 by the square of the distance.
  EXPECT_NEAR(ab.inertia_kgm2(2, 2), 0.3 + 1.5 * 4.0, 1e-12);
  EXPECT_NEAR(ab.inertia_kgm2(0, 0), 0.1, 1e-12);
  EXPECT_TRUE(ab.inertia_kgm2.isApprox(ba.inertia_kgm2, 1e-12));
  EXPECT_EQ(combined(MassProperties{}, MassProperties{}).mass_kg, 0.0);
}

TEST(RobotDescription, WholeRobotWeighsTheSumOfItsParts) {
  const RobotDescription robot = testing::shippedRobot();
  double mass_kg = robot.chassis.mass_kg;
  for (const Wheel& wheel : robot.wheels) mass_kg += wheel.mass.mass_kg;
  EXPECT_NEAR(combined(robot).mass_kg, mass_kg, 1e-12);
  EXPECT_NEAR(combined(robot).center_in_base_m.y(), 0.0, 1e-12) << "it is symmetric";
}

TEST(RobotDescription, ReadsTheShippedCarWithItsSteeredWheelsLast) {
  const RobotDescription car = readRobot(std::string(CONFIG_FOLDER) + "/robots/car.urdf");
  EXPECT_EQ(car.kind, BaseKind::kAckermann);
  ASSERT_EQ(car.wheels.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(car.wheels[i].steering.has_value(), i >= 2) << i;
    EXPECT_FALSE(car.wheels[i].omni);
  }
  EXPECT_GT(car.wheels[0].center_in_base_m.y(), car.wheels[1].center_in_base_m.y());
  EXPECT_GT(car.wheels[2].center_in_base_m.y(), car.wheels[3].center_in_base_m.y());
  EXPECT_GT(car.wheels[2].steering->max_angle_rad, 0.0);
}

TEST(RobotDescription, ReadsTheShippedOmnidirectionalRobot) {
  const RobotDescription robot = readRobot(std::string(CONFIG_FOLDER) + "/robots/omni.urdf");
  EXPECT_EQ(robot.kind, BaseKind::kOmnidirectional);
  EXPECT_GE(robot.wheels.size(), 3u);
  for (const Wheel& wheel : robot.wheels) {
    EXPECT_TRUE(wheel.omni);
    EXPECT_NEAR(wheel.axle_in_base.norm(), 1.0, 1e-12);
    EXPECT_EQ(wheel.axle_in_base.z(), 0.0);
  }
}

TEST(RobotDescription, AFileThatDoesNotExistIsNamed) {
  try {
    readRobot("/nowhere/robot.urdf");
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "/nowhere/robot.urdf: cannot be opened");
  }
}

TEST(RobotDescription, LimitsOfItsSizeAreThoseThatAreGiven) {
  RobotLimits limits;
  limits.max_mass_kg = 19.0;
  EXPECT_THROW(parseRobot(shippedUrdf(), "laser", limits), std::invalid_argument);
  limits = {};
  limits.max_size_m = 0.5;  // the chassis is 0.6 m long
  EXPECT_THROW(parseRobot(shippedUrdf(), "laser", limits), std::invalid_argument);
  limits.max_size_m = 0.7;
  EXPECT_NO_THROW(parseRobot(shippedUrdf(), "laser", limits));
}

}  // namespace
}  // namespace ramscout_sim
