// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/map_image.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ramscout_sim {
namespace {

/// Whether the solid, grown sideways by the margin, contains the point.
bool covers(const Solid& solid, const Eigen::Vector3d& point, double margin_m) {
  const Eigen::Vector3d local = solid.world_from_solid.inverse(Eigen::Isometry) * point;
  const Eigen::Vector3d half = 0.5 * solid.size_m;
  switch (solid.shape) {
    case Shape::kBox:
      return (local.head<2>().cwiseAbs().array() <= half.head<2>().array() + margin_m).all() &&
             std::abs(local.z()) <= half.z();
    case Shape::kCylinder:
      return local.head<2>().norm() <= half.x() + margin_m && std::abs(local.z()) <= half.z();
    case Shape::kSphere:
      return local.norm() <= half.x() + margin_m;
    case Shape::kMesh:
      break;  // has no inside
  }
  return false;
}

/// Marks the cells along the lines in which a mesh cuts the plane z = height.
void drawMesh(const Solid& solid, double height_m, MapImage& map) {
  const double r = map.resolution_m;
  for (const auto& triangle : solid.mesh->triangles) {
    std::vector<Eigen::Vector3d> crossings;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto corner = [&](std::size_t which) -> Eigen::Vector3d {
        return solid.world_from_solid * solid.mesh->vertices_m[triangle[which % 3]].cast<double>();
      };
      const Eigen::Vector3d a = corner(i);
      const Eigen::Vector3d b = corner(i + 1);
      if ((a.z() < height_m) != (b.z() < height_m))
        crossings.emplace_back(a + (height_m - a.z()) / (b.z() - a.z()) * (b - a));
    }
    if (crossings.size() != 2) continue;
    const Eigen::Vector3d along = crossings[1] - crossings[0];
    const int steps = static_cast<int>(std::ceil(along.norm() / (0.25 * r))) + 1;
    for (int i = 0; i <= steps; ++i) {
      const Eigen::Vector3d point = crossings[0] + static_cast<double>(i) / steps * along;
      const int column = static_cast<int>(std::floor((point.x() - map.world_from_map.x_m) / r));
      const int row = static_cast<int>(std::floor((point.y() - map.world_from_map.y_m) / r));
      map.cells[static_cast<std::size_t>(row) * map.width_cells + column] = Cell::kOccupied;
    }
  }
}

void drawSolid(const Solid& solid, double height_m, MapImage& map) {
  const Eigen::AlignedBox3d bounds = boundsOf(solid);
  const double r = map.resolution_m;
  const auto cellOf = [r](double coordinate_m, double origin_m) {
    return static_cast<int>(std::floor((coordinate_m - origin_m) / r));
  };
  const int left = std::max(0, cellOf(bounds.min().x(), map.world_from_map.x_m) - 1);
  const int right =
      std::min(map.width_cells - 1, cellOf(bounds.max().x(), map.world_from_map.x_m) + 1);
  const int bottom = std::max(0, cellOf(bounds.min().y(), map.world_from_map.y_m) - 1);
  const int top =
      std::min(map.height_cells - 1, cellOf(bounds.max().y(), map.world_from_map.y_m) + 1);
  for (int row = bottom; row <= top; ++row) {
    for (int column = left; column <= right; ++column) {
      const Eigen::Vector3d centre(map.world_from_map.x_m + (column + 0.5) * r,
                                   map.world_from_map.y_m + (row + 0.5) * r, height_m);
      if (covers(solid, centre, 0.5 * r)) {
        map.cells[static_cast<std::size_t>(row) * map.width_cells + column] = Cell::kOccupied;
      }
    }
  }
}

