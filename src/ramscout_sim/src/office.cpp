// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/office.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "ramscout_sim/random.hpp"

namespace ramscout_sim {
namespace {

/// A row of rooms along x: where it is, and on which side its doors are.
struct RoomRow {
  double left_m = 0.0;
  double right_m = 0.0;
  double bottom_m = 0.0;
  double top_m = 0.0;
  bool doors_at_top = false;
};

class Builder {
public:
  explicit Builder(const OfficeParameters& parameters)
      : parameters_(parameters),
        random_(static_cast<std::uint64_t>(parameters.seed), Stream::kBuilding),
        extras_(static_cast<std::uint64_t>(parameters.seed), Stream::kBuilding, 1) {
    office_.world.materials = standardMaterials();
  }

  Office build() {
    addOuterWalls();
    const double corridor_m = parameters_.corridor_width_m;
    const double depth_m = parameters_.room_depth_m;
    addRoomRow({0.0, parameters_.length_m(), 0.0, depth_m, true});
    addRoomRow({0.0, parameters_.length_m(), parameters_.depth_m() - depth_m, parameters_.depth_m(),
                false});
    for (int row = 0; row < parameters_.blocks_along_y; ++row) {
      for (int column = 0; column < parameters_.blocks_along_x; ++column) {
        const double left_m = corridor_m + column * (parameters_.block_length_m + corridor_m);
        const double bottom_m = depth_m + corridor_m + row * (2.0 * depth_m + corridor_m);
        addBlock(left_m, bottom_m);
      }
    }
    for (int i = 0; i < parameters_.people; ++i) addPerson(i);
    office_.world.start = {corridorX(0), corridorY(0), 0.0};
    office_.tour = makeTour();
    return office_;
  }

private:
  void addWall(double x0, double y0, double x1, double y1) {
    office_.world.solids.push_back(
        makeWall({x0, y0}, {x1, y1}, parameters_.wall_thickness_m, parameters_.wall_height_m));
  }

  /// On the floor.
  void addBox(const Pose2& place, const Eigen::Vector3d& size_m) {
    Solid box;
    box.world_from_solid.translate(Eigen::Vector3d(place.x_m, place.y_m, 0.5 * size_m.z()));
    box.world_from_solid.rotate(Eigen::AngleAxisd(place.yaw_rad, Eigen::Vector3d::UnitZ()));
    box.size_m = size_m;
    office_.world.solids.push_back(box);
  }

  void addOuterWalls() {
    const double x = parameters_.length_m();
    const double y = parameters_.depth_m();
    const double overlap = 0.5 * parameters_.wall_thickness_m;
    addWall(-overlap, 0.0, x + overlap, 0.0);
    addWall(-overlap, y, x + overlap, y);
    addWall(0.0, -overlap, 0.0, y + overlap);
    addWall(x, -overlap, x, y + overlap);
  }

  /// Two rows of rooms back to back, with corridors all around.
  void addBlock(double left_m, double bottom_m) {
    const double right_m = left_m + parameters_.block_length_m;
    const double middle_m = bottom_m + parameters_.room_depth_m;
    const double top_m = middle_m + parameters_.room_depth_m;
    const double overlap = 0.5 * parameters_.wall_thickness_m;
    addWall(left_m, bottom_m - overlap, left_m, top_m + overlap);
    addWall(right_m, bottom_m - overlap, right_m, top_m + overlap);
    addWall(left_m, middle_m, right_m, middle_m);
    addRoomRow({left_m, right_m, bottom_m, middle_m, false});
    addRoomRow({left_m, right_m, middle_m, top_m, true});
  }

  void addRoomRow(const RoomRow& row) {
    double left_m = row.left_m;
    while (left_m < row.right_m - 1e-9) {
      double right_m =
          left_m + random_.uniform(parameters_.shortest_room_m, 2.0 * parameters_.shortest_room_m);
      if (right_m > row.right_m - parameters_.shortest_room_m) right_m = row.right_m;
      if (right_m < row.right_m) addWall(right_m, row.bottom_m, right_m, row.top_m);
      addDoorWall(row, left_m, right_m);
      furnish(row, left_m, right_m);
      left_m = right_m;
    }
  }

