// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_sim/lidar.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// A robot as people and doors see it, from above.
struct Footprint {
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
};

/// How people and doors behave, and how large people are.
struct ActorParameters {
  double period_s = 0.01;  ///< how often they, other robots and the driver of a tour react
  double memory_s = 0.25;  ///< how long their poses are kept
  double touch_range_m = 1.0;
  double person_radius_m = 0.3;
  double person_caution_m = 0.2;
  double door_caution_m = 0.03;
  double leg_radius_m = 0.08;
  double hip_width_m = 0.24;
  double stride_m = 1.4;  ///< both steps
  double torso_radius_m = 0.18;

  static const ram_parameters::ParameterTable<ActorParameters>& table();
};

/// What moves in a world: people on two legs, doors, and guests, whose poses others decide.
///
/// People and doors stop where they would touch a robot, and continue when it is out of their way:
/// they never push it, and a robot that drives into them meets a wall. Their motion depends on
/// nothing but the world, the commands and the robots' ways.
class Actors {
public:
  explicit Actors(const World& world, const ActorParameters& parameters = {});

  bool empty() const { return people_.empty() && doors_.empty() && guests_.empty(); }

  /// From now on the door opens or closes to this share. \throws std::invalid_argument if there is
  /// no such door or `openness` is not in [0, 1]
  void setDoor(const std::string& name, double openness);

  /// A person who is there from now until `until_s`.
  void addPerson(const Person& person, double until_s);

  /// Shapes of other robots, where they are now.
  void setGuests(std::vector<Solid> guests);

  /// Moves everything on to `now_s`, simulated time; to be called at least once in
  /// ActorParameters::period_s, and does something that often only.
  /// \return whether it did
  bool advance(double now_s, const std::vector<Footprint>& robots);

  /// Legs, bodies, leaves and guests, where they are now.
  std::vector<Solid> solids() const;

  /// Where they were when a sweep that began at `stamp_s` passed each of them; at most
  /// ActorParameters::memory_s ago.
  std::vector<Solid> solidsInSweep(double stamp_s,
                                   const Eigen::Isometry3d& world_from_laser,
                                   const LidarParameters& lidar) const;

private:
  struct Walker {
    Person person;
    double until_s = 0.0;
    double length_m = 0.0;
    double walked_m = 0.0;
  };
  struct Leaf {
    Door door;
    double openness = 0.0;
    double wanted = 0.0;
    std::size_t kept_appointments = 0;
  };
  struct Sample {
    double time_s = 0.0;
    std::vector<Eigen::Isometry3d> poses;
  };

  void step(double now_s, double duration_s, const std::vector<Footprint>& robots);
  void remember(double now_s);
  Eigen::Isometry3d poseAt(std::size_t solid, double time_s) const;

  ActorParameters parameters_;
  std::vector<Walker> people_;
  std::vector<Leaf> doors_;
  std::vector<Solid> guests_;
  double advanced_to_s_ = 0.0;
  std::deque<Sample> history_;
};

}  // namespace ramscout_sim
