// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/actors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace ramscout_sim {
namespace {

double lengthOf(const Person& person) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < person.waypoints_m.size(); ++i)
    length_m += (person.waypoints_m[i] - person.waypoints_m[i - 1]).norm();
  if (person.loop) length_m += (person.waypoints_m.front() - person.waypoints_m.back()).norm();
  return length_m;
}

/// Position and heading after walking so far.
Pose2 placeOf(const Person& person, double length_m, double walked_m) {
  std::vector<Eigen::Vector2d> way = person.waypoints_m;
  if (person.loop) way.push_back(way.front());
  double rest_m =
      length_m > 0.0 ? std::fmod(walked_m, person.loop ? length_m : 2.0 * length_m) : 0.0;
  const bool back = !person.loop && rest_m > length_m;
  if (back) rest_m = 2.0 * length_m - rest_m;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Eigen::Vector2d leg = way[i] - way[i - 1];
    const double leg_m = leg.norm();
    if (leg_m == 0.0 || (rest_m > leg_m && i + 1 < way.size())) {
      rest_m -= leg_m;
      continue;
    }
    const Eigen::Vector2d at = way[i - 1] + std::min(1.0, rest_m / leg_m) * leg;
    const double yaw_rad = std::atan2(leg.y(), leg.x()) + (back ? M_PI : 0.0);
    return {at.x(), at.y(), wrapAngle(yaw_rad)};
  }
  return {way.front().x(), way.front().y(), 0.0};
}

Solid cylinder(const Pose2& pose, double radius_m, double bottom_m, double top_m) {
  Solid solid;
  solid.shape = Shape::kCylinder;
  solid.size_m = {2.0 * radius_m, 2.0 * radius_m, top_m - bottom_m};
  solid.world_from_solid =
      Eigen::Translation3d(0.0, 0.0, 0.5 * (bottom_m + top_m)) * toIsometry(pose);
  return solid;
}

/// Two legs that swing as far as the person has walked, and what they carry.
void appendPerson(const Person& person,
                  const Pose2& pose,
                  double walked_m,
                  const ActorParameters& parameters,
                  std::vector<Solid>& solids) {
  const double stride_m = parameters.stride_m;
  const double hip_m = 0.5 * person.height_m;
  const double swing_m = 0.25 * stride_m * std::sin(2.0 * M_PI * walked_m / stride_m);
  for (const double side : {1.0, -1.0}) {
    const Pose2 person_from_leg{side * swing_m, side * 0.5 * parameters.hip_width_m, 0.0};
    solids.push_back(cylinder(pose * person_from_leg, parameters.leg_radius_m, 0.0, hip_m));
  }
  solids.push_back(cylinder(pose, parameters.torso_radius_m, hip_m, person.height_m));
  for (std::size_t i = solids.size() - 3; i < solids.size(); ++i)
    solids[i].material = person.material;
}

Eigen::Vector2d alongLeaf(const Door& door, double openness) {
  const double yaw_rad = door.closed_yaw_rad + openness * door.open_angle_rad;
  return {std::cos(yaw_rad), std::sin(yaw_rad)};
}

Solid leafOf(const Door& door, double openness) {
  const Eigen::Vector2d along = alongLeaf(door, openness);
  Solid leaf =
      makeWall(door.hinge_m, door.hinge_m + door.width_m * along, door.thickness_m, door.height_m);
  leaf.material = door.material;
  return leaf;
}

double distanceToLeaf(const Door& door, double openness, const Eigen::Vector2d& point) {
  const Eigen::Vector2d along = alongLeaf(door, openness);
  const double share_m = std::clamp((point - door.hinge_m).dot(along), 0.0, door.width_m);
  return (point - door.hinge_m - share_m * along).norm();
}

/// Whether something that is `next_m` away from a robot after its next move, and `now_m` before it,
/// had better stay.
bool isInTheWay(const Footprint& robot, double margin_m, double now_m, double next_m) {
  return next_m < robot.radius_m + margin_m && next_m < now_m;
}

}  // namespace

