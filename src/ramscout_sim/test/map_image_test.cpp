// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/map_image.hpp"

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "ramscout_sim/random.hpp"

#include "shared.hpp"
#include "temporary_folder.hpp"

namespace ramscout_sim {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::refusalOf;
using testing::TemporaryFolder;

const char* const kYaml = "image: map.pgm\nresolution: 0.1\norigin: [1, 2, 0]\n";
const std::string kPgm = std::string("P5\n# made by hand\n3 2\n255\n") + '\x00' + '\xfe' + '\xcd' +
                         '\xfe' + '\xfe' + '\x00';

/// A picture of text, top row first: # occupied, . free, ? unknown.
MapImage draw(const std::vector<std::string>& rows, const Pose2& world_from_map = {}) {
  MapImage map;
  map.width_cells = static_cast<int>(rows.front().size());
  map.height_cells = static_cast<int>(rows.size());
  map.resolution_m = 0.1;
  map.world_from_map = world_from_map;
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    for (const char cell : *row)
      map.cells.push_back(cell == '#'   ? Cell::kOccupied
                          : cell == '.' ? Cell::kFree
                                        : Cell::kUnknown);
  }
  return map;
}

TEST(ReadMap, PutsTheFirstPixelAtTheTopLeft) {
  const TemporaryFolder folder;
  folder.write("map.pgm", kPgm);
  const MapImage map = readMap(folder.write("map.yaml", kYaml));
  EXPECT_EQ(map.width_cells, 3);
  EXPECT_EQ(map.height_cells, 2);
  EXPECT_EQ(map.resolution_m, 0.1);
  EXPECT_EQ(map.world_from_map.y_m, 2.0);
  EXPECT_EQ(map.at(0, 1), Cell::kOccupied);
  EXPECT_EQ(map.at(1, 1), Cell::kFree);
  EXPECT_EQ(map.at(2, 1), Cell::kUnknown);
  EXPECT_EQ(map.at(2, 0), Cell::kOccupied);
}

TEST(ReadMap, NegatesAndScalesGreyLevels) {
  const TemporaryFolder folder;
  folder.write("map.pgm", std::string("P5 2 1 100\n") + '\x64' + '\x00');
  const std::string path = folder.write("map.yaml", kYaml + std::string("negate: 1\n"));
  EXPECT_THAT(readMap(path).cells, ElementsAre(Cell::kOccupied, Cell::kFree));
  folder.write("map.yaml", kYaml);
  EXPECT_THAT(readMap(path).cells, ElementsAre(Cell::kFree, Cell::kOccupied));
}

TEST(ReadMap, ReadsCommentsAndLeavesWhatFollowsThePictureAlone) {
  const TemporaryFolder folder;
  const std::string path = folder.write("map.yaml", kYaml);
  folder.write("map.pgm",
               "P5 # kind\n# and\n2 # wide\n1\n255\n\xfe" + std::string(1, '\0') + "more bytes");
  EXPECT_THAT(readMap(path).cells, ElementsAre(Cell::kFree, Cell::kOccupied));
}

TEST(ReadMap, ReadsYamlOfOtherSystems) {
  const TemporaryFolder folder;
  folder.write("map.pgm", kPgm);
  const std::string returns = "image: map.pgm\r\nresolution: 0.1\r\norigin: [1, 2, 0]\r\n";
  EXPECT_EQ(readMap(folder.write("returns.yaml", returns)).width_cells, 3);
  EXPECT_EQ(readMap(folder.write("mark.yaml", std::string("\xef\xbb\xbf") + kYaml)).width_cells, 3);
}

TEST(ReadMap, TakesTheNameOfThePictureAsItIs) {
  const TemporaryFolder folder;
  const auto read = [&folder](const std::string& image) {
    const std::string yaml = "image: \"" + image + "\"\nresolution: 0.1\norigin: [1, 2, 0]\n";
    return refusalOf(readMap, folder.write("map.yaml", yaml));
  };
  for (const std::string name :
       {"of the hall.pgm", "a;touch b.pgm", "$(touch b).pgm", "Zür\u00e4ß 地図.pgm"}) {
    EXPECT_THAT(read(name), HasSubstr("cannot be opened")) << name;
    folder.write(name, kPgm);
    EXPECT_EQ(read(name), "accepted") << name;
    EXPECT_EQ(read(folder / name), "accepted") << name;  // from the root
  }
  EXPECT_EQ(read("../" + std::filesystem::path(folder / "").parent_path().filename().string() +
                 "/of the hall.pgm"),
            "accepted");
  EXPECT_FALSE(std::filesystem::exists(folder / "b"));
  EXPECT_FALSE(std::filesystem::exists("b"));
  EXPECT_THAT(read("~/of the hall.pgm"), HasSubstr("cannot be opened"));
  EXPECT_THAT(read(std::string(5000, 'x')), HasSubstr("cannot be opened"));
}

