// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/world_map/world_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

namespace ram_slam {
namespace {

/// Of frames and types; the same stands in the error's text.
constexpr std::size_t kMaxNameLength = 1000;
/// A box that ends on the edge of a cell does not take the next one, in spite of rounding; in
/// cells.
constexpr double kEdgeTolerance = 1e-6;

void require(bool fulfilled, const char* what) {
  if (!fulfilled) throw std::invalid_argument(what);
}

void requireRoom(std::size_t wanted, std::size_t most, const char* of_what) {
  if (wanted <= most) return;
  throw std::length_error(std::to_string(wanted) + " " + of_what + ", at most " +
                          std::to_string(most) + " are kept");
}

/// Checked, with a quaternion of unit norm.
void checkPose(SpatialPose& pose) {
  require(pose.position_m.allFinite() && pose.covariance.allFinite(),
          "pose or its covariance is not finite");
  require(std::abs(pose.orientation.norm() - 1.0) <= SpatialPose::kQuaternionTolerance,
          "quaternion is not a rotation");
  pose.orientation.normalize();
}

void checkGrid(const OccupancyGrid& grid) {
  require(std::isfinite(grid.resolution_m) && grid.resolution_m > 0.0,
          "grid without a positive resolution");
  require(grid.map_from_grid.isFinite(), "grid without a finite origin");
  require(grid.width >= 0 && grid.height >= 0 &&
              grid.cells.size() ==
                  static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height),
          "grid without width x height cells");
  require(
      std::all_of(grid.cells.begin(), grid.cells.end(),
                  [](std::int8_t cell) { return cell >= kUnknownCell && cell <= kOccupiedCell; }),
      "grid with a cell that is not in -1..100");
}

void checkFrame(const std::string& frame) {
  require(!frame.empty() && frame.size() <= kMaxNameLength,
          "frame without a name, or with one of more than 1000");
}

template <typename Part, typename Size>
std::size_t totalBesides(const std::map<std::string, std::shared_ptr<const Part>>& parts,
                         const std::string& frame,
                         const Size& size) {
  std::size_t total = 0;
  for (const auto& [name, part] : parts) total += name == frame ? 0 : size(*part);
  return total;
}

bool contains(const MapBox& box, double x_m, double y_m) {
  return box.min_x_m <= x_m && x_m <= box.max_x_m && box.min_y_m <= y_m && y_m <= box.max_y_m;
}

/// Cells from the one that holds `low` to the one that holds `high`.
struct CellRange {
  CellRange(double low, double high)
      : first(std::floor(low + kEdgeTolerance)),
        count(std::max(1.0, std::ceil(high - kEdgeTolerance) - first)) {}
  double first;
  double count;
};

/// The columns and rows of a grid around another one, [first, last); none if they do not touch.
struct CellWindow {
  CellWindow(const OccupancyGrid& grid, const Pose2& grid_from_local, const OccupancyGrid& local) {
    const double width_m = local.width * local.resolution_m;
    const double height_m = local.height * local.resolution_m;
    Eigen::Array2d low = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Array2d high = -low;
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(width_m, 0.0), Eigen::Vector2d(0.0, height_m),
          Eigen::Vector2d(width_m, height_m)}) {
      const Eigen::Array2d at = (grid_from_local * corner).array() / grid.resolution_m;
      low = low.min(at);
      high = high.max(at);
    }
    // One cell more on each side, for the rounding.
    const auto clamped = [](double cell, int most) {
      return static_cast<int>(std::clamp(cell, 0.0, static_cast<double>(most)));
    };
    first_column = clamped(low.x() - 1.0, grid.width);
    first_row = clamped(low.y() - 1.0, grid.height);
    last_column = clamped(high.x() + 1.0, grid.width);
    last_row = clamped(high.y() + 1.0, grid.height);
  }
  int first_column, last_column, first_row, last_row;
};