const ram_parameters::ParameterTable<ActorParameters>& ActorParameters::table() {
  using namespace ram_parameters;
  using P = ActorParameters;
  static const auto table =
      ParameterTable<P>()
          .add("period_s", &P::period_s, "s", positive(),
               "How often people, doors, other robots and the driver of a tour react.")
          .add("memory_s", &P::memory_s, "s", positive(),
               "How long their poses are kept; at least the sweep of a lidar.")
          .add("touch_range_m", &P::touch_range_m, "m", positive(),
               "Those nearer to the chassis than this can be touched by it.")
          .add("person_radius_m", &P::person_radius_m, "m", positive(),
               "Of the circle that a walking person needs.")
          .add("person_caution_m", &P::person_caution_m, "m", atLeast(0.0),
               "Distance that people keep to robots.")
          .add("door_caution_m", &P::door_caution_m, "m", atLeast(0.0),
               "Distance that the leaves of doors keep to robots.")
          .add("leg_radius_m", &P::leg_radius_m, "m", positive(), "Of a person's legs.")
          .add("hip_width_m", &P::hip_width_m, "m", positive(),
               "Between the middles of a person's legs.")
          .add("stride_m", &P::stride_m, "m", positive(), "Way of both steps.")
          .add("torso_radius_m", &P::torso_radius_m, "m", positive(), "Of a person's body.");
  return table;
}

