// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/tour.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "ram_parameters/parameter_reader.hpp"

namespace ramscout_sim {
double Tour::length_m() const {
  double length = 0.0;
  for (std::size_t i = 1; i < waypoints_m.size(); ++i)
    length += (waypoints_m[i] - waypoints_m[i - 1]).norm();
  return length;
}

void Tour::validate() const {
  if (waypoints_m.size() < 2) throw std::invalid_argument("a tour needs at least two waypoints");
  for (std::size_t i = 0; i < waypoints_m.size(); ++i) {
    if (!waypoints_m[i].allFinite())
      throw std::invalid_argument("waypoint " + std::to_string(i) + " is not finite");
    if (i > 0 && (waypoints_m[i] - waypoints_m[i - 1]).norm() < 1e-3) {
      throw std::invalid_argument("waypoints " + std::to_string(i - 1) + " and " +
                                  std::to_string(i) + " are the same");
    }
  }
  if (!(speed_mps > 0.0))
    throw std::invalid_argument("speed_mps must be > 0, got " + std::to_string(speed_mps));
  if (!(turn_speed_radps > 0.0)) {
    throw std::invalid_argument("turn_speed_radps must be > 0, got " +
                                std::to_string(turn_speed_radps));
  }
}

Tour readTour(const std::string& path) {
  const YAML::Node file = ram_parameters::readYamlFile(path);
  ram_parameters::ParameterReader reader(file, path);
  Tour tour;
  reader.has("waypoints");
  reader.read("speed_mps", tour.speed_mps);
  reader.read("turn_speed_radps", tour.turn_speed_radps);
  reader.rejectUnknown();
  try {
    const YAML::Node waypoints = file["waypoints"];
    if (!waypoints.IsSequence()) throw std::invalid_argument("waypoints must be a list of [x, y]");
    for (const YAML::Node& point : waypoints) {
      const std::vector<double> xy = point.as<std::vector<double>>();
      if (xy.size() != 2) throw std::invalid_argument("each waypoint must be [x, y]");
      tour.waypoints_m.emplace_back(xy[0], xy[1]);
    }
    tour.validate();
  } catch (const std::exception& error) {
    throw std::invalid_argument(path + ": " + error.what());
  }
  return tour;
}

const ram_parameters::ParameterTable<TourDriverParameters>& TourDriverParameters::table() {
  using namespace ram_parameters;
  using P = TourDriverParameters;
  static const auto table =
      ParameterTable<P>()
          .add("lookahead_m", &P::lookahead_m, "m", positive(),
               "Way ahead of the robot to the point that it heads for (pure pursuit).")
          .add("yaw_gain_per_s", &P::yaw_gain_per_s, "1/s", positive(),
               "Turn speed per radian off that point.")
          .add("turn_on_the_spot_from_rad", &P::turn_on_the_spot_from_rad, "rad", positive(),
               "If it is off by more, it turns on the spot,")
          .add("turn_on_the_spot_until_rad", &P::turn_on_the_spot_until_rad, "rad", positive(),
               "until it is off by less than this.")
          .rule(&P::turn_on_the_spot_until_rad, "<= turn_on_the_spot_from_rad",
                [](const P& p) {
                  return p.turn_on_the_spot_until_rad <= p.turn_on_the_spot_from_rad;
                })
          .add("least_speed_share", &P::least_speed_share, "", aboveUpTo(0.0, 1.0),
               "Share of the tour's speed that is kept in bends.")
          .add("braking_distance_m", &P::braking_distance_m, "m", positive(),
               "Way before the end on which it brakes.")
          .add("stopping_gain_per_s", &P::stopping_gain_per_s, "1/s", positive(),
               "Speed per metre left while it brakes.")
          .add("least_speed_mps", &P::least_speed_mps, "m/s", positive(),
               "Slowest speed while it brakes.")
          .add("arrived_m", &P::arrived_m, "m", positive(),
               "Distance from the last waypoint at which the tour is finished.");
  return table;
}

TourDriver::TourDriver(const Tour& tour, const TourDriverParameters& parameters)
    : tour_((tour.validate(), tour)), parameters_(parameters), length_m_(tour.length_m()) {
  double way_m = 0.0;
  for (std::size_t i = 0; i < tour_.waypoints_m.size(); ++i) {
    if (i > 0) way_m += (tour_.waypoints_m[i] - tour_.waypoints_m[i - 1]).norm();
    waypoint_at_m_.push_back(way_m);
  }
}

Eigen::Vector2d TourDriver::pointAt(double way_m) const {
  const auto after = std::upper_bound(waypoint_at_m_.begin(), waypoint_at_m_.end(), way_m);
  if (after == waypoint_at_m_.end()) return tour_.waypoints_m.back();
  const std::size_t i = static_cast<std::size_t>(after - waypoint_at_m_.begin());
  const double share =
      (way_m - waypoint_at_m_[i - 1]) / (waypoint_at_m_[i] - waypoint_at_m_[i - 1]);
  return (1.0 - share) * tour_.waypoints_m[i - 1] + share * tour_.waypoints_m[i];
}

/// Moves the driven way forward to the nearest point of the way within the lookahead.
void TourDriver::advance(const Eigen::Vector2d& position_m) {
  const double end_m = std::min(driven_m_ + parameters_.lookahead_m, length_m_);
  const double begin_m = driven_m_;
  double best_distance_m = std::numeric_limits<double>::infinity();
  const auto after = std::upper_bound(waypoint_at_m_.begin(), waypoint_at_m_.end(), begin_m);
  for (auto next = std::min(after, waypoint_at_m_.end() - 1); next != waypoint_at_m_.end();
       ++next) {
    const std::size_t i = static_cast<std::size_t>(next - waypoint_at_m_.begin());
    const Eigen::Vector2d& corner = tour_.waypoints_m[i - 1];
    if (waypoint_at_m_[i - 1] > end_m) break;
    const Eigen::Vector2d direction = (tour_.waypoints_m[i] - corner).normalized();
    const double low_m = std::max(begin_m, waypoint_at_m_[i - 1]);
    const double high_m = std::max(low_m, std::min(end_m, waypoint_at_m_[i]));
    const double way_m =
        std::clamp(waypoint_at_m_[i - 1] + direction.dot(position_m - corner), low_m, high_m);
    const double distance_m =
        (corner + (way_m - waypoint_at_m_[i - 1]) * direction - position_m).norm();
    if (distance_m < best_distance_m) {
      best_distance_m = distance_m;
      driven_m_ = way_m;
    }
  }
}

Twist2 TourDriver::drive(const Pose2& world_from_base) {
  const Eigen::Vector2d position(world_from_base.x_m, world_from_base.y_m);
  advance(position);
  const double left_m = (tour_.waypoints_m.back() - position).norm();
  if (left_m < parameters_.arrived_m && driven_m_ > length_m_ - parameters_.lookahead_m)
    finished_ = true;
  if (finished_) return {};
  const Eigen::Vector2d to_target = pointAt(driven_m_ + parameters_.lookahead_m) - position;
  const double bearing_rad =
      wrapAngle(std::atan2(to_target.y(), to_target.x()) - world_from_base.yaw_rad);
  turning_ = std::abs(bearing_rad) > (turning_ ? parameters_.turn_on_the_spot_until_rad
                                               : parameters_.turn_on_the_spot_from_rad);
  const double turn_radps = std::clamp(parameters_.yaw_gain_per_s * bearing_rad,
                                       -tour_.turn_speed_radps, tour_.turn_speed_radps);
  if (turning_) return {0.0, 0.0, turn_radps};
  double forward_mps =
      tour_.speed_mps * std::max(parameters_.least_speed_share, 1.0 - std::abs(bearing_rad));
  if (driven_m_ > length_m_ - parameters_.braking_distance_m)
    forward_mps = std::min(forward_mps, std::max(parameters_.least_speed_mps,
                                                 parameters_.stopping_gain_per_s * left_m));
  return {forward_mps, 0.0, turn_radps};
}

}  // namespace ramscout_sim
