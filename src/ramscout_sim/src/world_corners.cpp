// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/world_corners.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <stdexcept>

// Exact sums decide where polygons cross; rounding to integers first would move their corners.
#define BOOST_GEOMETRY_NO_ROBUSTNESS
#include <boost/geometry.hpp>
#include <boost/geometry/geometries/multi_polygon.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>

#include "ramscout_sim/map_image.hpp"

namespace ramscout_sim {
namespace {

namespace bg = boost::geometry;
using Point = bg::model::d2::point_xy<double>;
using Polygon = bg::model::polygon<Point, false>;  // counter-clockwise
using Polygons = bg::model::multi_polygon<Polygon>;

/// Coordinates that are meant to be the same are the same then, and edges on each other are found.
double onGrid(double coordinate_m) {
  constexpr double kSteps_per_m = 1 << 16;  // 15 micrometres, exact in binary
  return std::round(coordinate_m * kSteps_per_m) / kSteps_per_m;
}

Polygon hullOf(const std::vector<Eigen::Vector3d>& points) {
  bg::model::multi_point<Point> all;
  for (const Eigen::Vector3d& point : points)
    all.push_back(Point(onGrid(point.x()), onGrid(point.y())));
  Polygon hull;
  bg::convex_hull(all, hull);
  bg::correct(hull);
  return hull;
}

/// Where the plane z = height cuts the edges of a box.
std::vector<Eigen::Vector3d> sliceBox(const Solid& box, const CornerParameters& parameters) {
  const double height_m = parameters.height_m;
  std::vector<Eigen::Vector3d> points;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 4; ++side) {
      Eigen::Vector3d a = 0.5 * box.size_m + Eigen::Vector3d::Constant(parameters.growth_m);
      a[(axis + 1) % 3] *= side & 1 ? 1.0 : -1.0;
      a[(axis + 2) % 3] *= side & 2 ? 1.0 : -1.0;
      Eigen::Vector3d b = a;
      a[axis] *= -1.0;
      a = box.world_from_solid * a;
      b = box.world_from_solid * b;
      if ((a.z() < height_m) == (b.z() < height_m)) continue;
      points.emplace_back(a + (height_m - a.z()) / (b.z() - a.z()) * (b - a));
    }
  }
  return points;
}

std::vector<Eigen::Vector3d> circle(const Eigen::Vector3d& center, double radius_m, int sides) {
  std::vector<Eigen::Vector3d> points;
  for (int side = 0; side < sides; ++side) {
    const double angle_rad = 2.0 * M_PI * side / sides;
    points.emplace_back(center +
                        radius_m * Eigen::Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0.0));
  }
  return points;
}

std::vector<Eigen::Vector3d> slice(const Solid& solid, const CornerParameters& parameters) {
  const Eigen::Vector3d center = solid.world_from_solid.translation();
  const double above_m = parameters.height_m - center.z();
  const double radius_m = 0.5 * solid.size_m.x();
  switch (solid.shape) {
    case Shape::kBox:
      return sliceBox(solid, parameters);
    case Shape::kCylinder:
      if (std::abs(above_m) > 0.5 * solid.size_m.z()) return {};
      return circle(center, radius_m, parameters.circle_sides);
    case Shape::kSphere:
      if (std::abs(above_m) >= radius_m) return {};
      return circle(center, std::sqrt(radius_m * radius_m - above_m * above_m),
                    parameters.circle_sides);
    case Shape::kMesh:
      break;
  }
  return {};
}

/// The union of polygons [begin, end), halves first so that few large ones are joined.
Polygons joined(const std::vector<Polygon>& polygons, std::size_t begin, std::size_t end) {
  Polygons result;
  if (end - begin == 1) {
    result.push_back(polygons[begin]);
  } else if (end > begin) {
    const std::size_t middle = begin + (end - begin) / 2;
    bg::union_(joined(polygons, begin, middle), joined(polygons, middle, end), result);
  }
  return result;
}

using Ring = std::vector<Eigen::Vector2d>;

double turnAt(const Eigen::Vector2d& before,
              const Eigen::Vector2d& at,
              const Eigen::Vector2d& after) {
  const Eigen::Vector2d in = at - before;
  const Eigen::Vector2d out = after - at;
  return std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
}

