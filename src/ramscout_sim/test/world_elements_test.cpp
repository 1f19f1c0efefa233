// SPDX-License-Identifier: BSD-3-Clause
#include "world_elements.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

namespace ramscout_sim {
namespace {

using ram_parameters::ParameterReader;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// An element read from YAML.
template <typename Read>
auto elementOf(const Read& read, const std::string& yaml) {
  ParameterReader reader(YAML::Load(yaml), "w.yaml");
  return read(reader, "walls[3]");
}

/// The message with which an element is refused; "accepted" if it is not.
template <typename Read>
std::string refusal(const Read& read, const std::string& yaml) {
  try {
    elementOf(read, yaml);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ReadWall, StandsFromOneEndToTheOther) {
  const Solid wall = elementOf(
      readWall, "{from: [1, 2], to: [4, 6], thickness_m: 0.2, height_m: 1, bottom_m: 0.5}");
  EXPECT_TRUE(wall.size_m.isApprox(Eigen::Vector3d(5.0, 0.2, 1.0)));
  EXPECT_TRUE((wall.world_from_solid * Eigen::Vector3d(-2.5, 0.0, -0.5))
                  .isApprox(Eigen::Vector3d(1.0, 2.0, 0.5)));
  EXPECT_TRUE((wall.world_from_solid * Eigen::Vector3d(2.5, 0.0, 0.5))
                  .isApprox(Eigen::Vector3d(4.0, 6.0, 1.5)));
}

TEST(ReadWall, HasTheHeightOfARoomIfNoneIsStated) {
  const Solid wall = elementOf(readWall, "{from: [0, 0], to: [1, 0]}");
  EXPECT_EQ(wall.size_m.z(), kWallHeight_m);
  EXPECT_NEAR(wall.world_from_solid.translation().z(), 0.5 * kWallHeight_m, 1e-12);
}

TEST(ReadWall, IsRefusedByElementAndKey) {
  EXPECT_THAT(refusal(readWall, "{from: [0, 0], to: [0, 0]}"),
              AllOf(HasSubstr("walls[3]"), HasSubstr("length")));
  EXPECT_THAT(refusal(readWall, "{to: [0, 0]}"), HasSubstr("walls[3].from"));
  EXPECT_THAT(refusal(readWall, "{from: [0, 0], to: [1, 0], thickness_m: 0}"),
              HasSubstr("thickness_m: must be > 0"));
  EXPECT_THAT(refusal(readWall, "{from: [0, 0], to: [1, 0], height_m: 1e6}"),
              HasSubstr("height_m"));
  EXPECT_THAT(refusal(readWall, "{from: [0, 0], to: [1, 0], bottom_m: .nan}"),
              HasSubstr("bottom_m"));
}

TEST(ReadBox, YawComesBeforePitch) {
  const Solid box = elementOf(
      readBox,
      "{center: [1, 2, 3], size: [2, 1, 0.5], yaw_rad: 1.5707963267948966, pitch_rad: 0.5}");
  EXPECT_TRUE(box.size_m.isApprox(Eigen::Vector3d(2.0, 1.0, 0.5)));
  EXPECT_TRUE(box.world_from_solid.translation().isApprox(Eigen::Vector3d(1.0, 2.0, 3.0)));
  // Its x axis points along the world's y axis, and down by the pitch.
  EXPECT_LT(
      (box.world_from_solid.linear().col(0) - Eigen::Vector3d(0.0, std::cos(0.5), -std::sin(0.5)))
          .norm(),
      1e-9);
}

TEST(ReadBox, CarriesWheelsOnlyIfItIsDrivable) {
  EXPECT_FALSE(elementOf(readBox, "{center: [0, 0, 0], size: [1, 1, 1]}").drivable);
  EXPECT_TRUE(elementOf(readBox, "{center: [0, 0, 0], size: [1, 1, 1], drivable: true}").drivable);
}

TEST(ReadBox, EveryEdgeMustBePositive) {
  for (const char* size : {"[0, 1, 1]", "[1, -1, 1]", "[1, 1, .inf]"}) {
    EXPECT_THAT(refusal(readBox, std::string("{center: [0, 0, 0], size: ") + size + "}"),
                HasSubstr("size"))
        << size;
  }
}

TEST(ReadRamp, NeedsALengthAndAHeight) {
  EXPECT_THAT(refusal(readRamp, "{from: [0, 0], to: [2, 0], height_m: 0.2}"), "accepted");
  EXPECT_THAT(refusal(readRamp, "{from: [0, 0], to: [2, 0]}"), HasSubstr("height_m"));
  EXPECT_THAT(refusal(readRamp, "{from: [1, 1], to: [1, 1], height_m: 0.2}"), HasSubstr("length"));
  EXPECT_TRUE(elementOf(readRamp, "{from: [0, 0], to: [2, 0], height_m: 0.2}").drivable);
}

TEST(ReadCylinder, StandsOnItsBottom) {
  const Solid cylinder =
      elementOf(readCylinder, "{center: [3, 1], radius_m: 0.2, height_m: 2, bottom_m: 0.1}");
  EXPECT_EQ(cylinder.shape, Shape::kCylinder);
  EXPECT_TRUE(cylinder.size_m.isApprox(Eigen::Vector3d(0.4, 0.4, 2.0)));
  EXPECT_TRUE(cylinder.world_from_solid.translation().isApprox(Eigen::Vector3d(3.0, 1.0, 1.1)));
  EXPECT_THAT(refusal(readCylinder, "{center: [3, 1]}"), HasSubstr("radius_m"));
}

TEST(ReadPairs, AreTheWaypointsInTheirOrder) {
  const auto pairs = readPairs(YAML::Load("[[1, 2], [3, 4], [-5, 6.5]]"), "people[0].waypoints");
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_EQ(pairs[0], Eigen::Vector2d(1.0, 2.0));
  EXPECT_EQ(pairs[2], Eigen::Vector2d(-5.0, 6.5));
}

TEST(ReadPairs, AnythingButPairsIsRefused) {
  const auto read = [](const std::string& yaml) {
    return readPairs(YAML::Load(yaml), "people[0]");
  };
  EXPECT_THROW(read("3"), std::invalid_argument);
  EXPECT_THROW(read("{a: 1}"), std::invalid_argument);
  EXPECT_THROW(read("[[1, 2], [3]]"), std::invalid_argument);
  EXPECT_THROW(read("[[1, 2, 3]]"), std::invalid_argument);
  EXPECT_THROW(read("[[1, .nan]]"), std::invalid_argument);
  EXPECT_THROW(readPairs(YAML::Node(), "people[0]"), std::invalid_argument);
}

TEST(RequireIn, BothLimitsBelongToTheRange) {
  EXPECT_NO_THROW(requireIn("doors[0]", "openness", 0.0, 0.0, 1.0));
  EXPECT_NO_THROW(requireIn("doors[0]", "openness", 1.0, 0.0, 1.0));
  EXPECT_THROW(requireIn("doors[0]", "openness", 1.001, 0.0, 1.0), std::invalid_argument);
  EXPECT_THROW(requireIn("doors[0]", "openness", NAN, 0.0, 1.0), std::invalid_argument);
}

TEST(ReadMaterial, KnowsThreeKindsOfSurfaces) {
  const Material velvet = elementOf(readMaterial, "{name: velvet, reflectivity: 0.03}");
  EXPECT_EQ(velvet.name, "velvet");
  EXPECT_EQ(velvet.surface, Surface::kOpaque);
  EXPECT_EQ(velvet.reflectivity, 0.03);
  const Material pane =
      elementOf(readMaterial, "{name: pane, surface: glass, return_angle_rad: 0.2}");
  EXPECT_EQ(pane.surface, Surface::kGlass);
  EXPECT_EQ(pane.glass_return_angle_rad, 0.2);
  EXPECT_EQ(elementOf(readMaterial, "{name: m, surface: mirror}").surface, Surface::kMirror);
}

TEST(ReadMaterial, IsRefusedWithoutANameOrOutOfRange) {
  EXPECT_THAT(refusal(readMaterial, "{reflectivity: 0.5}"), HasSubstr("name"));
  EXPECT_THAT(refusal(readMaterial, "{name: x, surface: foam}"),
              AllOf(HasSubstr("surface"), HasSubstr("foam")));
  EXPECT_THAT(refusal(readMaterial, "{name: x, reflectivity: 1.1}"), HasSubstr("reflectivity"));
  EXPECT_THAT(refusal(readMaterial, "{name: x, surface: glass, return_angle_rad: 0}"),
              HasSubstr("return_angle_rad"));
}

}  // namespace
}  // namespace ramscout_sim
