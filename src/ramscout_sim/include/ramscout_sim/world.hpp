// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "ramscout_sim/pose2.hpp"

namespace ramscout_sim {

/// What the light of a lidar does at a surface: is scattered, goes through, or is mirrored.
enum class Surface { kOpaque, kGlass, kMirror };

/// What a solid is made of, as far as light cares.
struct Material {
  std::string name = "plaster";
  Surface surface = Surface::kOpaque;
  /// Share of the light that is scattered back: white paper 0.9, black cloth 0.05.
  double reflectivity = 0.9;
  /// Glass gives a return with probability exp(-(incidence / this)^2 / 2) and lets all else pass.
  double glass_return_angle_rad = 0.1;
};

/// Triangles; the corners of each are indices of vertices.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices_m;
  std::vector<std::array<unsigned, 3>> triangles;
};

enum class Shape { kBox, kCylinder, kSphere, kMesh };

/// Something of a shape at a place.
struct Solid {
  Shape shape = Shape::kBox;
  Eigen::Isometry3d world_from_solid = Eigen::Isometry3d::Identity();
  /// Box: edge lengths along its axes; cylinder (axis z): diameter, diameter, height; sphere: three
  /// times the diameter; mesh: not used.
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
  /// Of a mesh, in the solid's axes; its triangles are hit from both sides.
  std::shared_ptr<const TriangleMesh> mesh = nullptr;
  std::size_t material = 0;  ///< index into World::materials
  bool seen = true;          ///< by the lidar
  bool solid = true;         ///< for the robot's chassis
  /// Its surface carries wheels, as a ramp's does; not for meshes.
  bool drivable = false;
};

/// A person who walks to and fro along a polyline, on two legs, and stops for robots.
struct Person {
  std::string name;
  std::vector<Eigen::Vector2d> waypoints_m;  ///< at least one
  double speed_mps = 1.2;
  bool loop = false;     ///< from the last waypoint straight on to the first
  double start_s = 0.0;  ///< simulated time at which the walk begins
  double height_m = 1.7;
  std::size_t material = 0;
};

/// When a door starts to move, and how far open it will be (0 to 1).
struct DoorAppointment {
  double time_s = 0.0;
  double openness = 0.0;
};

/// A leaf that turns about an upright hinge, and stops for robots.
struct Door {
  std::string name;
  Eigen::Vector2d hinge_m = Eigen::Vector2d::Zero();
  double width_m = 0.9;
  double thickness_m = 0.04;
  double height_m = 2.0;
  double closed_yaw_rad = 0.0;  ///< direction from the hinge along the closed leaf
  double open_angle_rad = 1.5;  ///< from closed to open, counter-clockwise; negative: clockwise
  double turn_speed_radps = 1.0;
  double openness = 0.0;  ///< at the start; 0 closed, 1 open
  std::vector<DoorAppointment> schedule;
  std::size_t material = 0;
};

/// Files, maps and poses lie within 100 km of the origin: single precision, which rays are cast in,
/// still resolves 8 mm there.
constexpr double kLargestCoordinate_m = 1e5;
/// Of walls, cylinders and maps that state no height: a room's.
constexpr double kWallHeight_m = 2.5;

/// What the world consists of; z up, the floor is the plane z = 0.
struct World {
  std::vector<Solid> solids;
  /// At least one: the floor and solids that name none are of the first.
  std::vector<Material> materials = {Material()};
  std::vector<Person> people;
  std::vector<Door> doors;
  /// Where the robot starts.
  Pose2 start;
  /// Coulomb friction between wheels and floor.
  double floor_friction = 0.8;
  /// Tilted, it makes the floor an even slope.
  Eigen::Vector3d gravity_mps2 = {0.0, 0.0, -9.81};
};

/// A box that stands on the floor. `thickness_m` is centred on the line between the two ends.
Solid makeWall(const Eigen::Vector2d& begin_m,
               const Eigen::Vector2d& end_m,
               double thickness_m,
               double height_m);

/// A plank that can be driven on: its upper face rises from the floor at `begin_m` to `height_m`
/// at `end_m`.
Solid makeRamp(const Eigen::Vector2d& begin_m,
               const Eigen::Vector2d& end_m,
               double width_m,
               double height_m,
               double thickness_m = 0.05);

/// Corners of the smallest upright box around a solid, in world axes.
Eigen::AlignedBox3d boundsOf(const Solid& solid);

/// Corners of the smallest upright box around all solids; the unit box if there are none.
Eigen::AlignedBox3d boundsOf(const World& world);

/// The materials that world files can name without describing them: plaster (the first), wood,
/// dark, glass, mirror.
std::vector<Material> standardMaterials();

/// Reads a world by what the file is: a world file (YAML), a map_server map (YAML with the key
/// `image`), a URDF, an SDF, or a mesh (STL, DAE, OBJ).
///
/// A world file is described in config/worlds/README.md. A map's occupied cells become walls of 2.5
/// m. Where the file states no start, the robot starts at the origin.
/// \throws std::runtime_error or std::invalid_argument naming file, element and reason
World readWorld(const std::string& path);

/// Writes a world file that readWorld reads: boxes, upright cylinders, materials, people, doors.
/// \throws std::invalid_argument if the world has other solids, std::runtime_error if writing fails
void writeWorldFile(const World& world, const std::string& path);

}  // namespace ramscout_sim
