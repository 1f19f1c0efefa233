// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "ramscout_sim/map_image.hpp"

namespace ramscout_sim {
namespace {

using Point = Eigen::Vector2i;
using Loop = std::vector<Point>;

/// Counter-clockwise, from the x axis on.
const std::array<Point, 4> kSteps = {Point(1, 0), Point(0, 1), Point(-1, 0), Point(0, -1)};

/// The sides between occupied cells and others, walked with the occupied cell on the left.
class SideWalker {
public:
  explicit SideWalker(const MapImage& map)
      : map_(map),
        outgoing_(static_cast<std::size_t>(map.width_cells + 1) * (map.height_cells + 1), 0) {
    for (int row = 0; row < map.height_cells; ++row) {
      for (int column = 0; column < map.width_cells; ++column) {
        if (!occupied(column, row)) continue;
        if (!occupied(column, row - 1)) at({column, row}) |= 1U;
        if (!occupied(column + 1, row)) at({column + 1, row}) |= 2U;
        if (!occupied(column, row + 1)) at({column + 1, row + 1}) |= 4U;
        if (!occupied(column - 1, row)) at({column, row + 1}) |= 8U;
      }
    }
  }

  std::vector<Loop> loops() {
    std::vector<Loop> loops;
    for (int y = 0; y <= map_.height_cells; ++y) {
      for (int x = 0; x <= map_.width_cells; ++x) {
        while (at({x, y}) != 0) loops.push_back(walkFrom({x, y}));
      }
    }
    return loops;
  }

private:
  bool occupied(int column, int row) const {
    return column >= 0 && row >= 0 && column < map_.width_cells && row < map_.height_cells &&
           map_.at(column, row) == Cell::kOccupied;
  }
  std::uint8_t& at(const Point& corner) {
    return outgoing_[static_cast<std::size_t>(corner.y()) * (map_.width_cells + 1) + corner.x()];
  }

  /// The corners of one closed way; cells that only share a corner stay apart.
  Loop walkFrom(const Point& start) {
    Loop corners;
    Point here = start;
    int direction = firstDirection(here);
    const int first = direction;
    do {
      at(here) = static_cast<std::uint8_t>(at(here) & ~(1U << direction));
      if (corners.empty() || direction != last_) corners.push_back(here);
      last_ = direction;
      here += kSteps[static_cast<std::size_t>(direction)];
      if (here == start && at(here) == 0) break;
      for (const int turn : {1, 0, 3}) {  // left, straight on, right
        const int candidate = (direction + turn) % 4;
        if (at(here) & (1U << candidate)) {
          direction = candidate;
          break;
        }
      }
    } while (here != start || (at(here) & (1U << direction)));
    if (last_ == first && corners.size() > 1) corners.erase(corners.begin());
    return corners;
  }

  int firstDirection(const Point& corner) {
    int direction = 0;
    while (!(at(corner) & (1U << direction))) ++direction;
    return direction;
  }

  const MapImage& map_;
  std::vector<std::uint8_t> outgoing_;  // of each corner: bit d for a side in direction d
  int last_ = 0;
};

double distanceToChord(const Point& point, const Point& a, const Point& b) {
  const Eigen::Vector2d chord = (b - a).cast<double>();
  const Eigen::Vector2d offset = (point - a).cast<double>();
  const double length = chord.norm();
  if (length == 0.0) return offset.norm();
  return std::abs(chord.x() * offset.y() - chord.y() * offset.x()) / length;
}

/// Douglas and Peucker (1973) between two corners that stay.
void simplify(const Loop& loop, std::size_t begin, std::size_t end, double tolerance, Loop& kept) {
  std::size_t farthest = begin;
  double largest = tolerance;
  for (std::size_t i = begin + 1; i < end; ++i) {
    const double distance = distanceToChord(loop[i], loop[begin], loop[end]);
    if (distance > largest) {
      largest = distance;
      farthest = i;
    }
  }
  if (farthest == begin) {
    kept.push_back(loop[begin]);
    return;
  }
  simplify(loop, begin, farthest, tolerance, kept);
  simplify(loop, farthest, end, tolerance, kept);
}

Loop simplified(Loop loop, double tolerance_cells) {
  if (loop.size() <= 4) return loop;
  const auto before = [](const Point& a, const Point& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  };
  std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end(), before), loop.end());
  const Point anchor = loop.front();
  const auto opposite =
      std::max_element(loop.begin(), loop.end(), [&anchor](const Point& a, const Point& b) {
        return (a - anchor).squaredNorm() < (b - anchor).squaredNorm();
      });
  const std::size_t middle = static_cast<std::size_t>(opposite - loop.begin());
  loop.push_back(anchor);
  Loop kept;
  simplify(loop, 0, middle, tolerance_cells, kept);
  simplify(loop, middle, loop.size() - 1, tolerance_cells, kept);
  return kept;
}

}  // namespace

std::vector<std::vector<Eigen::Vector2d>> outlinesOf(const MapImage& map, double tolerance_cells) {
  std::vector<std::vector<Eigen::Vector2d>> outlines;
  for (Loop& loop : SideWalker(map).loops()) {
    std::vector<Eigen::Vector2d> outline;
    for (const Point& corner : simplified(std::move(loop), tolerance_cells)) {
      const Pose2 in_world = map.world_from_map * Pose2{corner.x() * map.resolution_m,
                                                        corner.y() * map.resolution_m, 0.0};
      outline.emplace_back(in_world.x_m, in_world.y_m);
    }
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

Solid extrudeOutlines(const MapImage& map, double height_m, double tolerance_cells) {
  auto mesh = std::make_shared<TriangleMesh>();
  for (const std::vector<Eigen::Vector2d>& outline : outlinesOf(map, tolerance_cells)) {
    const unsigned first = static_cast<unsigned>(mesh->vertices_m.size());
    const unsigned count = static_cast<unsigned>(outline.size());
    for (const Eigen::Vector2d& corner : outline) {
      for (const double z : {0.0, height_m})
        mesh->vertices_m.push_back(Eigen::Vector3d(corner.x(), corner.y(), z).cast<float>());
    }
    for (unsigned i = 0; i < count; ++i) {
      const unsigned a = first + 2 * i;
      const unsigned b = first + 2 * ((i + 1) % count);
      mesh->triangles.push_back({a, b, b + 1});
      mesh->triangles.push_back({a, b + 1, a + 1});
    }
  }
  Solid walls;
  walls.shape = Shape::kMesh;
  walls.mesh = std::move(mesh);
  walls.solid = false;
  return walls;
}

}  // namespace ramscout_sim
