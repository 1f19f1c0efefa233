// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "ramscout_sim/world.hpp"

namespace ramscout_sim {
namespace {

void writeNumbers(std::ostream& stream, std::initializer_list<double> numbers) {
  const char* separator = "[";
  for (const double number : numbers) {
    stream << separator << (std::abs(number) < 5e-7 ? 0.0 : number);
    separator = ", ";
  }
  stream << ']';
}

void writeMaterials(const World& world, std::ostream& stream) {
  stream << "materials:\n";
  for (const Material& material : world.materials) {
    stream << "  - {name: " << material.name << ", reflectivity: " << material.reflectivity;
    if (material.surface == Surface::kGlass)
      stream << ", surface: glass, return_angle_rad: " << material.glass_return_angle_rad;
    if (material.surface == Surface::kMirror) stream << ", surface: mirror";
    stream << "}\n";
  }
}

void writeMaterialOf(std::size_t material, const World& world, std::ostream& stream) {
  if (material != 0) stream << ", material: " << world.materials[material].name;
  stream << "}\n";
}

void writeBox(const Solid& box, const World& world, std::ostream& stream) {
  const Eigen::Vector3d center = box.world_from_solid.translation();
  const Eigen::Vector3d forward = box.world_from_solid.linear().col(0);
  stream << "  - {center: ";
  writeNumbers(stream, {center.x(), center.y(), center.z()});
  stream << ", size: ";
  writeNumbers(stream, {box.size_m.x(), box.size_m.y(), box.size_m.z()});
  stream << ", yaw_rad: " << std::atan2(forward.y(), forward.x());
  const double pitch_rad = std::atan2(-forward.z(), forward.head<2>().norm());
  if (std::abs(pitch_rad) > 1e-9) stream << ", pitch_rad: " << pitch_rad;
  if (box.drivable) stream << ", drivable: true";
  writeMaterialOf(box.material, world, stream);
}

void writeCylinder(const Solid& cylinder, const World& world, std::ostream& stream) {
  const Eigen::Vector3d center = cylinder.world_from_solid.translation();
  stream << "  - {center: ";
  writeNumbers(stream, {center.x(), center.y()});
  stream << ", radius_m: " << 0.5 * cylinder.size_m.x() << ", height_m: " << cylinder.size_m.z()
         << ", bottom_m: " << center.z() - 0.5 * cylinder.size_m.z();
  writeMaterialOf(cylinder.material, world, stream);
}

void writePerson(const Person& person, const World& world, std::ostream& stream) {
  stream << "  - {name: " << person.name << ", waypoints: [";
  for (std::size_t i = 0; i < person.waypoints_m.size(); ++i) {
    if (i > 0) stream << ", ";
    writeNumbers(stream, {person.waypoints_m[i].x(), person.waypoints_m[i].y()});
  }
  stream << "], speed_mps: " << person.speed_mps << ", height_m: " << person.height_m
         << ", start_s: " << person.start_s << ", loop: " << (person.loop ? "true" : "false");
  writeMaterialOf(person.material, world, stream);
}

void writeDoor(const Door& door, const World& world, std::ostream& stream) {
  stream << "  - {name: " << door.name << ", hinge: ";
  writeNumbers(stream, {door.hinge_m.x(), door.hinge_m.y()});
  stream << ", width_m: " << door.width_m << ", thickness_m: " << door.thickness_m
         << ", height_m: " << door.height_m << ", closed_yaw_rad: " << door.closed_yaw_rad
         << ", open_angle_rad: " << door.open_angle_rad
         << ", turn_speed_radps: " << door.turn_speed_radps << ", openness: " << door.openness;
  if (!door.schedule.empty()) {
    stream << ", schedule: [";
    for (std::size_t i = 0; i < door.schedule.size(); ++i) {
      if (i > 0) stream << ", ";
      writeNumbers(stream, {door.schedule[i].time_s, door.schedule[i].openness});
    }
    stream << ']';
  }
  writeMaterialOf(door.material, world, stream);
}

}  // namespace

void writeWorldFile(const World& world, const std::string& path) {
  std::ofstream stream(path);
  stream.precision(7);
  stream << "start: ";
  writeNumbers(stream, {world.start.x_m, world.start.y_m, world.start.yaw_rad});
  stream << "\nfloor_friction: " << world.floor_friction << '\n';
  for (const Solid& solid : world.solids) {
    if (solid.shape != Shape::kBox && solid.shape != Shape::kCylinder)
      throw std::invalid_argument(path + ": a world file holds boxes and cylinders only");
  }
  writeMaterials(world, stream);
  stream << "boxes:\n";
  for (const Solid& solid : world.solids) {
    if (solid.shape == Shape::kBox) writeBox(solid, world, stream);
  }
  stream << "cylinders:\n";
  for (const Solid& solid : world.solids) {
    if (solid.shape == Shape::kCylinder) writeCylinder(solid, world, stream);
  }
  if (!world.people.empty()) stream << "people:\n";
  for (const Person& person : world.people) writePerson(person, world, stream);
  if (!world.doors.empty()) stream << "doors:\n";
  for (const Door& door : world.doors) writeDoor(door, world, stream);
  stream.close();
  if (!stream) throw std::runtime_error(path + ": cannot be written");
}

}  // namespace ramscout_sim
