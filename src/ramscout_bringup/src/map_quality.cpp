// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/map_quality.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace ramscout_bringup {
namespace {

using ram_slam::OccupancyGrid;
using ram_slam::Pose2;

constexpr int kFromOccupied = 50;  // cells in percent count as occupied from here on

bool isOccupied(std::int8_t cell) {
  return cell >= kFromOccupied;
}
bool isFree(std::int8_t cell) {
  return cell >= 0 && cell < kFromOccupied;
}
bool isKnown(std::int8_t cell) {
  return cell >= 0;
}

Eigen::Vector2d centre(const OccupancyGrid& grid, int x, int y) {
  return grid.map_from_grid *
         Eigen::Vector2d((x + 0.5) * grid.resolution_m, (y + 0.5) * grid.resolution_m);
}

/// Calls visit(x, y, value) for every cell.
template <typename Visit>
void forEachCell(const OccupancyGrid& grid, Visit visit) {
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) visit(x, y, grid.at(x, y));
  }
}

/// Whether a cell of that kind lies among the 3 x 3 around (x, y).
template <typename IsKind>
bool anyAround(const OccupancyGrid& grid, int x, int y, IsKind is_kind) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (is_kind(grid.at(x + dx, y + dy))) return true;
    }
  }
  return false;
}

/// Distance from anywhere to the nearest marked cell of a grid.
class DistanceField {
public:
  /// \param is_marked  called as is_marked(x, y)
  template <typename IsMarked>
  DistanceField(const OccupancyGrid& grid, IsMarked is_marked)
      : grid_(grid), unmarked_(grid.height, grid.width, CV_8U) {
    forEachCell(grid, [&](int x, int y, std::int8_t) {
      unmarked_.at<unsigned char>(y, x) = is_marked(x, y) ? 0 : 1;
    });
    cv::distanceTransform(unmarked_, distance_cells_, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  }

  /// For a point in the map frame of the grid; outside the grid the distance from its edge is
  /// added.
  double at_m(const Eigen::Vector2d& point_m) const {
    const Eigen::Vector2d cell = grid_.map_from_grid.inverse() * point_m / grid_.resolution_m;
    const Eigen::Vector2d inside(std::clamp(cell.x(), 0.0, grid_.width - 0.5),
                                 std::clamp(cell.y(), 0.0, grid_.height - 0.5));
    const float distance =
        distance_cells_.at<float>(static_cast<int>(inside.y()), static_cast<int>(inside.x()));
    return (static_cast<double>(distance) + (cell - inside).norm()) * grid_.resolution_m;
  }

private:
  const OccupancyGrid& grid_;
  cv::Mat unmarked_;
  cv::Mat distance_cells_;
};

std::int8_t valueAt(const OccupancyGrid& grid, const Eigen::Vector2d& point_m) {
  const Eigen::Vector2d cell = grid.map_from_grid.inverse() * point_m / grid.resolution_m;
  return grid.at(static_cast<int>(std::floor(cell.x())), static_cast<int>(std::floor(cell.y())));
}

double ratio(std::size_t part, std::size_t rest) {
  return part + rest == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(part + rest);
}

/// The free cells of the true map that can be reached from those that the estimate saw free,
/// 4-connected, and of them the part that it knows.
double coverageOf(const OccupancyGrid& estimate,
                  const OccupancyGrid& truth,
                  const Pose2& true_from_estimate) {
  const Pose2 estimate_from_true = true_from_estimate.inverse();
  std::vector<char> reached(truth.cells.size(), 0);
  std::vector<cv::Point> frontier;
  const auto reach = [&](int x, int y) {
    if (!truth.contains(x, y) || !isFree(truth.at(x, y)) || reached[truth.index(x, y)]) return;
    reached[truth.index(x, y)] = 1;
    frontier.emplace_back(x, y);
  };
  std::size_t known = 0;
  std::size_t unknown = 0;
  const auto seen = [&](int x, int y) {
    return isKnown(valueAt(estimate, estimate_from_true * centre(truth, x, y)));
  };
  forEachCell(truth, [&](int x, int y, std::int8_t value) {
    if (isFree(value) && isFree(valueAt(estimate, estimate_from_true * centre(truth, x, y))))
      reach(x, y);
  });
  while (!frontier.empty()) {
    const cv::Point cell = frontier.back();
    frontier.pop_back();
    ++(seen(cell.x, cell.y) ? known : unknown);
    reach(cell.x + 1, cell.y);
    reach(cell.x - 1, cell.y);
    reach(cell.x, cell.y + 1);
    reach(cell.x, cell.y - 1);
  }
  return ratio(known, unknown);
}

/// Unit vector along the wall that an occupied cell belongs to; none if its surroundings are no
/// line.
std::optional<Eigen::Vector2d> wallDirection(const OccupancyGrid& map,
                                             int x,
                                             int y,
                                             const DoubledWallCriteria& criteria) {
  const int reach = criteria.reach_cells;
  const int edge = 2 * reach + 1;
  // Only what is connected to the cell: the other wall of a pair would bend the direction.
  std::vector<char> reached(static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge), 0);
  std::vector<Eigen::Vector2d> cells{Eigen::Vector2d::Zero()};
  reached[reached.size() / 2] = 1;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Eigen::Vector2d cell = cells[i];
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int cx = static_cast<int>(cell.x()) + dx;
        const int cy = static_cast<int>(cell.y()) + dy;
        if (std::abs(cx) > reach || std::abs(cy) > reach || !isOccupied(map.at(x + cx, y + cy)))
          continue;
        char& mark = reached[static_cast<std::size_t>((cy + reach) * edge + cx + reach)];
        if (mark) continue;
        mark = 1;
        cells.emplace_back(cx, cy);
      }
    }
  }
  if (cells.size() < criteria.min_cells) return std::nullopt;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& cell : cells) mean += cell / static_cast<double>(cells.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& cell : cells) spread += (cell - mean) * (cell - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(spread);
  if (axes.eigenvalues()[0] > criteria.max_spread * axes.eigenvalues()[1]) return std::nullopt;
  return Eigen::Vector2d(axes.eigenvectors().col(1));
}

