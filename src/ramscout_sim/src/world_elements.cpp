// SPDX-License-Identifier: BSD-3-Clause
#include "world_elements.hpp"

#include <cmath>
#include <stdexcept>

namespace ramscout_sim {
namespace {

using ram_parameters::ParameterReader;

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

}  // namespace

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

Solid readWall(ParameterReader& reader, const std::string& name) {
  const std::vector<double> begin = readVector(reader, name, "from", 2);
  const std::vector<double> end = readVector(reader, name, "to", 2);
  double thickness_m = 0.1;
  double height_m = kWallHeight_m;
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
  reader.read("drivable", box.drivable);
  box.world_from_solid.translate(Eigen::Vector3d(center[0], center[1], center[2]));
  box.world_from_solid.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  box.world_from_solid.rotate(Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()));
  box.size_m = {size[0], size[1], size[2]};
  return box;
}

Solid readRamp(ParameterReader& reader, const std::string& name) {
  const std::vector<double> begin = readVector(reader, name, "from", 2);
  const std::vector<double> end = readVector(reader, name, "to", 2);
  double width_m = 1.0;
  double height_m = 0.0;
  reader.read("width_m", width_m);
  reader.read("height_m", height_m);
  requirePositive(name, "width_m", width_m);
  requirePositive(name, "height_m", height_m);
  const Solid ramp = makeRamp({begin[0], begin[1]}, {end[0], end[1]}, width_m, height_m);
  requirePositive(name, "from/to: length", std::hypot(begin[0] - end[0], begin[1] - end[1]));
  return ramp;
}

Solid readCylinder(ParameterReader& reader, const std::string& name) {
  const std::vector<double> center = readVector(reader, name, "center", 2);
  double radius_m = 0.0;
  double height_m = kWallHeight_m;
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

std::vector<Eigen::Vector2d> readPairs(const YAML::Node& list, const std::string& name) {
  if (!list || !list.IsSequence()) throw std::invalid_argument(name + ": must be a list of pairs");
  std::vector<Eigen::Vector2d> pairs;
  for (const YAML::Node& item : list) {
    YAML::Node wrapped;
    wrapped["pair"] = item;
    ParameterReader reader(wrapped, name);
    const std::vector<double> pair = readVector(reader, name, "pair", 2);
    pairs.emplace_back(pair[0], pair[1]);
  }
  return pairs;
}

void requireIn(const std::string& name, const char* key, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    throw std::invalid_argument(name + "." + key + ": must be in [" + std::to_string(low) + ", " +
                                std::to_string(high) + "], got " + std::to_string(value));
  }
}

Material readMaterial(ParameterReader& reader, const std::string& name) {
  Material material;
  material.name.clear();
  reader.read("name", material.name);
  if (material.name.empty()) throw std::invalid_argument(name + ".name: is missing");
  std::string surface = "opaque";
  reader.read("surface", surface);
  if (surface == "glass") {
    material.surface = Surface::kGlass;
  } else if (surface == "mirror") {
    material.surface = Surface::kMirror;
  } else if (surface != "opaque") {
    throw std::invalid_argument(name + ".surface: must be opaque, glass or mirror, got '" +
                                surface + "'");
  }
  reader.read("reflectivity", material.reflectivity);
  reader.read("return_angle_rad", material.glass_return_angle_rad);
  requireIn(name, "reflectivity", material.reflectivity, 0.0, 1.0);
  requireIn(name, "return_angle_rad", material.glass_return_angle_rad, 1e-3, 1.6);
  return material;
}

}  // namespace ramscout_sim
