// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/occupancy/map_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "ram_slam/io/atomic_file.hpp"

namespace ram_slam {
namespace {

// Pixels and percentages of map_server's map_saver.
constexpr char kOccupiedPixel = 0;
constexpr char kFreePixel = static_cast<char>(254);
constexpr char kUnknownPixel = static_cast<char>(205);
constexpr int kOccupiedFromPercent = 65;
constexpr int kFreeToPercent = 25;
/// Of a yaml file, and of an image's header, which have some hundred.
constexpr std::size_t kMaxTextBytes = 65536;

/// Nine digits: what was read is written again as it was.
std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

char toPixel(std::int8_t cell) {
  if (cell >= kOccupiedFromPercent) return kOccupiedPixel;
  return cell >= 0 && cell <= kFreeToPercent ? kFreePixel : kUnknownPixel;
}

/// Content of the yaml.
struct MapDescription {
  std::string image;
  double resolution_m = 0.0;
  Pose2 origin;
  bool negate = false;
  double occupied_thresh = 0.0;
  double free_thresh = 0.0;
  std::string mode = "trinary";
};

/// Reads the keys of one map description; every error names file, key and line.
class DescriptionReader {
public:
  explicit DescriptionReader(const std::string& path) : path_(path) {
    try {
      map_ = YAML::Load(readWholeFile(path, kMaxTextBytes));
    } catch (const YAML::Exception& error) {
      throw std::runtime_error("reading " + path + ": " + error.what());
    }
    if (!map_.IsMap())
      throw std::runtime_error("reading " + path + ": it is not a map of keys and values");
  }

  bool has(const std::string& key) const { return static_cast<bool>(map_[key]); }

  template <typename Value>
  Value read(const std::string& key, const char* wanted) const {
    const YAML::Node node = map_[key];
    if (!node) throw std::runtime_error("reading " + path_ + ": key '" + key + "' is missing");
    try {
      return node.as<Value>();
    } catch (const YAML::Exception&) {
      fail(key, wanted);
    }
  }

  [[noreturn]] void fail(const std::string& key, const char* wanted) const {
    throw std::runtime_error("reading " + path_ + ", line " +
                             std::to_string(map_[key].Mark().line + 1) + ": '" + key +
                             "' must be " + wanted);
  }
  void require(bool condition, const std::string& key, const char* wanted) const {
    if (!condition) fail(key, wanted);
  }

private:
  std::string path_;
  YAML::Node map_;
};

MapDescription readDescription(const std::string& path) {
  const DescriptionReader reader(path);
  MapDescription map;
  constexpr const char* kImage = "the name of a pgm file";
  map.image = reader.read<std::string>("image", kImage);
  reader.require(!map.image.empty() && map.image.find('\0') == std::string::npos, "image", kImage);

  constexpr const char* kResolution = "a positive number [m]";
  map.resolution_m = reader.read<double>("resolution", kResolution);
  reader.require(map.resolution_m > 0.0 && std::isfinite(map.resolution_m), "resolution",
                 kResolution);

  constexpr const char* kOrigin = "[x, y, yaw], finite";
  const auto origin = reader.read<std::vector<double>>("origin", kOrigin);
  reader.require(origin.size() == 3, "origin", kOrigin);
  map.origin = {origin[0], origin[1], origin[2]};
  reader.require(map.origin.isFinite(), "origin", kOrigin);

  constexpr const char* kNegate = "0 or 1";
  const int negate = reader.read<int>("negate", kNegate);
  reader.require(negate == 0 || negate == 1, "negate", kNegate);
  map.negate = negate == 1;

  constexpr const char* kThreshold = "in [0, 1], and free_thresh below occupied_thresh";
  map.occupied_thresh = reader.read<double>("occupied_thresh", kThreshold);
  map.free_thresh = reader.read<double>("free_thresh", kThreshold);
  reader.require(map.occupied_thresh >= 0.0 && map.occupied_thresh <= 1.0, "occupied_thresh",
                 kThreshold);
  reader.require(map.free_thresh >= 0.0 && map.free_thresh < map.occupied_thresh, "free_thresh",
                 kThreshold);

  constexpr const char* kMode = "trinary, scale or raw";
  if (reader.has("mode")) map.mode = reader.read<std::string>("mode", kMode);
  reader.require(map.mode == "trinary" || map.mode == "scale" || map.mode == "raw", "mode", kMode);
  return map;
}

/// Value of a pixel, as map_server's image loader has it.
std::int8_t toCell(unsigned char pixel, const MapDescription& map) {
  if (map.mode == "raw")
    return pixel <= kOccupiedCell ? static_cast<std::int8_t>(pixel) : kUnknownCell;
  const double occupancy = (map.negate ? pixel : 255 - pixel) / 255.0;
  if (occupancy > map.occupied_thresh) return kOccupiedCell;
  if (occupancy < map.free_thresh) return kFreeCell;
  if (map.mode == "trinary") return kUnknownCell;
  const double ratio = (occupancy - map.free_thresh) / (map.occupied_thresh - map.free_thresh);
  return static_cast<std::int8_t>(1.0 + 98.0 * ratio);
}

/// A binary grey image; `pixels` is its tail.
struct Image {
  int width = 0;
  int height = 0;
  std::string pixels;
};

/// Reads the parts of a pgm header.
class PgmHeader {
public:
  PgmHeader(const std::string& bytes, std::string path) : bytes_(bytes), path_(std::move(path)) {
    if (bytes.compare(0, 2, "P5") != 0) fail("it is not a binary grey image (P5)");
    position_ = 2;
  }