Actors::Actors(const World& world, const ActorParameters& parameters) : parameters_(parameters) {
  for (const Person& person : world.people)
    people_.push_back({person, std::numeric_limits<double>::infinity(), lengthOf(person), 0.0});
  for (const Door& door : world.doors) {
    Leaf leaf{door, door.openness, door.openness, 0};
    std::stable_sort(leaf.door.schedule.begin(), leaf.door.schedule.end(),
                     [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
    doors_.push_back(leaf);
  }
  remember(0.0);
}

void Actors::setDoor(const std::string& name, double openness) {
  if (!(openness >= 0.0 && openness <= 1.0)) {
    throw std::invalid_argument("a door opens from 0 to 1, not to " + std::to_string(openness));
  }
  std::string known;
  for (Leaf& leaf : doors_) {
    if (leaf.door.name == name) {
      leaf.wanted = openness;
      return;
    }
    known += (known.empty() ? "" : ", ") + leaf.door.name;
  }
  throw std::invalid_argument("there is no door '" + name + "'; " +
                              (known.empty() ? "this world has none" : "there are: " + known));
}

void Actors::addPerson(const Person& person, double until_s) {
  Walker walker{person, until_s, lengthOf(person), 0.0};
  walker.person.start_s = advanced_to_s_;
  people_.push_back(walker);
  history_.clear();
  remember(advanced_to_s_);
}

void Actors::setGuests(std::vector<Solid> guests) {
  const bool others = guests.size() != guests_.size();
  guests_ = std::move(guests);
  if (!others) return;
  history_.clear();
  remember(advanced_to_s_);
}

bool Actors::advance(double now_s, const std::vector<Footprint>& robots) {
  constexpr double kRounding_s = 1e-6;  // of sums of steps; far below any step
  if (now_s < advanced_to_s_ + parameters_.period_s - kRounding_s) return false;
  step(now_s, now_s - advanced_to_s_, robots);
  advanced_to_s_ = now_s;
  remember(now_s);
  return true;
}

void Actors::step(double now_s, double duration_s, const std::vector<Footprint>& robots) {
  const std::size_t before = people_.size();
  people_.erase(std::remove_if(people_.begin(), people_.end(),
                               [now_s](const Walker& walker) { return now_s > walker.until_s; }),
                people_.end());
  if (people_.size() != before) history_.clear();
  for (Walker& walker : people_) {
    if (now_s < walker.person.start_s) continue;
    const double next_m = walker.walked_m + duration_s * walker.person.speed_mps;
    const Pose2 here = placeOf(walker.person, walker.length_m, walker.walked_m);
    const Pose2 there = placeOf(walker.person, walker.length_m, next_m);
    const bool waits = std::any_of(robots.begin(), robots.end(), [&](const Footprint& robot) {
      return isInTheWay(robot, parameters_.person_radius_m + parameters_.person_caution_m,
                        (Eigen::Vector2d(here.x_m, here.y_m) - robot.center_m).norm(),
                        (Eigen::Vector2d(there.x_m, there.y_m) - robot.center_m).norm());
    });
    if (!waits) walker.walked_m = next_m;
  }
  for (Leaf& leaf : doors_) {
    const std::vector<DoorAppointment>& schedule = leaf.door.schedule;
    while (leaf.kept_appointments < schedule.size() &&
           schedule[leaf.kept_appointments].time_s <= now_s)
      leaf.wanted = schedule[leaf.kept_appointments++].openness;
    const double most =
        duration_s * leaf.door.turn_speed_radps / std::abs(leaf.door.open_angle_rad);
    const double next = leaf.openness + std::clamp(leaf.wanted - leaf.openness, -most, most);
    const bool waits = std::any_of(robots.begin(), robots.end(), [&](const Footprint& robot) {
      return isInTheWay(robot, 0.5 * leaf.door.thickness_m + parameters_.door_caution_m,
                        distanceToLeaf(leaf.door, leaf.openness, robot.center_m),
                        distanceToLeaf(leaf.door, next, robot.center_m));
    });
    if (!waits) leaf.openness = next;
  }
}

std::vector<Solid> Actors::solids() const {
  std::vector<Solid> solids;
  for (const Walker& walker : people_)
    appendPerson(walker.person, placeOf(walker.person, walker.length_m, walker.walked_m),
                 walker.walked_m, parameters_, solids);
  for (const Leaf& leaf : doors_) solids.push_back(leafOf(leaf.door, leaf.openness));
  solids.insert(solids.end(), guests_.begin(), guests_.end());
  return solids;
}

void Actors::remember(double now_s) {
  Sample sample;
  sample.time_s = now_s;
  for (const Solid& solid : solids()) sample.poses.push_back(solid.world_from_solid);
  history_.push_back(std::move(sample));
  while (history_.size() > 2 && history_[1].time_s < now_s - parameters_.memory_s)
    history_.pop_front();
}

Eigen::Isometry3d Actors::poseAt(std::size_t solid, double time_s) const {
  const auto after = std::find_if(history_.begin(), history_.end(),
                                  [time_s](const Sample& s) { return s.time_s > time_s; });
  if (after == history_.end()) return history_.back().poses[solid];
  if (after == history_.begin()) return after->poses[solid];
  const Sample& before = *(after - 1);
  const double share = (time_s - before.time_s) / (after->time_s - before.time_s);
  const Eigen::Isometry3d& a = before.poses[solid];
  const Eigen::Isometry3d& b = after->poses[solid];
  const Eigen::Quaterniond turned =
      Eigen::Quaterniond(a.linear()).slerp(share, Eigen::Quaterniond(b.linear()));
  return Eigen::Translation3d((1.0 - share) * a.translation() + share * b.translation()) * turned;
}

std::vector<Solid> Actors::solidsInSweep(double stamp_s,
                                         const Eigen::Isometry3d& world_from_laser,
                                         const LidarParameters& lidar) const {
  std::vector<Solid> moving = solids();
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const Eigen::Vector3d in_laser =
        world_from_laser.inverse() * poseAt(i, stamp_s + 0.5 * lidar.sweep_s()).translation();
    double bearing_rad = std::atan2(in_laser.y(), in_laser.x());
    if (bearing_rad < lidar.angle_min_rad) bearing_rad += 2.0 * M_PI;
    const double beam = std::clamp((bearing_rad - lidar.angle_min_rad) / lidar.angleIncrement_rad(),
                                   0.0, lidar.beams - 1.0);
    moving[i].world_from_solid = poseAt(i, stamp_s + beam * lidar.time_increment_s);
  }
  return moving;
}

}  // namespace ramscout_sim