/// Gives cells of a grid that are not known yet what another grid knows of them.
void fillFrom(const LocalOccupancy& local, OccupancyGrid& grid) {
  const Pose2 map_from_local = local.map_from_frame.planar() * local.grid.map_from_grid;
  const Pose2 local_from_map = map_from_local.inverse();
  const CellWindow window(grid, grid.map_from_grid.inverse() * map_from_local, local.grid);
  const double cell_m = grid.resolution_m;
  for (int row = window.first_row; row < window.last_row; ++row) {
    for (int column = window.first_column; column < window.last_column; ++column) {
      std::int8_t& cell = grid.cells[grid.index(column, row)];
      if (cell != kUnknownCell) continue;
      const Eigen::Vector2d centre(grid.map_from_grid.x_m + (column + 0.5) * cell_m,
                                   grid.map_from_grid.y_m + (row + 0.5) * cell_m);
      const Eigen::Vector2d at = local_from_map * centre / local.grid.resolution_m;
      if (at.x() < 0.0 || at.y() < 0.0 || at.x() >= local.grid.width || at.y() >= local.grid.height)
        continue;
      cell = local.grid.at(static_cast<int>(at.x()), static_cast<int>(at.y()));
    }
  }
}

}  // namespace

Eigen::Isometry3d SpatialPose::transform() const {
  return Eigen::Translation3d(position_m) * orientation;
}

Pose2 SpatialPose::planar() const {
  const Eigen::Matrix3d rotation = orientation.toRotationMatrix();
  return {position_m.x(), position_m.y(), std::atan2(rotation(1, 0), rotation(0, 0))};
}

void WorldMap::put(LocalOccupancy occupancy) {
  checkFrame(occupancy.frame);
  checkPose(occupancy.map_from_frame);
  checkGrid(occupancy.grid);
  const auto cells = [](const LocalOccupancy& part) { return part.grid.cells.size(); };
  requireRoom(totalBesides(occupancies_, occupancy.frame, cells) + occupancy.grid.cells.size(),
              kMaxCells, "cells");
  const std::string frame = occupancy.frame;
  occupancies_[frame] = std::make_shared<const LocalOccupancy>(std::move(occupancy));
}

void WorldMap::put(ColoredCloud cloud) {
  checkFrame(cloud.frame);
  checkPose(cloud.map_from_frame);
  require(std::all_of(cloud.points.begin(), cloud.points.end(),
                      [](const ColoredPoint& point) {
                        return std::isfinite(point.x_m) && std::isfinite(point.y_m) &&
                               std::isfinite(point.z_m);
                      }),
          "cloud with a point that is not finite");
  const auto points = [](const ColoredCloud& part) { return part.points.size(); };
  requireRoom(totalBesides(clouds_, cloud.frame, points) + cloud.points.size(), kMaxPoints,
              "points");
  const std::string frame = cloud.frame;
  clouds_[frame] = std::make_shared<const ColoredCloud>(std::move(cloud));
}

void WorldMap::put(LandmarkLayer landmarks) {
  requireRoom(landmarks.landmarks.size(), kMaxLandmarks, "landmarks");
  std::set<std::uint32_t> ids;
  for (WorldLandmark& landmark : landmarks.landmarks) {
    checkPose(landmark.pose);
    require(std::isfinite(landmark.existence_log_odds), "landmark whose existence is not finite");
    require(landmark.type.size() <= kMaxNameLength &&
                landmark.classifier.size() <= WorldLandmark::kMaxClassifierLength,
            "landmark with a type or classifier that is too long");
    require(ids.empty() || landmark.id > *ids.rbegin(),
            "landmarks that are not in the order of their ids");
    ids.insert(ids.end(), landmark.id);
  }
  const LandmarkCrossCovariance* before = nullptr;
  for (const LandmarkCrossCovariance& block : landmarks.cross_covariances) {
    require(block.covariance_m2.allFinite(), "covariance block that is not finite");
    require(block.first_id < block.second_id &&
                ids.count(block.first_id) + ids.count(block.second_id) == 2,
            "covariance block that is not of two landmarks of the map");
    require(before == nullptr || std::pair(before->first_id, before->second_id) <
                                     std::pair(block.first_id, block.second_id),
            "covariance blocks that are not in the order of their ids");
    before = &block;
  }
  landmarks_ = std::make_shared<const LandmarkLayer>(std::move(landmarks));
}

void WorldMap::put(Trajectory trajectory) {
  validate(trajectory);
  trajectory_ = std::make_shared<const Trajectory>(std::move(trajectory));
}

void WorldMap::put(std::vector<PlacedScan> scans) {
  std::size_t readings = 0;
  for (const PlacedScan& placed : scans) {
    placed.scan.validate();
    require(placed.base_from_laser.isFinite() && placed.map_from_laser.isFinite() &&
                placed.last_beam.isFinite(),
            "scan with a pose that is not finite");
    readings += placed.scan.ranges_m.size();
  }
  requireRoom(readings, kMaxReadings, "readings of scans");
  scans_ = std::make_shared<const std::vector<PlacedScan>>(std::move(scans));
}

