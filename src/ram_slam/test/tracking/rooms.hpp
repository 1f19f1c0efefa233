// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "ram_slam/landmarks/local_constellation.hpp"
#include "ram_slam/tracking/map_views.hpp"

#include "../scan_matching/walls.hpp"

namespace ram_slam {

/// A room with a niche below and a bay above: nothing repeats.
inline Walls oddRoom() {
  return outline({{0.0, 0.0},
                  {6.0, 0.0},
                  {6.0, -2.0},
                  {8.0, -2.0},
                  {8.0, 0.0},
                  {14.0, 0.0},
                  {14.0, 3.0},
                  {5.0, 3.0},
                  {5.0, 6.0},
                  {2.0, 6.0},
                  {2.0, 3.0},
                  {0.0, 3.0}});
}

inline std::shared_ptr<const LaserView> viewIn(const Walls& walls, const Pose2& map_from_base) {
  TestLaser laser;
  laser.beam_count = 720;
  laser.field_of_view_rad = 2.0 * M_PI * 719.0 / 720.0;
  return std::make_shared<const LaserView>(scanWalls(walls, map_from_base, 1, laser), Pose2{});
}

/// Views along the middle of the room.
inline MapViews viewsOf(const Walls& walls) {
  MapViews views;
  for (int i = 0; i < 12; ++i) {
    const Pose2 pose{1.5 + i, 1.5, 0.0};
    views.add(i + 1, pose, static_cast<double>(i), viewIn(walls, pose));
  }
  return views;
}

/// What a robot that ends there has seen on the last three metres.
inline std::vector<LocalConstellation::PlacedView> wayTo(const Walls& walls,
                                                         const Pose2& map_from_base) {
  std::vector<LocalConstellation::PlacedView> way;
  for (const double back_m : {3.0, 2.5, 2.0, 1.5, 1.0, 0.5, 0.0}) {
    const Pose2 base_from_then{-back_m, 0.0, 0.0};
    way.push_back({base_from_then, viewIn(walls, map_from_base * base_from_then)});
  }
  return way;
}

inline bool isNear(const Pose2& a, const Pose2& b) {
  const Pose2 away = a.inverse() * b;
  return away.translation().norm() < 0.3 && std::abs(away.yaw_rad) < 0.1;
}

/// Something that sees everything around it: empty space nearer than `empty_m`, surfaces beyond.
class RoundView : public FieldOfView {
public:
  explicit RoundView(double empty_m) : empty_m_(empty_m) {}
  Sight look(const Eigen::Vector2d& point_in_base_m) const override {
    return point_in_base_m.norm() < empty_m_ ? Sight::kEmpty : Sight::kVisible;
  }
  double range_m() const override { return 100.0; }

private:
  double empty_m_;
};

}  // namespace ram_slam