/// Without points in the middle of straight lines and without tiny edges.
Ring cleaned(const Polygon::ring_type& points, const CornerParameters& parameters) {
  Ring ring;
  for (const Point& point : points) {
    const Eigen::Vector2d p(point.x(), point.y());
    if (ring.empty() || (p - ring.back()).norm() > parameters.shortest_edge_m) ring.push_back(p);
  }
  while (ring.size() > 1 && (ring.front() - ring.back()).norm() <= parameters.shortest_edge_m)
    ring.pop_back();
  for (std::size_t i = 0; ring.size() > 2 && i < ring.size();) {
    const Eigen::Vector2d& before = ring[(i + ring.size() - 1) % ring.size()];
    const Eigen::Vector2d& after = ring[(i + 1) % ring.size()];
    if (std::abs(turnAt(before, ring[i], after)) < parameters.straight_rad) {
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
  return ring;
}

bool isReachable(const WorldCorner& corner, const MapImage& map) {
  const double ahead_m = 3.0 * map.resolution_m;
  const double x = corner.position_m.x() + ahead_m * std::cos(corner.orientation_rad);
  const double y = corner.position_m.y() + ahead_m * std::sin(corner.orientation_rad);
  const int column = static_cast<int>(std::floor((x - map.world_from_map.x_m) / map.resolution_m));
  const int row = static_cast<int>(std::floor((y - map.world_from_map.y_m) / map.resolution_m));
  return column >= 0 && row >= 0 && column < map.width_cells && row < map.height_cells &&
         map.at(column, row) == Cell::kFree;
}

/// The ring is walked with the solid on the left.
void appendCorners(const Ring& ring,
                   const CornerParameters& parameters,
                   const MapImage& map,
                   std::vector<WorldCorner>& corners) {
  if (ring.size() < 3) return;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& before = ring[(i + ring.size() - 1) % ring.size()];
    const Eigen::Vector2d& after = ring[(i + 1) % ring.size()];
    const double turn_rad = turnAt(before, ring[i], after);
    const Eigen::Vector2d out = after - ring[i];
    WorldCorner corner;
    corner.position_m = ring[i];
    corner.opening_rad = M_PI + turn_rad;
    // The free space lies clockwise of the wall that goes on from here.
    corner.orientation_rad = wrapAngle(std::atan2(out.y(), out.x()) - 0.5 * corner.opening_rad);
    corner.left_wall_m = (ring[i] - before).norm();
    corner.right_wall_m = out.norm();
    if (std::abs(turn_rad) < parameters.least_turn_rad) continue;
    if (std::min(corner.left_wall_m, corner.right_wall_m) < parameters.least_wall_m) continue;
    if (isReachable(corner, map)) corners.push_back(corner);
  }
}

}  // namespace

const ram_parameters::ParameterTable<CornerParameters>& CornerParameters::table() {
  using namespace ram_parameters;
  using P = CornerParameters;
  static const auto table =
      ParameterTable<P>()
          .add("height_m", &P::height_m, "m", anyNumber(), "Of the lidar above the floor.")
          .add("least_wall_m", &P::least_wall_m, "m", atLeast(0.0),
               "Walls shorter than this make no corner.")
          .add("least_turn_rad", &P::least_turn_rad, "rad", within(0.0, M_PI),
               "Angle between two walls below which they make no corner.")
          .add("resolution_m", &P::resolution_m, "m", positive(),
               "Of the map that shows what can be reached.")
          .expert("Geometry")
          .add("shortest_edge_m", &P::shortest_edge_m, "m", positive(),
               "Shorter edges are left over from joining polygons and dropped.")
          .add("straight_rad", &P::straight_rad, "rad", atLeast(0.0),
               "Turns below this are part of a straight wall.")
          .add("growth_m", &P::growth_m, "m", atLeast(0.0),
               "Boxes grow by this to all sides, which closes the slits that rounding leaves "
               "between walls.")
          .add("circle_sides", &P::circle_sides, "", within(3, 10000),
               "Sides of the polygon that stands for a cylinder or sphere.");
  return table;
}

std::vector<WorldCorner> cornersOf(const World& world, const CornerParameters& parameters) {
  CornerParameters::table().check(parameters);
  std::vector<Polygon> polygons;
  for (const Solid& solid : world.solids) {
    if (!solid.seen) continue;
    const std::vector<Eigen::Vector3d> points = slice(solid, parameters);
    if (points.size() >= 3) polygons.push_back(hullOf(points));
  }
  const MapImage map = drawMap(world, parameters.height_m, parameters.resolution_m);
  std::vector<WorldCorner> corners;
  for (const Polygon& polygon : joined(polygons, 0, polygons.size())) {
    appendCorners(cleaned(polygon.outer(), parameters), parameters, map, corners);
    for (const auto& hole : polygon.inners())
      appendCorners(cleaned(hole, parameters), parameters, map, corners);
  }
  std::sort(corners.begin(), corners.end(), [](const WorldCorner& a, const WorldCorner& b) {
    return std::lexicographical_compare(a.position_m.begin(), a.position_m.end(),
                                        b.position_m.begin(), b.position_m.end());
  });
  return corners;
}

void writeCorners(const std::vector<WorldCorner>& corners, const std::string& path) {
  std::ofstream stream(path);
  stream << std::fixed << std::setprecision(6);  // no exponents: not every reader takes 1e-9
  stream << "# Corners of the free space [m, rad] in the world: orientation points into the free "
            "space,\n# opening is its angle, the walls' lengths are those to the left and right of "
            "an observer who faces\n# the corner.\ncorners:\n";
  for (const WorldCorner& corner : corners) {
    stream << "  - {x: " << corner.position_m.x() << ", y: " << corner.position_m.y()
           << ", orientation_rad: " << corner.orientation_rad
           << ", opening_rad: " << corner.opening_rad << ", left_wall_m: " << corner.left_wall_m
           << ", right_wall_m: " << corner.right_wall_m << "}\n";
  }
  stream.close();
  if (!stream) throw std::runtime_error(path + ": cannot be written");
}

}  // namespace ramscout_sim
