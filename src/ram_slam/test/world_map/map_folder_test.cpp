// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/world_map/map_folder.hpp"

#include <filesystem>
#include <stdexcept>

#include <gmock/gmock.h>
#include <unistd.h>

#include "ram_slam/io/atomic_file.hpp"
#include "ram_slam/occupancy/map_file.hpp"

#include "example_world.hpp"

namespace ram_slam {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class MapFolder : public testing::Test {
protected:
  MapFolder() : folder_(testing::TempDir() + "map_folder_" + std::to_string(::getpid())) {
    std::filesystem::create_directory(folder_);
  }
  ~MapFolder() override { std::filesystem::remove_all(folder_); }

  std::string folder_;
  std::string first_ = folder_ + "/first";
  std::string second_ = folder_ + "/second";
};

TEST_F(MapFolder, SavedLoadedAndSavedAgainHasTheSameBytes) {
  saveMapFolder(exampleWorld(), "map", first_);
  saveMapFolder(loadWorldMap(first_), "map", second_);
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(first_)) {
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(readWholeFile(first_ + "/" + name), readWholeFile(second_ + "/" + name)) << name;
    ++count;
  }
  EXPECT_EQ(count, 3);
}

TEST_F(MapFolder, HasTheGridOfTheWholeMapAsAnImage) {
  saveMapFolder(exampleWorld(), "map", first_);
  const OccupancyGrid grid = loadMap(first_ + "/map.yaml");
  EXPECT_EQ(grid.cells, exampleWorld().occupancies().at("map")->grid.cells);
}

TEST_F(MapFolder, WithoutAGridOfTheWholeMapHasNoImage) {
  WorldMap map;
  map.put(exampleLandmarks());
  saveMapFolder(map, "map", first_);
  EXPECT_FALSE(std::filesystem::exists(first_ + "/map.pgm"));
  EXPECT_EQ(loadWorldMap(first_).landmarks().landmarks.size(), 3u);
}

TEST_F(MapFolder, IsRefusedByTheNameOfItsFileIfItIsDamagedOrMissing) {
  saveMapFolder(exampleWorld(), "map", first_);
  const std::string file = first_ + "/map.world";
  const std::string bytes = readWholeFile(file);
  writeFileAtomically(file, bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT([&] { loadWorldMap(first_); },
              ThrowsMessage<std::runtime_error>(HasSubstr(file + ": it is cut short")));
  std::string flipped = bytes;
  flipped[bytes.size() - 100] ^= 1;
  writeFileAtomically(file, flipped);
  EXPECT_THAT([&] { loadWorldMap(first_); },
              ThrowsMessage<std::runtime_error>(HasSubstr(file + ": it is damaged")));
  std::filesystem::remove(file);
  EXPECT_THAT([&] { loadWorldMap(first_); }, ThrowsMessage<std::runtime_error>(HasSubstr(file)));
  EXPECT_THAT([&] { loadWorldMap(second_); },
              ThrowsMessage<std::runtime_error>(HasSubstr("No such file")));
}

}  // namespace
}  // namespace ram_slam
