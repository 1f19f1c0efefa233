// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <functional>
#include <stdexcept>

#include "ram_parameters/parameter_reader.hpp"
#include "ramscout_sim/map_image.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {
namespace {

using ram_parameters::ParameterReader;

constexpr double kMapWallHeight_m = 2.5;
constexpr double kLargestCoordinate_m = 1e5;

/// One list of the world file: hands each element to `read` with a reader that names it in errors.
void readList(const YAML::Node& file,
              const std::string& path,
              const std::string& key,
              const std::function<void(ParameterReader&, const std::string&)>& read) {
  const YAML::Node list = file[key];
  if (!list || list.IsNull()) return;
  if (!list.IsSequence()) throw std::invalid_argument(path + ": " + key + ": must be a list");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string name = path + ": " + key + "[" + std::to_string(i) + "]";
    ParameterReader reader(list[i], name);
    read(reader, name);
    reader.rejectUnknown();
  }
}

std::vector<double> readVector(ParameterReader& reader,
                               const std::string& name,
                               const std::string& key,
                               std::size_t size) {
  std::vector<double> values;
  reader.read(key, values);
  if (values.size() != size) {
    throw std::invalid_argument(name + "." + key + ": must be a list of " + std::to_string(size) +
                                " numbers");
  }
  for (const double value : values) {
    if (!(std::abs(value) <= kLargestCoordinate_m)) {
      throw std::invalid_argument(name + "." + key + ": " + std::to_string(value) +
                                  " is beyond 100 km");
    }
  }
  return values;
}

void requirePositive(const std::string& name, const char* key, double value) {
  if (!(value > 0.0 && value <= kLargestCoordinate_m)) {
    throw std::invalid_argument(name + "." + key + ": must be > 0, got " + std::to_string(value));
  }
}

double readBottom(ParameterReader& reader, const std::string& name) {
  double bottom_m = 0.0;
  reader.read("bottom_m", bottom_m);
  if (!(std::abs(bottom_m) <= kLargestCoordinate_m)) {
    throw std::invalid_argument(name + ".bottom_m: " + std::to_string(bottom_m) +
                                " is beyond 100 km");
  }
  return bottom_m;
}

Solid readWall(ParameterReader& reader, const std::string& name) {
  const std::vector<double> begin = readVector(reader, name, "from", 2);
  const std::vector<double> end = readVector(reader, name, "to", 2);
  double thickness_m = 0.1;
  double height_m = 2.5;
  reader.read("thickness_m", thickness_m);
  reader.read("height_m", height_m);
  const double bottom_m = readBottom(reader, name);
  requirePositive(name, "thickness_m", thickness_m);
  requirePositive(name, "height_m", height_m);
  Solid wall = makeWall({begin[0], begin[1]}, {end[0], end[1]}, thickness_m, height_m);
  requirePositive(name, "from/to: length", wall.size_m.x());
  wall.world_from_solid.pretranslate(Eigen::Vector3d(0.0, 0.0, bottom_m));
  return wall;
}

Solid readBox(ParameterReader& reader, const std::string& name) {
  const std::vector<double> center = readVector(reader, name, "center", 3);
  const std::vector<double> size = readVector(reader, name, "size", 3);
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
  reader.read("yaw_rad", yaw_rad);
  reader.read("pitch_rad", pitch_rad);
  for (const double edge : size) requirePositive(name, "size", edge);
  Solid box;
  box.world_from_solid.translate(Eigen::Vector3d(center[0], center[1], center[2]));
  box.world_from_solid.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  box.world_from_solid.rotate(Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()));
  box.size_m = {size[0], size[1], size[2]};
  return box;
}

Solid readCylinder(ParameterReader& reader, const std::string& name) {
  const std::vector<double> center = readVector(reader, name, "center", 2);
  double radius_m = 0.0;
  double height_m = 2.5;
  reader.read("radius_m", radius_m);
  reader.read("height_m", height_m);
  const double bottom_m = readBottom(reader, name);
  requirePositive(name, "radius_m", radius_m);
  requirePositive(name, "height_m", height_m);
  Solid cylinder;
  cylinder.shape = Shape::kCylinder;
  cylinder.world_from_solid.translate(
      Eigen::Vector3d(center[0], center[1], bottom_m + 0.5 * height_m));
  cylinder.size_m = {2.0 * radius_m, 2.0 * radius_m, height_m};
  return cylinder;
}

World readWorldFile(const YAML::Node& file, const std::string& path) {
  World world;
  ParameterReader reader(file, path);
  for (const char* list : {"walls", "boxes", "cylinders"}) reader.has(list);
  if (reader.has("start")) {
    const std::vector<double> start = readVector(reader, path, "start", 3);
    world.start = {start[0], start[1], start[2]};
  }
  reader.read("floor_friction", world.floor_friction);
  if (!(world.floor_friction >= 0.0 && world.floor_friction <= 10.0)) {
    throw std::invalid_argument(path + ": floor_friction: must be in [0, 10], got " +
                                std::to_string(world.floor_friction));
  }
  reader.rejectUnknown();
  const auto add = [&world](Solid (*read)(ParameterReader&, const std::string&)) {
    return [&world, read](ParameterReader& element, const std::string& name) {
      world.solids.push_back(read(element, name));
    };
  };
  readList(file, path, "walls", add(readWall));
  readList(file, path, "boxes", add(readBox));
  readList(file, path, "cylinders", add(readCylinder));
  return world;
}

}  // namespace

World readWorld(const std::string& path) {
  const YAML::Node file = ram_parameters::readYamlFile(path);
  if (!file.IsMap() || !file["image"]) return readWorldFile(file, path);
  World world;
  world.solids = extrude(readMap(path), kMapWallHeight_m);
  return world;
}

}  // namespace ramscout_sim