TEST(ReadMap, AliasesOfAliasesOfAliasesTakeNoTime) {
  const TemporaryFolder folder;
  folder.write("map.pgm", kPgm);
  std::string yaml = "a0: &a0 [x]\n";
  for (int i = 1; i < 40; ++i) {  // 10^40 elements
    const std::string before = "*a" + std::to_string(i - 1);
    yaml += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
    for (int k = 1; k < 10; ++k) yaml += ", " + before;
    yaml += "]\n";
  }
  EXPECT_THAT(refusalOf(readMap, folder.write("map.yaml", yaml + kYaml)), HasSubstr("a0"));
  EXPECT_THAT(
      refusalOf(
          readMap,
          folder.write("map.yaml", yaml + "image: map.pgm\nresolution: *a39\norigin: [1, 2, 0]\n")),
      HasSubstr("resolution"));
}

TEST(ReadMap, RefusesBadPictures) {
  const TemporaryFolder folder;
  const std::string path = folder.write("map.yaml", kYaml);
  const auto refusal = [&](const std::string& pgm) {
    folder.write("map.pgm", pgm);
    return refusalOf(readMap, path);
  };
  const std::string pixels(6, '\x00');
  EXPECT_THAT(refusal(""), HasSubstr("P5"));
  EXPECT_THAT(refusal("P2\n3 2\n255\n0 0 0 0 0 0\n"), AllOf(HasSubstr("map.pgm"), HasSubstr("P5")));
  EXPECT_THAT(refusal("P5\n0 0\n255\n"), HasSubstr("width, height"));
  EXPECT_THAT(refusal("P5\n-3 2\n255\n" + pixels), HasSubstr("width, height"));
  EXPECT_THAT(refusal("P5\n100000 100000\n255\n" + pixels), HasSubstr("16384"));
  EXPECT_THAT(refusal("P5\n99999999999999 2\n255\n" + pixels), HasSubstr("16384"));
  EXPECT_THAT(refusal("P5\n16384 16384\n255\n" + pixels), HasSubstr("last pixel"));
  EXPECT_THAT(refusal("P5\n3 2\n65535\n" + pixels + pixels), HasSubstr("largest value"));
  EXPECT_THAT(refusal("P5\n3 2\n255\n" + pixels.substr(1)), HasSubstr("last pixel"));
  EXPECT_THAT(refusal("P5\n3 2\n# no end of the comment"), HasSubstr("largest value"));
}

TEST(ReadMap, RefusesBadYamlByKey) {
  const TemporaryFolder folder;
  folder.write("map.pgm", kPgm);
  const auto refusal = [&](const std::string& yaml) {
    return refusalOf(readMap, folder.write("map.yaml", yaml));
  };
  const std::string good = kYaml;
  const auto with = [&good](const std::string& before, const std::string& after) {
    std::string text = good;
    return text.replace(text.find(before), before.size(), after);
  };
  ASSERT_EQ(refusal(good), "accepted");
  EXPECT_THAT(refusal(with("image: map.pgm\n", "")), HasSubstr("image"));
  EXPECT_THAT(refusal(with("map.pgm", "none.pgm")), HasSubstr("none.pgm"));
  EXPECT_THAT(refusal(with("map.pgm", "\"$(touch here).pgm\"")), HasSubstr("cannot be opened"));
  EXPECT_THAT(refusal(with("0.1", "0")), HasSubstr("resolution"));
  EXPECT_THAT(refusal(with("0.1", "-0.1")), HasSubstr("resolution"));
  EXPECT_THAT(refusal(with("0.1", ".nan")), HasSubstr("resolution"));
  EXPECT_THAT(refusal(with("resolution: 0.1\n", "")), HasSubstr("resolution"));
  EXPECT_THAT(refusal(with("origin: [1, 2, 0]\n", "")), HasSubstr("origin"));
  EXPECT_THAT(refusal(with("[1, 2, 0]", "[1, 2]")), HasSubstr("origin"));
  EXPECT_THAT(refusal(with("[1, 2, 0]", "[.inf, 2, 0]")), HasSubstr("origin"));
  EXPECT_THAT(refusal(with("[1, 2, 0]", "[1e30, 2, 0]")), HasSubstr("origin"));
  EXPECT_THAT(refusal(good + "negate: 2\n"), HasSubstr("negate"));
  EXPECT_THAT(refusal(good + "mode: raw\n"), HasSubstr("mode"));
  EXPECT_THAT(refusal(good + "occupied_thresh: 0.1\n"), HasSubstr("occupied_thresh"));
  EXPECT_THAT(refusal(good + "free_thresh: -1\n"), HasSubstr("free_thresh"));
  EXPECT_THAT(refusal(good + "occupied_thresh: 1.5\n"), HasSubstr("occupied_thresh"));
  EXPECT_THAT(refusal(good + "free_thresh: .nan\n"), HasSubstr("free_thresh"));
  EXPECT_THAT(refusal(good + "color: red\n"), HasSubstr("color"));
  EXPECT_THAT(refusal("\t" + good), HasSubstr("map.yaml"));
  EXPECT_THAT(refusal("[1, 2]"), HasSubstr("map.yaml"));
}

