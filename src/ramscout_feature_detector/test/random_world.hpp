// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "polygon_world.hpp"

namespace ramscout_feature_detector {

/// A closed space with solid things in it, made from a seed.
struct RandomWorld {
  using Polygon = std::vector<Eigen::Vector2d>;

  Polygon outline_m;
  std::vector<Polygon> solids_m;

  enum class Kind {
    kOffice,    ///< rooms of thin walls with doors along a corridor, rotated boxes
    kPolygons,  ///< irregular outline with irregular convex things
    kHall,      ///< hall with square and octagonal columns, niches and a slanted wall
  };
  RandomWorld(Kind kind, std::uint64_t seed) {
    ram_slam::Random random(seed, static_cast<std::uint64_t>(kind));
    if (kind == Kind::kOffice) makeOffice(random);
    if (kind == Kind::kPolygons) makePolygons(random);
    if (kind == Kind::kHall) makeHall(random);
  }

  PolygonWorld walls() const {
    PolygonWorld world;
    world.add(outline_m, true);
    for (const Polygon& solid : solids_m) world.add(solid, true);
    return world;
  }

  /// A place in the free space, at least 0.4 m from every wall.
  ram_slam::Pose2 freePose(ram_slam::Random& random) const {
    const PolygonWorld world = walls();
    while (true) {
      const Eigen::Vector2d place_m(40.0 * random.uniform() - 20.0, 40.0 * random.uniform() - 20.0);
      bool is_free = contains(outline_m, place_m);
      for (const Polygon& solid : solids_m) is_free = is_free && !contains(solid, place_m);
      for (const PolygonWorld::Wall& wall : world.walls) {
        is_free = is_free && distance_m(wall, place_m) > 0.4;
      }
      if (is_free) return {place_m.x(), place_m.y(), 2.0 * M_PI * (random.uniform() - 0.5)};
    }
  }

  /// Distance from the nearest corner of the world: a polygon's, or where two walls cross.
  double distanceToCorner_m(const Eigen::Vector2d& place_m) const {
    const PolygonWorld world = walls();
    double nearest_m = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < world.walls.size(); ++i) {
      const auto& a = world.walls[i];
      nearest_m = std::min(nearest_m, (a.from_m - place_m).norm());
      if (distance_m(a, place_m) > 0.2) continue;
      for (std::size_t j = 0; j < i; ++j) {
        const auto& b = world.walls[j];
        Eigen::Matrix2d directions;
        directions << a.to_m - a.from_m, b.from_m - b.to_m;
        if (std::abs(directions.determinant()) < 1e-9) continue;
        const Eigen::Vector2d t = directions.inverse() * (b.from_m - a.from_m);
        if (t.minCoeff() < 0.0 || t.maxCoeff() > 1.0) continue;
        nearest_m = std::min(nearest_m, (a.from_m + t.x() * (a.to_m - a.from_m) - place_m).norm());
      }
    }
    return nearest_m;
  }

private:
  static bool contains(const Polygon& polygon, const Eigen::Vector2d& p) {
    bool inside = false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector2d& a = polygon[i];
      const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
      if ((a.y() > p.y()) != (b.y() > p.y()) &&
          p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y())) {
        inside = !inside;
      }
    }
    return inside;
  }

  static double distance_m(const PolygonWorld::Wall& wall, const Eigen::Vector2d& p) {
    const Eigen::Vector2d along = wall.to_m - wall.from_m;
    const double t = std::clamp((p - wall.from_m).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return (wall.from_m + t * along - p).norm();
  }

  static Polygon regular(const Eigen::Vector2d& centre_m,
                         double radius_m,
                         int corners,
                         double yaw_rad) {
    Polygon polygon;
    for (int i = 0; i < corners; ++i) {
      const double angle_rad = yaw_rad + 2.0 * M_PI * i / corners;
      polygon.push_back(centre_m +
                        radius_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
    }
    return polygon;
  }

  static Polygon box(double x_min, double y_min, double x_max, double y_max) {
    return {{x_min, y_min}, {x_max, y_min}, {x_max, y_max}, {x_min, y_max}};
  }

  void makeOffice(ram_slam::Random& random) {
    outline_m = box(-12.0, -7.0, 12.0, 7.0);
    for (const double side : {-1.0, 1.0}) {
      const double wall_y = side * (1.0 + 0.4 * random.uniform());
      for (double x = -12.0; x < 11.0;) {
        const double next = std::min(12.0, x + 3.0 + 3.0 * random.uniform());
        const double door = x + 0.6 + (next - x - 2.2) * random.uniform();
        solids_m.push_back(box(x - 0.1, wall_y - 0.1, door, wall_y + 0.1));
        solids_m.push_back(box(door + 1.0, wall_y - 0.1, next + 0.1, wall_y + 0.1));
        if (next < 12.0) {
          solids_m.push_back(box(next - 0.1, std::min(wall_y, side * 7.1), next + 0.1,
                                 std::max(wall_y, side * 7.1)));
        }
        const Eigen::Vector2d centre(0.5 * (x + next) + random.uniform() - 0.5,
                                     side * (3.5 + 2.0 * random.uniform()));
        solids_m.push_back(
            regular(centre, 0.4 + 0.4 * random.uniform(), 4, M_PI * random.uniform()));
        x = next;
      }
    }
  }

  void makePolygons(ram_slam::Random& random) {
    for (int i = 0; i < 11; ++i) {
      const double angle_rad = 2.0 * M_PI * (i + 0.6 * random.uniform()) / 11.0;
      outline_m.push_back((6.0 + 5.0 * random.uniform()) *
                          Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
    }
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector2d centre(9.0 * (random.uniform() - 0.5), 9.0 * (random.uniform() - 0.5));
      solids_m.push_back(
          regular(centre, 0.4 + 0.8 * random.uniform(), 3 + i % 4, 2.0 * M_PI * random.uniform()));
    }
  }

  void makeHall(ram_slam::Random& random) {
    outline_m = {
        {-13.0, -8.0}, {9.0 + 2.0 * random.uniform(), -8.0}, {13.0, -4.0 + 2.0 * random.uniform()}};
    outline_m.push_back({13.0, 8.0});
    for (double x = 11.0; x > -11.0; x -= 3.0 + random.uniform()) {
      const double depth = 0.5 + random.uniform();
      outline_m.push_back({x, 8.0});
      outline_m.push_back({x, 8.0 + depth});
      outline_m.push_back({x - 1.5, 8.0 + depth});
      outline_m.push_back({x - 1.5, 8.0});
    }
    outline_m.push_back({-13.0, 8.0});
    for (double x = -9.0; x < 10.0; x += 4.5) {
      for (const double y : {-4.0, 0.0, 4.0}) {
        const Eigen::Vector2d centre(x + random.uniform() - 0.5, y + random.uniform() - 0.5);
        solids_m.push_back(
            random.uniform() < 0.5
                ? regular(centre, 0.4 + 0.4 * random.uniform(), 4, M_PI * random.uniform())
                : regular(centre, 0.5 + 0.5 * random.uniform(), 8, M_PI * random.uniform()));
      }
    }
  }
};

}  // namespace ramscout_feature_detector
