// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "ramscout_sim/lidar.hpp"
#include "ramscout_sim/map_image.hpp"
#include "ramscout_sim/office.hpp"
#include "ramscout_sim/physics.hpp"
#include "ramscout_sim/random.hpp"
#include "ramscout_sim/world.hpp"

#include "shared.hpp"
#include "temporary_folder.hpp"

namespace ramscout_sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::refusalOf;
using testing::TemporaryFolder;

const char* const kWorld = R"(start: [1, 2, 0.5]
floor_friction: 0.6
walls:
  - {from: [0, 0], to: [3, 4], thickness_m: 0.2, height_m: 1.0, bottom_m: 0.5}
boxes:
  - {center: [1, 2, 0.5], size: [0.4, 0.6, 1.0], yaw_rad: 0.3, pitch_rad: 0.1}
cylinders:
  - {center: [3, 1], radius_m: 0.2, height_m: 2.0, bottom_m: 0.1}
)";

TEST(WorldFile, ReadsEveryKindOfSolid) {
  const TemporaryFolder folder;
  const World world = readWorld(folder.write("world.yaml", kWorld));
  EXPECT_EQ(world.start.y_m, 2.0);
  EXPECT_EQ(world.floor_friction, 0.6);
  ASSERT_EQ(world.solids.size(), 3U);
  const Solid& wall = world.solids[0];
  EXPECT_TRUE(wall.size_m.isApprox(Eigen::Vector3d(5.0, 0.2, 1.0)));
  EXPECT_TRUE(
      (wall.world_from_solid * Eigen::Vector3d(2.5, 0, 0)).isApprox(Eigen::Vector3d(3, 4, 1)));
  const Solid& box = world.solids[1];
  EXPECT_TRUE(box.size_m.isApprox(Eigen::Vector3d(0.4, 0.6, 1.0)));
  EXPECT_NEAR(box.world_from_solid.linear()(2, 0), -std::sin(0.1), 1e-12);
  EXPECT_EQ(world.solids[2].shape, Shape::kCylinder);
  EXPECT_TRUE(world.solids[2].world_from_solid.translation().isApprox(Eigen::Vector3d(3, 1, 1.1)));
}

TEST(WorldFile, TakesAMapForAWorld) {
  const TemporaryFolder folder;
  MapImage map;
  map.width_cells = map.height_cells = 3;
  map.cells.assign(9, Cell::kFree);
  map.cells[4] = Cell::kOccupied;
  writeMap(map, folder / "map");
  const World world = readWorld(folder / "map.yaml");
  ASSERT_EQ(world.solids.size(), 2U);
  EXPECT_NEAR(world.solids[0].world_from_solid.translation().x(), 0.075, 1e-12);
  EXPECT_TRUE(world.solids[0].solid && !world.solids[0].seen) << "what the chassis meets";
  EXPECT_TRUE(world.solids[1].seen && !world.solids[1].solid) << "what the lidar sees";
  LidarParameters p;
  p.range_sigma_m = 0.0;
  const SensorPath path{{0}, {Eigen::Isometry3d(Eigen::Translation3d(-1.0, 0.075, 0.37))}};
  EXPECT_NEAR(Lidar(p, 1).measure(0, 0, path, RayCaster(world)).ranges_m[540], 1.05, 1e-3);
}

TEST(WorldFile, ReadsTheShippedWorldWithAFreeStart) {
  const World world = readWorld(std::string(CONFIG_FOLDER) + "/worlds/office.yaml");
  EXPECT_GT(world.solids.size(), 100U);
  EXPECT_NO_THROW(Physics(testing::shippedRobot(), world, world.start));
}

double residentMemory_MB() {
  constexpr double kPage_MB = 4096e-6;
  std::ifstream stream("/proc/self/statm");
  double all = 0.0;
  double resident = 0.0;
  stream >> all >> resident;
  return resident * kPage_MB;
}

TEST(WorldFile, LoadedAHundredTimesTakesNoMoreMemory) {
  const TemporaryFolder folder;
  writeMap(drawMap(generateOffice({}).world, 0.37, 0.05), folder / "office");
  const auto load = [&folder](int times) {
    for (int i = 0; i < times; ++i) {
      const World map = readWorld(folder / "office.yaml");
      EXPECT_GT(map.solids.size(), 10U);
      RayCaster{map};
    }
    return residentMemory_MB();
  };
  const double after_ten_MB = load(10);
  EXPECT_LT(load(100), after_ten_MB + 4.0);
}