  void addDoorWall(const RoomRow& row, double left_m, double right_m) {
    const double y = row.doors_at_top ? row.top_m : row.bottom_m;
    const double hinge_m = random_.uniform(left_m + 0.4, right_m - 0.4 - parameters_.door_width_m);
    const double latch_m = hinge_m + parameters_.door_width_m;
    addWall(left_m, y, hinge_m, y);
    addWall(latch_m, y, right_m, y);
    if (extras_.uniform() < parameters_.glass_front_share) {
      for (std::size_t i = office_.world.solids.size() - 2; i < office_.world.solids.size(); ++i) {
        office_.world.solids[i].material = materialCalled("glass");
        office_.world.solids[i].size_m.y() = parameters_.pane_thickness_m;
      }
    }
    const bool movable = extras_.uniform() < parameters_.movable_door_share;
    if (movable) addDoor(hinge_m, y, row.doors_at_top ? -1.0 : 1.0);
    if (random_.uniform() < 0.5) {  // a door leaf, open into the room
      const double into_room = row.doors_at_top ? -0.9 : 0.9;
      const double yaw_rad = random_.uniform(-0.1, 0.1);
      if (!movable) {
        addBox({hinge_m, y + 0.5 * into_room, yaw_rad}, {0.04, std::abs(into_room), 2.0});
      }
    }
  }

  void addDoor(double hinge_x_m, double hinge_y_m, double inward) {
    Door door;
    door.name = "door_" + std::to_string(office_.world.doors.size() + 1);
    door.hinge_m = {hinge_x_m, hinge_y_m};
    door.width_m = parameters_.door_width_m - 0.01;
    door.open_angle_rad = inward * 1.5;
    door.openness = extras_.uniform() < 0.5 ? 0.0 : 1.0;
    door.material = materialCalled("wood");
    office_.world.doors.push_back(door);
  }

  std::size_t materialCalled(const std::string& name) const {
    const std::vector<Material>& all = office_.world.materials;
    return static_cast<std::size_t>(
        std::find_if(all.begin(), all.end(),
                     [&name](const Material& material) { return material.name == name; }) -
        all.begin());
  }

  /// Walks around a block, or along the only corridor, beside its middle.
  void addPerson(int index) {
    const auto pick = [this](int count) {
      return std::min(count - 1, static_cast<int>(extras_.uniform(0.0, count)));
    };
    const int column = pick(parameters_.blocks_along_x);
    const int row = pick(std::max(1, parameters_.blocks_along_y));
    const double aside_m = extras_.uniform(-0.25, 0.25) * parameters_.corridor_width_m;
    const double left_m = corridorX(column) + aside_m;
    const double right_m = corridorX(column + 1) - aside_m;
    const double bottom_m = corridorY(row) + aside_m;
    const double top_m = corridorY(row + 1) - aside_m;
    Person person;
    person.name = "person_" + std::to_string(index + 1);
    person.speed_mps = extras_.uniform(0.7, 1.5);
    person.height_m = extras_.uniform(1.55, 1.9);
    if (parameters_.blocks_along_y == 0) {
      person.waypoints_m = {{right_m, bottom_m}, {left_m, bottom_m}};
    } else {
      person.loop = true;
      person.waypoints_m = {
          {right_m, top_m}, {left_m, top_m}, {left_m, bottom_m}, {right_m, bottom_m}};
    }
    office_.world.people.push_back(person);
  }

  /// Desk, cabinet, bin and chair, away from the door.
  void furnish(const RoomRow& row, double left_m, double right_m) {
    const double inward = row.doors_at_top ? 1.0 : -1.0;
    const double back_m = row.doors_at_top ? row.bottom_m : row.top_m;
    const double free_m = right_m - left_m - parameters_.wall_thickness_m;
    const double cabinet_m =
        left_m + 0.5 * parameters_.wall_thickness_m + random_.uniform(0.5, free_m - 1.0);
    addBox({cabinet_m, back_m + inward * 0.5, 0.0}, {1.2, 0.45, 1.2});
    const double desk_m = left_m + random_.uniform(1.0, std::max(1.1, free_m - 1.0));
    const double desk_yaw_rad = random_.uniform(-0.3, 0.3);
    addBox({desk_m, back_m + inward * random_.uniform(1.8, 2.6), desk_yaw_rad}, {1.6, 0.8, 0.74});
    Solid bin;
    bin.shape = Shape::kCylinder;
    bin.size_m = {0.4, 0.4, 0.5};
    bin.world_from_solid.translate(
        Eigen::Vector3d(right_m - 0.5, back_m + inward * random_.uniform(1.2, 3.0), 0.25));
    office_.world.solids.push_back(bin);
  }

  double corridorX(int column) const {
    return 0.5 * parameters_.corridor_width_m +
           column * (parameters_.block_length_m + parameters_.corridor_width_m);
  }
  double corridorY(int row) const {
    return parameters_.room_depth_m + 0.5 * parameters_.corridor_width_m +
           row * (2.0 * parameters_.room_depth_m + parameters_.corridor_width_m);
  }