TEST(ReadMap, ReadsOrRefusesDamagedFilesButNeverFailsOtherwise) {
  const TemporaryFolder folder;
  int accepted = 0;
  int refused = 0;
  for (std::uint64_t trial = 0; trial < 300; ++trial) {
    Random random(2, Stream::kBuilding, trial);
    std::string yaml = kYaml;
    std::string pgm = kPgm;
    std::string& damaged = trial % 2 == 0 ? yaml : pgm;
    damaged[random.bits() % damaged.size()] = static_cast<char>(random.bits() % 256);
    folder.write("map.pgm", pgm);
    const std::string answer = refusalOf(readMap, folder.write("map.yaml", yaml));
    (answer == "accepted" ? accepted : refused) += 1;
  }
  EXPECT_GT(accepted, 30);
  EXPECT_GT(refused, 30);
}

TEST(WriteMap, IsReadBackTheSame) {
  const TemporaryFolder folder;
  const MapImage map = draw({"#.?", "..#"}, {-1.25, 3.5, 0.25});
  writeMap(map, folder / "copy of a map");
  const MapImage copy = readMap(folder / "copy of a map.yaml");
  EXPECT_EQ(copy.cells, map.cells);
  EXPECT_EQ(copy.width_cells, 3);
  EXPECT_EQ(copy.world_from_map.x_m, -1.25);
  EXPECT_EQ(copy.world_from_map.yaw_rad, 0.25);
  EXPECT_THROW(writeMap(map, folder / "no/such/folder"), std::runtime_error);
}

TEST(Extrude, MakesOneBoxOfAWall) {
  const std::vector<Solid> solids = extrude(draw({".....", ".###.", ".###."}), 2.0);
  ASSERT_EQ(solids.size(), 1U);
  EXPECT_TRUE(solids[0].size_m.isApprox(Eigen::Vector3d(0.3, 0.2, 2.0)));
  EXPECT_TRUE(solids[0].world_from_solid.translation().isApprox(Eigen::Vector3d(0.25, 0.1, 1.0)));
}

TEST(Extrude, PutsTheBoxesRelativeToTheOrigin) {
  const std::vector<Solid> solids = extrude(draw({"..#"}, {1.0, 2.0, M_PI_2}), 2.0);
  ASSERT_EQ(solids.size(), 1U);
  EXPECT_TRUE(
      solids[0].world_from_solid.translation().isApprox(Eigen::Vector3d(0.95, 2.25, 1.0), 1e-9));
}

TEST(Extrude, CoversOccupiedCellsAndNoOthersWithFewBoxes) {
  Random random(4, Stream::kBuilding);
  MapImage map = draw({std::string(40, '.')});
  map.height_cells = 30;
  map.cells.assign(1200, Cell::kFree);
  for (Cell& cell : map.cells) {
    if (random.uniform() < 0.3) cell = Cell::kOccupied;
  }
  std::vector<int> covered(1200, 0);
  for (const Solid& box : extrude(map, 1.0)) {
    const Eigen::Vector3d low = box.world_from_solid * Eigen::Vector3d(-0.5 * box.size_m);
    const Eigen::Vector3d high = box.world_from_solid * Eigen::Vector3d(0.5 * box.size_m);
    for (long row = std::lround(low.y() / 0.1); row < std::lround(high.y() / 0.1); ++row) {
      for (long column = std::lround(low.x() / 0.1); column < std::lround(high.x() / 0.1); ++column)
        ++covered[static_cast<std::size_t>(row * 40 + column)];
    }
  }
  for (std::size_t i = 0; i < 1200; ++i)
    ASSERT_EQ(covered[i], map.cells[i] == Cell::kOccupied ? 1 : 0) << i;
}

TEST(DrawMap, DrawsWallsFreeSpaceAndTheUnreachable) {
  World room = testing::makeRoom(2.0, 1.0);
  Solid table;  // above the lidar, and a box below it: neither is seen
  table.size_m = {0.4, 0.4, 0.1};
  table.world_from_solid.translation() = Eigen::Vector3d(0.5, 0.5, 0.9);
  room.solids.push_back(table);
  table.world_from_solid.translation().z() = 0.31;
  room.solids.push_back(table);
  const MapImage map = drawMap(room, 0.37, 0.05);
  const auto at = [&map](double x, double y) {
    return map.at(static_cast<int>(std::floor((x - map.world_from_map.x_m) / 0.05)),
                  static_cast<int>(std::floor((y - map.world_from_map.y_m) / 0.05)));
  };
  EXPECT_EQ(at(1.0, 0.5), Cell::kFree);
  EXPECT_EQ(at(0.5, 0.5), Cell::kFree);
  EXPECT_EQ(at(-0.1, 0.5), Cell::kOccupied);
  EXPECT_EQ(at(1.0, 1.1), Cell::kOccupied);
  EXPECT_EQ(at(-0.6, 0.5), Cell::kUnknown);
  EXPECT_EQ(at(1.0, 1.8), Cell::kUnknown);
}

TEST(DrawMap, RefusesMoreCellsThanAMapMayHave) {
  EXPECT_THROW(drawMap(testing::makeRoom(100.0, 10.0), 0.37, 0.001), std::invalid_argument);
  EXPECT_THROW(drawMap(testing::makeRoom(2.0, 1.0), 0.37, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace ramscout_sim