const LandmarkLayer& WorldMap::landmarks() const {
  static const LandmarkLayer none;
  return landmarks_ ? *landmarks_ : none;
}

const std::vector<PlacedScan>& WorldMap::scans() const {
  static const std::vector<PlacedScan> none;
  return scans_ ? *scans_ : none;
}

const Trajectory& WorldMap::trajectory() const {
  static const Trajectory none;
  return trajectory_ ? *trajectory_ : none;
}

MapRegion WorldMap::region(const MapBox& box) const {
  require(std::isfinite(box.min_x_m) && std::isfinite(box.min_y_m) && std::isfinite(box.max_x_m) &&
              std::isfinite(box.max_y_m) && box.min_x_m < box.max_x_m && box.min_y_m < box.max_y_m,
          "box is not finite or has min >= max");
  MapRegion region;
  std::vector<const LocalOccupancy*> newest_first;
  for (const auto& entry : occupancies_) newest_first.push_back(entry.second.get());
  std::stable_sort(newest_first.begin(), newest_first.end(),
                   [](const auto* a, const auto* b) { return a->stamp_ns > b->stamp_ns; });
  if (!newest_first.empty()) {
    region.grid = gridIn(box, newest_first);
    region.grid_stamp_ns = newest_first.front()->stamp_ns;
  }
  region.landmarks = landmarksIn(box);
  for (const auto& entry : clouds_) {
    const Eigen::Isometry3d map_from_frame = entry.second->map_from_frame.transform();
    ColoredCloud inside = *entry.second;
    inside.points.erase(
        std::remove_if(inside.points.begin(), inside.points.end(),
                       [&](const ColoredPoint& point) {
                         const Eigen::Vector3d in_map =
                             map_from_frame *
                             Eigen::Vector3f(point.x_m, point.y_m, point.z_m).cast<double>();
                         return !contains(box, in_map.x(), in_map.y());
                       }),
        inside.points.end());
    if (!inside.points.empty()) region.clouds.push_back(std::move(inside));
  }
  return region;
}

OccupancyGrid WorldMap::gridIn(const MapBox& box,
                               const std::vector<const LocalOccupancy*>& newest_first) const {
  // Cells of the region fall onto those of the newest grid unless that is rotated.
  const LocalOccupancy& newest = *newest_first.front();
  const double cell_m = newest.grid.resolution_m;
  const Pose2 origin = newest.map_from_frame.planar() * newest.grid.map_from_grid;
  const CellRange x((box.min_x_m - origin.x_m) / cell_m, (box.max_x_m - origin.x_m) / cell_m);
  const CellRange y((box.min_y_m - origin.y_m) / cell_m, (box.max_y_m - origin.y_m) / cell_m);
  if (!(x.count * y.count <= static_cast<double>(kMaxCells)) ||
      x.count > std::numeric_limits<int>::max() || y.count > std::numeric_limits<int>::max()) {
    throw std::length_error("the box has more than " + std::to_string(kMaxCells) + " cells of " +
                            std::to_string(cell_m) + " m");
  }
  OccupancyGrid grid;
  grid.resolution_m = cell_m;
  grid.map_from_grid = {origin.x_m + x.first * cell_m, origin.y_m + y.first * cell_m, 0.0};
  grid.width = static_cast<int>(x.count);
  grid.height = static_cast<int>(y.count);
  grid.cells.assign(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height),
                    kUnknownCell);

  for (const LocalOccupancy* local : newest_first) fillFrom(*local, grid);
  return grid;
}

LandmarkLayer WorldMap::landmarksIn(const MapBox& box) const {
  LandmarkLayer inside;
  inside.stamp_ns = landmarks().stamp_ns;
  std::set<std::uint32_t> ids;
  for (const WorldLandmark& landmark : landmarks().landmarks) {
    if (!contains(box, landmark.pose.position_m.x(), landmark.pose.position_m.y())) continue;
    inside.landmarks.push_back(landmark);
    ids.insert(ids.end(), landmark.id);
  }
  for (const LandmarkCrossCovariance& block : landmarks().cross_covariances) {
    if (ids.count(block.first_id) + ids.count(block.second_id) == 2)
      inside.cross_covariances.push_back(block);
  }
  return inside;
}

}  // namespace ram_slam