TEST(WorldFile, RefusesBadFilesByElement) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& yaml) {
    return refusalOf(readWorld, folder.write("world.yaml", yaml));
  };
  ASSERT_EQ(refusal("{}"), "accepted");
  EXPECT_THAT(refusal("walls: 3"), AllOf(HasSubstr("world.yaml"), HasSubstr("walls")));
  EXPECT_THAT(refusal("walls: [3]"), HasSubstr("walls[0]"));
  EXPECT_THAT(refusal("walls: [{from: [0, 0], to: [1, 0]}, {from: [0, 0]}]"),
              HasSubstr("walls[1]"));
  EXPECT_THAT(refusal("walls: [{from: [1, 1], to: [1, 1]}]"), HasSubstr("length"));
  EXPECT_THAT(refusal("walls: [{from: [0, 0], to: [1, .nan]}]"), HasSubstr("walls[0]"));
  EXPECT_THAT(refusal("walls: [{from: [0, 0], to: [1, 0], height_m: -1}]"), HasSubstr("height_m"));
  EXPECT_THAT(refusal("walls: [{from: [0, 0], to: [1, 0], thick: 1}]"), HasSubstr("thick"));
  EXPECT_THAT(refusal("walls: [{from: [0, 0], to: [1, 0], bottom_m: 1e30}]"),
              HasSubstr("bottom_m"));
  EXPECT_THAT(refusal("boxes: [{center: [0, 0, 0], size: [1, 0, 1]}]"), HasSubstr("size"));
  EXPECT_THAT(refusal("boxes: [{center: [0, 0], size: [1, 1, 1]}]"), HasSubstr("center"));
  EXPECT_THAT(refusal("boxes: [{center: [0, 0, 1e30], size: [1, 1, 1]}]"), HasSubstr("100 km"));
  EXPECT_THAT(refusal("cylinders: [{center: [0, 0]}]"), HasSubstr("radius_m"));
  EXPECT_THAT(refusal("cylinders: [{center: [0, 0], radius_m: 1, bottom_m: -1e30}]"),
              HasSubstr("bottom_m"));
  EXPECT_THAT(refusal("start: [0, 0]"), HasSubstr("start"));
  EXPECT_THAT(refusal("floor_friction: -1"), HasSubstr("floor_friction"));
  EXPECT_THAT(refusal("spheres: []"), HasSubstr("spheres"));
  EXPECT_THAT(refusal("walls: [{from: [0, 0"), HasSubstr("world.yaml"));
  EXPECT_THAT(refusal("just text"), HasSubstr("world.yaml"));
  EXPECT_THAT(refusalOf(readWorld, folder / "none.yaml"), HasSubstr("none.yaml"));
}

std::string textOf(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(WorldFile, TheShippedOfficeIsWhatTheGeneratorWritesToday) {
  const testing::TemporaryFolder folder;
  const Office office = generateOffice({});
  writeWorldFile(office.world, folder / "office.yaml");
  writeTour(office.tour, folder / "office_tour.yaml");
  for (const char* file : {"office.yaml", "office_tour.yaml"}) {
    const std::string shipped = textOf(std::string(CONFIG_FOLDER) + "/worlds/" + file);
    ASSERT_FALSE(shipped.empty());
    EXPECT_TRUE(textOf(folder / file) == shipped) << file;
  }
}

TEST(WorldFile, RampsRiseFromTheFloorAndAreWrittenAgain) {
  const testing::TemporaryFolder folder;
  const World world = readWorld(
      folder.write("ramps.yaml",
                   "ramps: [{from: [1, 2], to: [1, 4], width_m: 1.5, height_m: 0.3}]\n"
                   "boxes: [{center: [1, 5, 0.15], size: [2, 2, 0.3], drivable: true}]\n"));
  ASSERT_EQ(world.solids.size(), 2U);
  for (const Solid& solid : world.solids) EXPECT_TRUE(solid.drivable);
  const Solid& ramp =
      *std::min_element(world.solids.begin(), world.solids.end(),
                        [](const Solid& a, const Solid& b) { return a.size_m.z() < b.size_m.z(); });
  const Eigen::Vector3d half = 0.5 * ramp.size_m;
  EXPECT_TRUE((ramp.world_from_solid * Eigen::Vector3d(-half.x(), 0.0, half.z()))
                  .isApprox(Eigen::Vector3d(1.0, 2.0, 0.0), 1e-9));
  EXPECT_TRUE((ramp.world_from_solid * Eigen::Vector3d(half.x(), 0.0, half.z()))
                  .isApprox(Eigen::Vector3d(1.0, 4.0, 0.3), 1e-9));
  writeWorldFile(world, folder / "copy.yaml");
  const World copy = readWorld(folder / "copy.yaml");
  ASSERT_EQ(copy.solids.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(copy.solids[i].drivable);
    EXPECT_TRUE(copy.solids[i].world_from_solid.isApprox(world.solids[i].world_from_solid, 1e-5));
  }
  EXPECT_THROW(
      readWorld(folder.write("flat.yaml", "ramps: [{from: [1, 2], to: [1, 2], height_m: 1}]\n")),
      std::invalid_argument);
}

TEST(WorldFile, ReadsOrRefusesDamagedFilesButNeverFailsOtherwise) {
  const TemporaryFolder folder;
  int accepted = 0;
  int refused = 0;
  for (std::uint64_t trial = 0; trial < 300; ++trial) {
    Random random(3, Stream::kBuilding, trial);
    std::string text = kWorld;
    constexpr char kReplacements[] = "0123456789.-,[]{}: \n\t\x01\xff";
    text[random.bits() % text.size()] = kReplacements[random.bits() % (sizeof(kReplacements) - 1)];
    const std::string answer = refusalOf(readWorld, folder.write("world.yaml", text));
    (answer == "accepted" ? accepted : refused) += 1;
  }
  EXPECT_GT(accepted, 30);
  EXPECT_GT(refused, 30);
}

TEST(WorldFile, CanHoldAnOffice) {
  const TemporaryFolder folder;
  const World world = readWorld(folder.write(
      "w.yaml", "office: {seed: 4, people: 2}\nfloor_friction: 0.5\ngravity: [0.8, 0, -9.8]\n"));
  EXPECT_EQ(world.solids.size(), generateOffice([] {
                                   OfficeParameters p;
                                   p.seed = 4;
                                   return p;
                                 }())
                                     .world.solids.size());
  EXPECT_EQ(world.people.size(), 2U);
  EXPECT_EQ(world.floor_friction, 0.5);
  EXPECT_EQ(world.gravity_mps2.x(), 0.8) << "the floor is a slope";
  EXPECT_THAT(refusalOf(readWorld, folder.write("w.yaml", "office: {seed: 4, poeple: 2}")),
              HasSubstr("poeple"));
}

}  // namespace
}  // namespace ramscout_sim