/// Turns the unknown cells that are connected with `start` (a cell index) into free ones.
void floodFill(std::size_t start, MapImage& map) {
  std::vector<std::size_t> open = {start};
  const auto visit = [&](std::size_t index) {
    if (map.cells[index] != Cell::kUnknown) return;
    map.cells[index] = Cell::kFree;
    open.push_back(index);
  };
  const std::size_t width = static_cast<std::size_t>(map.width_cells);
  while (!open.empty()) {
    const std::size_t index = open.back();
    open.pop_back();
    if (index % width > 0) visit(index - 1);
    if (index % width + 1 < width) visit(index + 1);
    if (index >= width) visit(index - width);
    if (index + width < map.cells.size()) visit(index + width);
  }
}

}  // namespace

std::vector<Solid> extrude(const MapImage& map, double height_m) {
  std::vector<bool> taken(map.cells.size(), false);
  const auto wanted = [&](int column, int row) {
    const std::size_t index = static_cast<std::size_t>(row) * map.width_cells + column;
    return map.cells[index] == Cell::kOccupied && !taken[index];
  };
  std::vector<Solid> solids;
  for (int row = 0; row < map.height_cells; ++row) {
    for (int column = 0; column < map.width_cells; ++column) {
      if (!wanted(column, row)) continue;
      int right = column;
      while (right < map.width_cells && wanted(right, row)) ++right;
      int top = row;
      const auto fullRow = [&](int candidate) {
        for (int c = column; c < right; ++c) {
          if (!wanted(c, candidate)) return false;
        }
        return true;
      };
      while (top < map.height_cells && fullRow(top)) {
        for (int c = column; c < right; ++c)
          taken[static_cast<std::size_t>(top) * map.width_cells + c] = true;
        ++top;
      }
      const Pose2 map_from_box{0.5 * (column + right) * map.resolution_m,
                               0.5 * (row + top) * map.resolution_m, 0.0};
      Solid box;
      box.world_from_solid = toIsometry(map.world_from_map * map_from_box) *
                             Eigen::Translation3d(0.0, 0.0, 0.5 * height_m);
      box.size_m = {(right - column) * map.resolution_m, (top - row) * map.resolution_m, height_m};
      solids.push_back(box);
    }
  }
  return solids;
}

MapImage drawMap(const World& world, double height_m, double resolution_m, double margin_m) {
  if (!(resolution_m > 0.0)) throw std::invalid_argument("resolution_m must be > 0");
  const Eigen::AlignedBox3d bounds = boundsOf(world);
  MapImage map;
  map.resolution_m = resolution_m;
  map.world_from_map.x_m = std::floor((bounds.min().x() - margin_m) / resolution_m) * resolution_m;
  map.world_from_map.y_m = std::floor((bounds.min().y() - margin_m) / resolution_m) * resolution_m;
  const Eigen::Vector3d extent = bounds.sizes();
  if (extent.head<2>().maxCoeff() + 2.0 * margin_m > kLargestMapSide_cells * resolution_m) {
    throw std::invalid_argument(
        "the map of this world would have more than 16384 cells on a side; take a larger "
        "resolution_m");
  }
  map.width_cells = static_cast<int>(std::ceil((extent.x() + 2.0 * margin_m) / resolution_m)) + 1;
  map.height_cells = static_cast<int>(std::ceil((extent.y() + 2.0 * margin_m) / resolution_m)) + 1;
  map.cells.assign(static_cast<std::size_t>(map.width_cells) * map.height_cells, Cell::kUnknown);
  for (const Solid& solid : world.solids) {
    if (solid.shape != Shape::kMesh) {
      drawSolid(solid, height_m, map);
    } else if (solid.solid) {
      drawMesh(solid, height_m, map);
    }
  }
  const int column = static_cast<int>((world.start.x_m - map.world_from_map.x_m) / resolution_m);
  const int row = static_cast<int>((world.start.y_m - map.world_from_map.y_m) / resolution_m);
  if (column >= 0 && column < map.width_cells && row >= 0 && row < map.height_cells) {
    const std::size_t start = static_cast<std::size_t>(row) * map.width_cells + column;
    if (map.cells[start] == Cell::kUnknown) floodFill(start, map);
  }
  return map;
}

}  // namespace ramscout_sim
