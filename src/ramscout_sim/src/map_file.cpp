// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "ram_parameters/parameter_reader.hpp"
#include "ramscout_sim/map_image.hpp"

namespace ramscout_sim {
namespace {

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;  // row-major, top row first
};

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw std::runtime_error(path + ": " + reason);
}

/// The next number of a PGM header; comments run from # to the end of the line.
int readHeaderNumber(std::istream& stream, const std::string& path, int largest) {
  while (true) {
    const int next = stream.peek();
    if (next == '#') {
      stream.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    } else if (next != EOF && std::isspace(next)) {
      stream.get();
    } else {
      break;
    }
  }
  int value = 0;
  if (!(stream >> value) || value < 1 || value > largest) {
    refuse(path, "the PGM header must hold width, height (1 to " +
                     std::to_string(kLargestMapSide_cells) + ") and a largest value of 1 to 255");
  }
  return value;
}

Picture readPgm(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) refuse(path, "cannot be opened");
  char magic[2] = {};
  stream.read(magic, 2);
  if (!stream || magic[0] != 'P' || magic[1] != '5') refuse(path, "not a binary PGM (magic P5)");
  Picture picture;
  picture.width = readHeaderNumber(stream, path, kLargestMapSide_cells);
  picture.height = readHeaderNumber(stream, path, kLargestMapSide_cells);
  const int largest = readHeaderNumber(stream, path, 255);
  stream.get();
  const std::size_t size = static_cast<std::size_t>(picture.width) * picture.height;
  std::error_code error;
  if (std::filesystem::file_size(path, error) < size || error)
    refuse(path, "ends before its last pixel");
  picture.pixels.resize(size);
  stream.read(reinterpret_cast<char*>(picture.pixels.data()), static_cast<std::streamsize>(size));
  if (!stream) refuse(path, "ends before its last pixel");
  if (largest != 255) {
    for (std::uint8_t& pixel : picture.pixels) {
      pixel = static_cast<std::uint8_t>(std::min<int>(pixel, largest) * 255 / largest);
    }
  }
  return picture;
}

struct MapHeader {
  std::string image;
  double resolution = 0.0;
  std::vector<double> origin;
  double occupied_thresh = 0.65;
  double free_thresh = 0.196;
  int negate = 0;
  std::string mode = "trinary";
};

MapHeader readMapHeader(const std::string& path) {
  ram_parameters::ParameterReader reader(ram_parameters::readYamlFile(path), path);
  MapHeader header;
  reader.read("image", header.image);
  reader.read("resolution", header.resolution);
  reader.read("origin", header.origin);
  reader.read("occupied_thresh", header.occupied_thresh);
  reader.read("free_thresh", header.free_thresh);
  reader.read("negate", header.negate);
  reader.read("mode", header.mode);
  reader.rejectUnknown();
  if (header.image.empty()) refuse(path, "image: the name of a PGM file is missing");
  if (!(header.resolution > 0.0 && header.resolution <= 10.0)) {
    refuse(path, "resolution: must be in (0, 10] m, got " + std::to_string(header.resolution));
  }
  if (header.origin.size() != 3) refuse(path, "origin: must be [x, y, yaw]");
  for (const double value : header.origin) {
    if (!(std::abs(value) <= kLargestCoordinate_m))
      refuse(path, "origin: " + std::to_string(value) + " is beyond 100 km");
  }
  if (!(0.0 <= header.free_thresh && header.free_thresh < header.occupied_thresh &&
        header.occupied_thresh <= 1.0)) {
    refuse(path, "free_thresh and occupied_thresh: must satisfy 0 <= free < occupied <= 1");
  }
  if (header.negate != 0 && header.negate != 1) refuse(path, "negate: must be 0 or 1");
  if (header.mode != "trinary" && header.mode != "scale")
    refuse(path, "mode: must be trinary or scale");
  return header;
}

/// Writes a file beside its place and renames it there: on a full disk the old one stays.
void writeWhole(const std::string& path, const std::string& content) {
  const std::string unfinished = path + ".unfinished";
  std::ofstream stream(unfinished, std::ios::binary);
  stream << content;
  stream.close();
  std::error_code error;
  if (stream) std::filesystem::rename(unfinished, path, error);
  if (stream && !error) return;
  std::filesystem::remove(unfinished, error);
  refuse(path, "cannot be written");
}

}  // namespace

MapImage readMap(const std::string& yaml_path) {
  const MapHeader header = readMapHeader(yaml_path);
  std::filesystem::path image = header.image;
  if (image.is_relative()) image = std::filesystem::path(yaml_path).parent_path() / image;
  const Picture picture = readPgm(image.string());
  MapImage map;
  map.width_cells = picture.width;
  map.height_cells = picture.height;
  map.resolution_m = header.resolution;
  map.world_from_map = {header.origin[0], header.origin[1], header.origin[2]};
  map.cells.reserve(picture.pixels.size());
  for (int row = picture.height - 1; row >= 0; --row) {
    for (int column = 0; column < picture.width; ++column) {
      const double grey =
          picture.pixels[static_cast<std::size_t>(row) * picture.width + column] / 255.0;
      const double occupied = header.negate != 0 ? grey : 1.0 - grey;
      map.cells.push_back(occupied > header.occupied_thresh ? Cell::kOccupied
                          : occupied < header.free_thresh   ? Cell::kFree
                                                            : Cell::kUnknown);
    }
  }
  return map;
}

void writeMap(const MapImage& map, const std::string& path_without_suffix) {
  const std::string pgm_path = path_without_suffix + ".pgm";
  std::ostringstream pgm;
  pgm << "P5\n" << map.width_cells << ' ' << map.height_cells << "\n255\n";
  for (int row = map.height_cells - 1; row >= 0; --row) {
    for (int column = 0; column < map.width_cells; ++column) {
      const Cell cell = map.at(column, row);
      pgm.put(static_cast<char>(cell == Cell::kFree ? 254 : cell == Cell::kOccupied ? 0 : 205));
    }
  }
  writeWhole(pgm_path, pgm.str());

  std::ostringstream yaml;
  yaml.precision(17);
  yaml << "image: " << std::filesystem::path(pgm_path).filename().string()
       << "\nresolution: " << map.resolution_m << "\norigin: [" << map.world_from_map.x_m << ", "
       << map.world_from_map.y_m << ", " << map.world_from_map.yaw_rad
       << "]\noccupied_thresh: 0.65\nfree_thresh: 0.196\nnegate: 0\n";
  writeWhole(path_without_suffix + ".yaml", yaml.str());
}

}  // namespace ramscout_sim
