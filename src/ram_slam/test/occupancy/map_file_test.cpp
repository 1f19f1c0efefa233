// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/occupancy/map_file.hpp"

#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <utility>

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ram_slam/io/atomic_file.hpp"

namespace ram_slam {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Three columns, two rows; the lower row is occupied, free, unknown.
OccupancyGrid smallGrid() {
  OccupancyGrid grid;
  grid.map_from_grid = {-51.2, 3.2, 0.0};
  grid.width = 3;
  grid.height = 2;
  grid.cells = {100, 0, -1, 0, 0, 100};
  return grid;
}

constexpr const char* kGoodYaml =
    "image: map.pgm\nresolution: 0.05\norigin: [-51.2, 3.2, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
    "free_thresh: 0.196\n\n";

/// The good description with one part of it replaced.
std::string yamlWith(const std::string& to, const std::string& instead_of) {
  std::string yaml = kGoodYaml;
  return yaml.replace(yaml.find(instead_of), instead_of.size(), to);
}

class MapFileTest : public testing::Test {
protected:
  MapFileTest() : folder_(testing::TempDir() + "map_file_" + std::to_string(::getpid())) {
    std::filesystem::create_directory(folder_);
  }
  ~MapFileTest() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  std::string read(const std::string& name) const { return readWholeFile(path(name), 1000000); }
  void write(const std::string& name, const std::string& content) const {
    writeFileAtomically(path(name), content);
  }

  std::string folder_;
};

TEST(ToMapFile, IsWhatMapServerReads) {
  const MapFile file = toMapFile(smallGrid(), "map.pgm");
  EXPECT_EQ(file.yaml, kGoodYaml);
  // The upper row comes first.
  EXPECT_EQ(file.pgm, "P5\n# CREATOR: ram_slam 0.05 m/pix\n3 2\n255\n\xfe\xfe" +
                          std::string(2, '\0') + "\xfe\xcd");
}

TEST(ToMapFile, RefusesAGridThatIsNotWhole) {
  OccupancyGrid grid = smallGrid();
  grid.cells.pop_back();
  EXPECT_THROW(toMapFile(grid, "map.pgm"), std::invalid_argument);
  EXPECT_THROW(toMapFile(OccupancyGrid{}, "map.pgm"), std::invalid_argument);
}

TEST_F(MapFileTest, LoadsWhatWasSaved) {
  saveMap(smallGrid(), path("map"));
  const OccupancyGrid loaded = loadMap(path("map.yaml"));
  EXPECT_EQ(loaded.cells, smallGrid().cells);
  EXPECT_EQ(loaded.width, 3);
  EXPECT_EQ(loaded.height, 2);
  EXPECT_EQ(loaded.resolution_m, 0.05);
  EXPECT_EQ(loaded.map_from_grid.x_m, -51.2);
}

TEST_F(MapFileTest, SavedLoadedAndSavedAgainIsTheSameToTheByte) {
  OccupancyGrid grid = smallGrid();
  grid.resolution_m = 1.0 / 3.0;
  grid.map_from_grid = {-1000.0 / 7.0, 1e-7, 0.0};
  saveMap(grid, path("map"));
  const std::string pgm = read("map.pgm");
  const std::string yaml = read("map.yaml");
  saveMap(loadMap(path("map.yaml")), path("map"));
  EXPECT_EQ(read("map.pgm"), pgm);
  EXPECT_EQ(read("map.yaml"), yaml);
}

TEST_F(MapFileTest, AMapperKilledWhileItSavesLeavesTheOldMapOrTheNewOne) {
  OccupancyGrid large = smallGrid();
  large.map_from_grid = {7.0, -2.0, 0.5};
  large.width = 600;
  large.height = 500;
  large.cells.assign(large.index(0, large.height), kOccupiedCell);
  saveMap(smallGrid(), path("map"));
  for (int attempt = 0; attempt < 40; ++attempt) {
    const pid_t mapper = ::fork();
    ASSERT_GE(mapper, 0);
    if (mapper == 0) {
      for (;;) {
        saveMap(large, path("map"));
        saveMap(smallGrid(), path("map"));
      }
    }
    ::usleep(static_cast<useconds_t>(1000 + 431 * attempt));
    ::kill(mapper, SIGKILL);
    ::waitpid(mapper, nullptr, 0);
    const OccupancyGrid map = loadMap(path("map.yaml"));
    ASSERT_EQ(map.map_from_grid.x_m, map.width == 600 ? 7.0 : -51.2) << attempt;
  }
  saveMap(smallGrid(), path("map"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 2)
      << "nothing is left behind";
}

TEST_F(MapFileTest, UnknownStaysUnknownAtTheThresholdWrittenAndWouldBeFreeAtALargerOne) {
  saveMap(smallGrid(), path("map"));
  EXPECT_EQ(loadMap(path("map.yaml")).at(2, 0),
            kUnknownCell);  // 50 / 255 = 0.19608 is not below 0.196
  write("map.yaml", yamlWith("0.25", "0.196"));
  EXPECT_EQ(loadMap(path("map.yaml")).at(2, 0), kFreeCell);
}

TEST_F(MapFileTest, NegateAndModesAreHonoured) {
  write("map.pgm", std::string("P5 5 1 255\n") + std::string("\x00\x40\x80\xc8\xff", 5));
  write("map.yaml", kGoodYaml);
  EXPECT_THAT(loadMap(path("map.yaml")).cells, ElementsAre(100, 100, -1, -1, 0));
  write("map.yaml", yamlWith("negate: 1", "negate: 0"));
  EXPECT_THAT(loadMap(path("map.yaml")).cells, ElementsAre(0, -1, -1, 100, 100));
  write("map.yaml", kGoodYaml + std::string("mode: raw\n"));
  EXPECT_THAT(loadMap(path("map.yaml")).cells, ElementsAre(0, 64, -1, -1, -1));
  write("map.yaml", kGoodYaml + std::string("mode: scale\n"));
  // 1 + 98 (127 / 255 - 0.196) / 0.454 = 66.2 and 1 + 98 (55 / 255 - 0.196) / 0.454 = 5.2
  EXPECT_THAT(loadMap(path("map.yaml")).cells, ElementsAre(100, 100, 66, 5, 0));
}

TEST_F(MapFileTest, ImagesThatAreNotWholeAreRefusedWithAReason) {
  write("map.yaml", kGoodYaml);
  const std::pair<const char*, const char*> images[] = {
      {"", "P5"},
      {"P2\n1 1\n255\n0", "P5"},
      {"P6\n1 1\n255\nabc", "P5"},
      {"P5", "no width"},
      {"P5\n1", "no height"},
      {"P5\n# comment without end", "no width"},
      {"P5\n-1 1\n255\nx", "no width"},
      {"P5\n1 1\n254\nx", "maxval"},
      {"P5\n1 1\n65535\nxx", "maxval"},
      {"P5\n1 1\n255", "does not end"},
      {"P5\n0 0\n255\n", "no pixels"},
      {"P5\n0 5\n255\n", "no pixels"},
      {"P5\n100000 100000\n255\nx", "more than"},
      {"P5\n99999999999 1\n255\nx", "too large"},
      {"P5\n2 2\n255\nxyz", "3 pixels, not 4 as in its header"},
      {"P5\n2 2\n255\nxyzab", "5 pixels, not 4 as in its header"},
  };
  for (const auto& [image, reason] : images) {
    write("map.pgm", image);
    EXPECT_THAT([&] { loadMap(path("map.yaml")); },
                ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("map.pgm"), HasSubstr(reason))))
        << image;
  }
  write("map.pgm", "P5 # a\n# b\n 1\t1 \r\n255\nx");
  EXPECT_NO_THROW(loadMap(path("map.yaml")));
}

