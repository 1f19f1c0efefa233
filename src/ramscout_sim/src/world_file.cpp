// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>
#include <stdexcept>

#include "ram_parameters/parameter_reader.hpp"
#include "ramscout_sim/map_image.hpp"
#include "ramscout_sim/model_files.hpp"
#include "ramscout_sim/office.hpp"
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

/// The waypoints or the appointments of an element: a list of pairs.
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

/// Reads a world file into a World.
class WorldFile {
public:
  WorldFile(const YAML::Node& file, std::string path) : file_(file), path_(std::move(path)) {
    world_.materials = standardMaterials();
  }

  World read() {
    ParameterReader top(file_, path_);
    for (const char* list :
         {"materials", "walls", "boxes", "ramps", "cylinders", "include", "people", "doors"}) {
      top.has(list);
    }
    top.read("floor_friction", world_.floor_friction);
    requireIn(path_, "floor_friction", world_.floor_friction, 0.0, 10.0);
    if (top.has("office")) {
      ParameterReader office = top.section("office");
      addOffice(readOfficeParameters(office));
    }
    readList(file_, path_, "materials", [this](ParameterReader& element, const std::string& name) {
      addMaterial(readMaterial(element, name));
    });
    if (top.has("start")) {
      const std::vector<double> start = readVector(top, path_, "start", 3);
      world_.start = {start[0], start[1], start[2]};
    }
    if (top.has("gravity")) {
      const std::vector<double> gravity = readVector(top, path_, "gravity", 3);
      world_.gravity_mps2 = {gravity[0], gravity[1], gravity[2]};
      requireIn(path_, "gravity: length", world_.gravity_mps2.norm(), 0.1, 100.0);
    }
    top.rejectUnknown();
    readSolids("walls", readWall);
    readSolids("boxes", readBox);
    readSolids("ramps", readRamp);
    readSolids("cylinders", readCylinder);
    readEach("include", &WorldFile::readInclude);
    readEach("people", &WorldFile::readPerson);
    readEach("doors", &WorldFile::readDoor);
    return world_;
  }

private:
  void addMaterial(const Material& material) {
    for (Material& known : world_.materials) {
      if (known.name == material.name) {
        known = material;
        return;
      }
    }
    world_.materials.push_back(material);
  }

  void addOffice(const OfficeParameters& parameters) {
    World office = generateOffice(parameters).world;
    office.floor_friction = world_.floor_friction;
    world_ = std::move(office);
    for (const Person& person : world_.people) names_.insert(person.name);
    for (const Door& door : world_.doors) names_.insert(door.name);
  }

  std::size_t readMaterialName(ParameterReader& element, const std::string& name) const {
    std::string wanted = world_.materials.front().name;
    element.read("material", wanted);
    std::string known;
    for (std::size_t i = 0; i < world_.materials.size(); ++i) {
      if (world_.materials[i].name == wanted) return i;
      known += (i == 0 ? "" : ", ") + world_.materials[i].name;
    }
    throw std::invalid_argument(name + ".material: must be one of " + known + ", got '" + wanted +
                                "'");
  }

  void readSolids(const char* key, Solid (*readOne)(ParameterReader&, const std::string&)) {
    readList(file_, path_, key, [&](ParameterReader& element, const std::string& name) {
      Solid solid = readOne(element, name);
      solid.material = readMaterialName(element, name);
      world_.solids.push_back(solid);
    });
  }

  void readEach(const char* key,
                void (WorldFile::*readOne)(ParameterReader&,
                                           const std::string&,
                                           const YAML::Node&)) {
    std::size_t index = 0;
    readList(file_, path_, key, [&](ParameterReader& element, const std::string& name) {
      (this->*readOne)(element, name, file_[key][index++]);
    });
  }

  void readInclude(ParameterReader& element, const std::string& name, const YAML::Node&) {
    std::string file;
    std::vector<double> position = {0.0, 0.0, 0.0};
    double yaw_rad = 0.0;
    double scale = 1.0;
    element.read("file", file);
    if (file.empty()) throw std::invalid_argument(name + ".file: is missing");
    if (element.has("position")) position = readVector(element, name, "position", 3);
    element.read("yaw_rad", yaw_rad);
    element.read("scale", scale);
    requireIn(name, "scale", scale, 1e-6, 1e6);
    const std::size_t material = readMaterialName(element, name);
    const Eigen::Isometry3d world_from_model =
        Eigen::Translation3d(position[0], position[1], position[2]) *
        Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
    const std::filesystem::path whole = std::filesystem::path(path_).parent_path() / file;
    for (Solid& solid : readModel(whole.string())) {
      scaleSolid(solid, scale);
      solid.world_from_solid = world_from_model * solid.world_from_solid;
      solid.material = material;
      world_.solids.push_back(solid);
    }
  }

