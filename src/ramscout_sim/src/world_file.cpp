// SPDX-License-Identifier: BSD-3-Clause
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

#include "world_elements.hpp"

namespace ramscout_sim {
namespace {

using ram_parameters::ParameterReader;

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
  world.solids = extrude(map, kWallHeight_m);
  if (world.solids.empty()) return world;
  for (Solid& box : world.solids) box.seen = false;
  world.solids.push_back(extrudeOutlines(map, kWallHeight_m));
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