enum class Gap { kNone, kUnknown, kFree };

/// What lies between a wall's cell and a parallel wall on the side of `normal`; kNone if there is
/// no such wall.
Gap gapToParallelWall(const OccupancyGrid& map,
                      int x,
                      int y,
                      const Eigen::Vector2d& normal,
                      const DoubledWallCriteria& criteria) {
  bool left_wall = false;
  bool crossed_free = false;
  for (int distance = 1; distance <= criteria.farthest_cells; ++distance) {
    const int cx = x + static_cast<int>(std::lround(normal.x() * distance));
    const int cy = y + static_cast<int>(std::lround(normal.y() * distance));
    const std::int8_t value = map.at(cx, cy);
    if (!isOccupied(value)) {
      left_wall = true;
      crossed_free = crossed_free || isFree(value);
      continue;
    }
    if (!left_wall) continue;
    if (distance < criteria.nearest_cells) return Gap::kNone;
    const auto direction = wallDirection(map, cx, cy, criteria);
    if (!direction || std::abs(direction->dot(Eigen::Vector2d(-normal.y(), normal.x()))) <
                          criteria.parallel_cosine)
      return Gap::kNone;
    return crossed_free ? Gap::kFree : Gap::kUnknown;
  }
  return Gap::kNone;
}

}  // namespace

MapAgreement compareMaps(const OccupancyGrid& estimate,
                         const OccupancyGrid& truth,
                         const Pose2& true_from_estimate) {
  const auto is_true_wall = [&](int x, int y) {
    return isOccupied(truth.at(x, y)) && anyAround(truth, x, y, isFree);
  };
  bool any_wall = false;
  forEachCell(truth, [&](int x, int y, std::int8_t) { any_wall = any_wall || is_true_wall(x, y); });
  if (!any_wall || estimate.cells.empty())
    throw std::invalid_argument("cannot compare maps without walls");

  // Cell centres within one cell of each other, diagonals included.
  const double tolerance_m = 1.5 * std::max(estimate.resolution_m, truth.resolution_m);
  const DistanceField to_true_wall(truth, is_true_wall);
  const DistanceField to_true_free(truth, [&](int x, int y) { return isFree(truth.at(x, y)); });
  const DistanceField to_wall(estimate,
                              [&](int x, int y) { return isOccupied(estimate.at(x, y)); });
  const DistanceField to_known(estimate, [&](int x, int y) { return isKnown(estimate.at(x, y)); });

  std::vector<double> wall_distance_m;
  std::size_t matched = 0;
  std::size_t spurious = 0;
  std::size_t missed = 0;
  std::size_t free_in_both = 0;
  std::size_t free_in_one = 0;
  forEachCell(estimate, [&](int x, int y, std::int8_t value) {
    const Eigen::Vector2d point_m = true_from_estimate * centre(estimate, x, y);
    if (isOccupied(value)) {
      wall_distance_m.push_back(to_true_wall.at_m(point_m));
      ++(wall_distance_m.back() <= tolerance_m ? matched : spurious);
      free_in_one += to_true_wall.at_m(point_m) > tolerance_m ? 1 : 0;
    } else if (isFree(value)) {
      ++(to_true_free.at_m(point_m) <= tolerance_m ? free_in_both : free_in_one);
    }
  });
  const Pose2 estimate_from_true = true_from_estimate.inverse();
  forEachCell(truth, [&](int x, int y, std::int8_t) {
    if (!is_true_wall(x, y)) return;
    const Eigen::Vector2d point_m = estimate_from_true * centre(truth, x, y);
    if (to_known.at_m(point_m) <= tolerance_m && to_wall.at_m(point_m) > tolerance_m) ++missed;
  });
  return {ratio(matched, spurious + missed), ratio(free_in_both, free_in_one),
          coverageOf(estimate, truth, true_from_estimate),
          statisticsOf(std::move(wall_distance_m))};
}

DoubledWalls findDoubledWalls(const OccupancyGrid& map, const DoubledWallCriteria& criteria) {
  DoubledWalls doubled;
  std::size_t any = 0;
  std::size_t across_free = 0;
  forEachCell(map, [&](int x, int y, std::int8_t value) {
    if (!isOccupied(value)) return;
    ++doubled.occupied_count;
    const auto direction = wallDirection(map, x, y, criteria);
    if (!direction) return;
    const Eigen::Vector2d normal(-direction->y(), direction->x());
    const Gap left = gapToParallelWall(map, x, y, normal, criteria);
    const Gap right = gapToParallelWall(map, x, y, -normal, criteria);
    any += left != Gap::kNone || right != Gap::kNone ? 1 : 0;
    across_free += left == Gap::kFree || right == Gap::kFree ? 1 : 0;
  });
  doubled.fraction = ratio(any, doubled.occupied_count - any);
  doubled.fraction_across_free = ratio(across_free, doubled.occupied_count - across_free);
  return doubled;
}

}  // namespace ramscout_bringup