  static void scaleSolid(Solid& solid, double scale) {
    if (scale == 1.0) return;
    solid.size_m *= scale;
    solid.world_from_solid.translation() *= scale;
    if (!solid.mesh) return;
    TriangleMesh mesh = *solid.mesh;
    for (Eigen::Vector3f& vertex : mesh.vertices_m) vertex *= static_cast<float>(scale);
    solid.mesh = std::make_shared<TriangleMesh>(std::move(mesh));
  }

  void requireNewName(const std::string& actor, const std::string& name) {
    if (actor.empty()) throw std::invalid_argument(name + ".name: is missing");
    if (!names_.insert(actor).second) {
      throw std::invalid_argument(name + ".name: there are two called '" + actor + "'");
    }
  }

  void readPerson(ParameterReader& element, const std::string& name, const YAML::Node& node) {
    Person person;
    element.read("name", person.name);
    requireNewName(person.name, name);
    element.has("waypoints");
    person.waypoints_m = readPairs(node["waypoints"], name + ".waypoints");
    if (person.waypoints_m.empty())
      throw std::invalid_argument(name + ".waypoints: must hold at least one");
    element.read("speed_mps", person.speed_mps);
    element.read("loop", person.loop);
    element.read("start_s", person.start_s);
    element.read("height_m", person.height_m);
    requireIn(name, "speed_mps", person.speed_mps, 0.0, 10.0);
    requireIn(name, "start_s", person.start_s, 0.0, 1e6);
    requireIn(name, "height_m", person.height_m, 0.5, 2.5);
    person.material = readMaterialName(element, name);
    world_.people.push_back(person);
  }

  void readDoor(ParameterReader& element, const std::string& name, const YAML::Node& node) {
    Door door;
    element.read("name", door.name);
    requireNewName(door.name, name);
    const std::vector<double> hinge = readVector(element, name, "hinge", 2);
    door.hinge_m = {hinge[0], hinge[1]};
    element.read("width_m", door.width_m);
    element.read("thickness_m", door.thickness_m);
    element.read("height_m", door.height_m);
    element.read("closed_yaw_rad", door.closed_yaw_rad);
    element.read("open_angle_rad", door.open_angle_rad);
    element.read("turn_speed_radps", door.turn_speed_radps);
    element.read("openness", door.openness);
    requireIn(name, "width_m", door.width_m, 0.1, 10.0);
    requireIn(name, "thickness_m", door.thickness_m, 0.001, 1.0);
    requireIn(name, "height_m", door.height_m, 0.1, 10.0);
    requireIn(name, "open_angle_rad", std::abs(door.open_angle_rad), 0.01, 2.0 * M_PI);
    requireIn(name, "turn_speed_radps", door.turn_speed_radps, 0.01, 10.0);
    requireIn(name, "openness", door.openness, 0.0, 1.0);
    if (element.has("schedule")) {
      for (const Eigen::Vector2d& pair : readPairs(node["schedule"], name + ".schedule")) {
        requireIn(name, "schedule: time", pair.x(), 0.0, 1e6);
        requireIn(name, "schedule: openness", pair.y(), 0.0, 1.0);
        door.schedule.push_back({pair.x(), pair.y()});
      }
    }
    door.material = readMaterialName(element, name);
    world_.doors.push_back(door);
  }

  YAML::Node file_;
  std::string path_;
  World world_;
  std::set<std::string> names_;
};

World fromMap(const std::string& path) {
  const MapImage map = readMap(path);
  World world;
  world.solids = extrude(map, kMapWallHeight_m);
  if (world.solids.empty()) return world;
  for (Solid& box : world.solids) box.seen = false;
  world.solids.push_back(extrudeOutlines(map, kMapWallHeight_m));
  return world;
}

}  // namespace

World readWorld(const std::string& path) {
  if (isModelFile(path)) {
    World world;
    world.materials = standardMaterials();
    world.solids = readModel(path);
    return world;
  }
  const YAML::Node file = ram_parameters::readYamlFile(path);
  if (file.IsMap() && file["image"]) return fromMap(path);
  return WorldFile(file, path).read();
}

}  // namespace ramscout_sim
