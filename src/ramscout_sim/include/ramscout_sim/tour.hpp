// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_sim/pose2.hpp"

namespace ramscout_sim {

/// A way to drive: straight lines between waypoints (world frame).
struct Tour {
  std::vector<Eigen::Vector2d> waypoints_m;
  double speed_mps = 0.8;
  double turn_speed_radps = 1.0;

  double length_m() const;
  /// \throws std::invalid_argument for fewer than two waypoints, two equal neighbours, or speeds
  /// that are not positive
  void validate() const;
};

/// Reads a YAML file with `waypoints` ([[x, y], ...] in m) and, optionally, `speed_mps` and
/// `turn_speed_radps`. \throws std::runtime_error or std::invalid_argument naming file, key and
/// reason
Tour readTour(const std::string& path);

struct TourDriverParameters {
  double lookahead_m = 0.5;
  double yaw_gain_per_s = 3.0;
  double turn_on_the_spot_from_rad = 0.8;
  double turn_on_the_spot_until_rad = 0.1;
  double least_speed_share = 0.2;
  double braking_distance_m = 2.0;
  double stopping_gain_per_s = 1.5;
  double least_speed_mps = 0.05;
  double arrived_m = 0.05;

  static const ram_parameters::ParameterTable<TourDriverParameters>& table();
};

/// Drives a tour knowing the true pose: heads for the point a little further on the way (pure
/// pursuit, Coulter 1992), turns on the spot where the way bends sharply, stops at the end.
class TourDriver {
public:
  /// \throws std::invalid_argument from Tour::validate
  explicit TourDriver(const Tour& tour, const TourDriverParameters& parameters = {});

  Twist2 drive(const Pose2& world_from_base);

  /// Share of the way that is driven, 0 to 1; 1 once the end is reached.
  double progress() const { return finished_ ? 1.0 : driven_m_ / length_m_; }

private:
  void advance(const Eigen::Vector2d& position_m);
  Eigen::Vector2d pointAt(double way_m) const;

  Tour tour_;
  TourDriverParameters parameters_;
  std::vector<double> waypoint_at_m_;  // way from the start to each waypoint
  double length_m_ = 0.0;
  double driven_m_ = 0.0;
  bool turning_ = false;
  bool finished_ = false;
};

}  // namespace ramscout_sim