  /// The next number, after white space and comments.
  int readNumber(const char* name) {
    skipSpace();
    const std::size_t begin = position_;
    int value = 0;
    while (position_ < bytes_.size() && bytes_[position_] >= '0' && bytes_[position_] <= '9') {
      if (position_ - begin >= 8) fail(std::string(name) + " is too large");
      value = 10 * value + (bytes_[position_++] - '0');
    }
    if (position_ == begin) fail(std::string("its header has no ") + name);
    return value;
  }
  /// Where the pixels start: after the single white space that ends the header.
  std::size_t end() {
    if (position_ >= bytes_.size() || !isSpace(bytes_[position_])) fail("its header does not end");
    return position_ + 1;
  }
  [[noreturn]] void fail(const std::string& reason) const {
    throw std::runtime_error("reading " + path_ + ": " + reason);
  }

private:
  static bool isSpace(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }
  void skipSpace() {
    while (position_ < bytes_.size() && (isSpace(bytes_[position_]) || bytes_[position_] == '#')) {
      if (bytes_[position_] == '#')
        position_ = std::min(bytes_.find('\n', position_), bytes_.size() - 1);
      ++position_;
    }
  }

  const std::string& bytes_;
  std::string path_;
  std::size_t position_ = 0;
};

Image readImage(const std::string& path) {
  Image image;
  image.pixels = readWholeFile(path, kMaxGridCells + kMaxTextBytes);
  PgmHeader header(image.pixels, path);
  image.width = header.readNumber("width");
  image.height = header.readNumber("height");
  const int maxval = header.readNumber("maxval");
  const std::size_t begin = header.end();
  if (maxval != 255) header.fail("its maxval must be 255, got " + std::to_string(maxval));
  const std::size_t size =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (size == 0) header.fail("it has no pixels");
  if (size > kMaxGridCells)
    header.fail("it has more than " + std::to_string(kMaxGridCells) + " pixels");
  if (image.pixels.size() - begin != size) {
    header.fail("it has " + std::to_string(image.pixels.size() - begin) + " pixels, not " +
                std::to_string(size) + " as in its header");
  }
  image.pixels.erase(0, begin);
  return image;
}

std::string nameOf(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

/// Where in a description as it is written here the name of its image begins, and its length.
std::pair<std::size_t, std::size_t> placeOfImage(const std::string& yaml) {
  constexpr std::size_t kKeyLength = 7;
  if (yaml.rfind("image: ", 0) != 0) return {0, 0};
  return {kKeyLength, std::min(yaml.find('\n'), yaml.size()) - kKeyLength};
}

std::string withImage(std::string yaml, const std::string& image_path) {
  const auto [begin, length] = placeOfImage(yaml);
  return yaml.replace(begin, length, nameOf(image_path));
}

/// Whether there is a saved map: a description that was written here, and its image.
bool refersTo(const std::string& yaml_path, const std::string& image_path) {
  std::error_code none;
  if (!std::filesystem::exists(yaml_path, none) || !std::filesystem::exists(image_path, none))
    return false;
  const std::string yaml = readWholeFile(yaml_path, kMaxTextBytes);
  const auto [begin, length] = placeOfImage(yaml);
  return length > 0 && yaml.substr(begin, length) == nameOf(image_path);
}

}  // namespace

MapFile toMapFile(const OccupancyGrid& grid, const std::string& image_name) {
  if (grid.width <= 0 || grid.height <= 0 || grid.cells.size() != grid.index(0, grid.height)) {
    throw std::invalid_argument("cannot save a map of " + std::to_string(grid.width) + " x " +
                                std::to_string(grid.height) + " with " +
                                std::to_string(grid.cells.size()) + " cells");
  }
  MapFile file;
  file.pgm = "P5\n# CREATOR: ram_slam " + number(grid.resolution_m) + " m/pix\n" +
             std::to_string(grid.width) + " " + std::to_string(grid.height) + "\n255\n";
  file.pgm.reserve(file.pgm.size() + grid.cells.size());
  for (int y = grid.height - 1; y >= 0; --y) {
    for (int x = 0; x < grid.width; ++x) file.pgm += toPixel(grid.cells[grid.index(x, y)]);
  }
  const Pose2& origin = grid.map_from_grid;
  file.yaml = "image: " + image_name + "\nresolution: " + number(grid.resolution_m) +
              "\norigin: [" + number(origin.x_m) + ", " + number(origin.y_m) + ", " +
              number(origin.yaw_rad) +
              "]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n\n";
  return file;
}

void saveMap(const OccupancyGrid& grid, const std::string& stem) {
  const MapFile file = toMapFile(grid, nameOf(stem + ".pgm"));
  const std::string image_path = stem + ".pgm";
  const std::string yaml_path = stem + ".yaml";
  const std::string previous_path = stem + ".previous.pgm";
  // The two files cannot be replaced in one step: until the new description is there, the old one
  // refers to a copy of the old image.
  if (refersTo(yaml_path, image_path)) {
    writeFileAtomically(previous_path, readWholeFile(image_path));
    writeFileAtomically(yaml_path,
                        withImage(readWholeFile(yaml_path, kMaxTextBytes), previous_path));
  }
  writeFileAtomically(image_path, file.pgm);
  writeFileAtomically(yaml_path, file.yaml);
  std::error_code none;
  std::filesystem::remove(previous_path, none);
}

OccupancyGrid loadMap(const std::string& yaml_path) {
  const MapDescription map = readDescription(yaml_path);
  const std::filesystem::path image_path =
      std::filesystem::path(yaml_path).parent_path() / map.image;
  const Image image = readImage(image_path.string());
  OccupancyGrid grid;
  grid.resolution_m = map.resolution_m;
  grid.map_from_grid = map.origin;
  grid.width = image.width;
  grid.height = image.height;
  grid.cells.resize(image.pixels.size());
  for (int y = 0; y < grid.height; ++y) {
    const std::size_t row = grid.index(0, grid.height - 1 - y);
    for (int x = 0; x < grid.width; ++x) {
      grid.cells[grid.index(x, y)] =
          toCell(static_cast<unsigned char>(image.pixels[row + static_cast<std::size_t>(x)]), map);
    }
  }
  return grid;
}

}  // namespace ram_slam