TEST_F(MapFileTest, EveryTruncationOfAnImageIsRefused) {
  saveMap(smallGrid(), path("map"));
  const std::string pgm = read("map.pgm");
  for (std::size_t size = 0; size < pgm.size(); ++size) {
    write("map.pgm", pgm.substr(0, size));
    EXPECT_THROW(loadMap(path("map.yaml")), std::runtime_error) << size;
  }
}

TEST_F(MapFileTest, DescriptionsThatMakeNoSenseAreRefusedWithKeyAndLine) {
  saveMap(smallGrid(), path("map"));
  const std::pair<std::string, const char*> descriptions[] = {
      {"", "not a map"},
      {"- a\n", "not a map"},
      {yamlWith("", "image: map.pgm\n"), "'image' is missing"},
      {yamlWith("", "resolution: 0.05\n"), "'resolution' is missing"},
      {yamlWith("", "origin: [-51.2, 3.2, 0]\n"), "'origin' is missing"},
      {yamlWith("resolution: 0", "resolution: 0.05"), "line 2: 'resolution'"},
      {yamlWith("-1", "0.05"), "line 2: 'resolution'"},
      {yamlWith(".nan", "0.05"), "line 2: 'resolution'"},
      {yamlWith("fine", "0.05"), "line 2: 'resolution'"},
      {yamlWith("[-51.2, 3.2]", "[-51.2, 3.2, 0]"), "line 3: 'origin'"},
      {yamlWith(".inf", "-51.2"), "line 3: 'origin'"},
      {yamlWith("5", "[-51.2, 3.2, 0]"), "line 3: 'origin'"},
      {yamlWith("negate: 2", "negate: 0"), "line 4: 'negate'"},
      {yamlWith("65", "0.65"), "line 5: 'occupied_thresh'"},
      {yamlWith("0.7", "0.196"), "line 6: 'free_thresh'"},
      {yamlWith("-0.1", "0.196"), "line 6: 'free_thresh'"},
      {kGoodYaml + std::string("mode: colour\n"), "'mode'"},
      {yamlWith("other.pgm", "map.pgm"), "No such file or directory"},
      {yamlWith("~/map.pgm", "map.pgm"), "No such file or directory"},
      {yamlWith("''", "map.pgm"), "line 1: 'image'"},
      {yamlWith(".", "map.pgm"), "directory"},
      {"\timage: [", "map.yaml"},
      {std::string(100000, '#'), "at most"},
  };
  for (const auto& [yaml, reason] : descriptions) {
    write("map.yaml", yaml);
    EXPECT_THAT([&] { loadMap(path("map.yaml")); },
                ThrowsMessage<std::exception>(HasSubstr(reason)))
        << yaml;
  }
}

TEST_F(MapFileTest, HarmlessVariationsOfADescriptionAreAccepted) {
  saveMap(smallGrid(), path("map"));
  std::string windows_lines;
  for (const char c : std::string(kGoodYaml))
    windows_lines += c == '\n' ? "\r\n" : std::string(1, c);
  for (const std::string& yaml :
       {windows_lines, std::string("\xef\xbb\xbf") + kGoodYaml,
        kGoodYaml + std::string("extra: 1\n"), yamlWith(path("map.pgm"), "map.pgm"),
        yamlWith("&a 0.05", "0.05") + "other: *a\n"}) {
    write("map.yaml", yaml);
    EXPECT_EQ(loadMap(path("map.yaml")).cells, smallGrid().cells) << yaml;
  }
}

}  // namespace
}  // namespace ram_slam