  /// Around each block, counter-clockwise; from one row of blocks to the next along the first
  /// column.
  Tour makeTour() const {
    Tour tour;
    tour.waypoints_m.emplace_back(corridorX(0), corridorY(0));
    const auto go = [&tour](double x, double y) { tour.waypoints_m.emplace_back(x, y); };
    if (parameters_.blocks_along_y == 0) {
      go(corridorX(parameters_.blocks_along_x), corridorY(0));
      go(corridorX(0), corridorY(0));
    }
    for (int row = 0; row < parameters_.blocks_along_y; ++row) {
      for (int column = 0; column < parameters_.blocks_along_x; ++column) {
        go(corridorX(column + 1), corridorY(row));
        go(corridorX(column + 1), corridorY(row + 1));
        go(corridorX(column), corridorY(row + 1));
        go(corridorX(column), corridorY(row));
        if (column + 1 < parameters_.blocks_along_x) go(corridorX(column + 1), corridorY(row));
      }
      go(corridorX(0), corridorY(row));
      if (row + 1 < parameters_.blocks_along_y) go(corridorX(0), corridorY(row + 1));
    }
    tour.waypoints_m.erase(std::unique(tour.waypoints_m.begin(), tour.waypoints_m.end()),
                           tour.waypoints_m.end());
    return tour;
  }

  OfficeParameters parameters_;
  Random random_;
  Random extras_;  // of its own, so that they leave the rest of the building as it is
  Office office_;
};

void writeNumbers(std::ostream& stream, std::initializer_list<double> numbers) {
  const char* separator = "[";
  for (const double number : numbers) {
    stream << separator << (std::abs(number) < 5e-7 ? 0.0 : number);
    separator = ", ";
  }
  stream << ']';
}

void close(std::ofstream& stream, const std::string& path) {
  stream.close();
  if (!stream) throw std::runtime_error(path + ": cannot be written");
}

}  // namespace

const ram_parameters::ParameterTable<OfficeParameters>& OfficeParameters::table() {
  using namespace ram_parameters;
  using P = OfficeParameters;
  static const auto table =
      ParameterTable<P>()
          .add("seed", &P::seed, "", atLeast(0), "Same parameters and seed, same building.")
          .add("blocks_along_x", &P::blocks_along_x, "", within(1, 1000), "Blocks of rooms.")
          .add("blocks_along_y", &P::blocks_along_y, "", within(0, 1000),
               "0: a single corridor between two rows of rooms.")
          .add("block_length_m", &P::block_length_m, "m", {0.0, 200.0, false, true},
               "Along x; subdivided into rooms.")
          .rule(&P::block_length_m, ">= 2 shortest_room_m",
                [](const P& p) { return p.block_length_m >= 2.0 * p.shortest_room_m; })
          .add("room_depth_m", &P::room_depth_m, "m", within(4.0, 20.0),
               "Along y; a block is two rooms deep.")
          .add("corridor_width_m", &P::corridor_width_m, "m", within(1.2, 20.0), "")
          .add("door_width_m", &P::door_width_m, "m", within(0.7, 1.8), "")
          .add("glass_front_share", &P::glass_front_share, "", within(0.0, 1.0),
               "Share of the rooms whose wall to the corridor is of glass.")
          .add("movable_door_share", &P::movable_door_share, "", within(0.0, 1.0),
               "Share of the rooms whose door has a leaf that can be moved.")
          .add("people", &P::people, "", within(0, 1000), "Who walk around the blocks.")
          .expert("Walls")
          .add("wall_thickness_m", &P::wall_thickness_m, "m", aboveUpTo(0.0, 1.0), "")
          .add("wall_height_m", &P::wall_height_m, "m", aboveUpTo(0.0, 100.0), "")
          .add("pane_thickness_m", &P::pane_thickness_m, "m", aboveUpTo(0.0, 1.0),
               "Of glass fronts.")
          .add("shortest_room_m", &P::shortest_room_m, "m", within(3.0, 100.0),
               "Along x; none is longer than three times that.");
  return table;
}

OfficeParameters readOfficeParameters(ram_parameters::ParameterReader& reader) {
  return OfficeParameters::table().readAll(reader);
}

Office generateOffice(const OfficeParameters& parameters) {
  parameters.validate();
  return Builder(parameters).build();
}

void writeTour(const Tour& tour, const std::string& path) {
  std::ofstream stream(path);
  stream.precision(7);
  stream << "# Waypoints in the world frame [m], driven in this order along straight "
            "lines.\nspeed_mps: "
         << tour.speed_mps << "\nturn_speed_radps: " << tour.turn_speed_radps << "\nwaypoints:\n";
  for (const Eigen::Vector2d& point : tour.waypoints_m) {
    stream << "  - ";
    writeNumbers(stream, {point.x(), point.y()});
    stream << '\n';
  }
  close(stream, path);
}

}  // namespace ramscout_sim
