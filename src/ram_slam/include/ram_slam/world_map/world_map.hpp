// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/occupancy/occupancy_grid.hpp"
#include "ram_slam/sensing/placed_scan.hpp"

namespace ram_slam {

/// Where something is in space, as geometry_msgs/PoseWithCovariance has it.
struct SpatialPose {
  /// Of a coordinate that a planar estimator does not know: height, roll and pitch.
  static constexpr double kUnknownVariance = 1e6;
  /// Of a quaternion's norm from 1: what rounding of single-precision numbers leaves, and more.
  static constexpr double kQuaternionTolerance = 1e-3;

  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  /// Order x y z roll pitch yaw [m^2, m rad, rad^2], fixed axes of the parent frame (REP 103).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();

  Eigen::Isometry3d transform() const;
  Pose2 planar() const;
};

/// An occupancy grid in a frame of its own, and where that frame is in the map.
struct LocalOccupancy {
  std::int64_t stamp_ns = 0;
  std::string frame;
  SpatialPose map_from_frame;
  OccupancyGrid grid;  ///< `map_from_grid` is the grid's origin in `frame`
};

/// A landmark of the feature layer: ram_slam_msgs/Landmark.
struct WorldLandmark {
  /// Most bytes of `classifier`: keeps a million landmarks within some gigabytes.
  static constexpr std::size_t kMaxClassifierLength = 4096;

  std::uint32_t id = 0;
  std::int64_t stamp_ns = 0;
  std::string type;
  std::string classifier;
  SpatialPose pose;
  double existence_log_odds = 0.0;
};

/// Cross-covariance of the positions of two landmarks, first_id < second_id:
/// ram_slam_msgs/CovarianceBlock.
struct LandmarkCrossCovariance {
  std::uint32_t first_id = 0;
  std::uint32_t second_id = 0;
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
};

/// The feature layer: landmarks by id, and the blocks of their joint covariance that are not zero.
struct LandmarkLayer {
  std::int64_t stamp_ns = 0;
  std::vector<WorldLandmark> landmarks;
  std::vector<LandmarkCrossCovariance> cross_covariances;  ///< by (first_id, second_id)
};

struct ColoredPoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
  std::uint32_t rgb = 0;  ///< 0x00rrggbb
};

/// Coloured points in a frame of their own, and where that frame is in the map.
struct ColoredCloud {
  std::int64_t stamp_ns = 0;
  std::string frame;
  SpatialPose map_from_frame;
  std::vector<ColoredPoint> points;
};

/// An axis-aligned part of the map [m].
struct MapBox {
  double min_x_m = 0.0;
  double min_y_m = 0.0;
  double max_x_m = 0.0;
  double max_y_m = 0.0;
};

/// What a map holds within a box.
struct MapRegion {
  std::int64_t grid_stamp_ns = 0;
  OccupancyGrid grid;  ///< the box rounded outwards to whole cells; no cells if no grid is stored
  LandmarkLayer landmarks;
  std::vector<ColoredCloud> clouds;  ///< only points inside
};

/// The belief about the world that outlives robots, sensors and estimators: occupancy, landmarks
/// with their joint covariance, coloured clouds, the scans that the grid was drawn from and the
/// history of the pose, in one map frame.
///
/// What comes replaces what it is about: a grid or cloud the older one of its own frame, landmarks,
/// scans and trajectory the older ones whole. Copies are cheap: they share what they hold.
class WorldMap {
public:
  /// Most cells in all grids together and in a region, most landmarks, most points in all clouds
  /// together.
  static constexpr std::size_t kMaxCells = kMaxGridCells;
  static constexpr std::size_t kMaxLandmarks = 1'000'000;
  static constexpr std::size_t kMaxPoints = 50'000'000;
  /// Most readings in all scans together: 800 MB.
  static constexpr std::size_t kMaxReadings = 200'000'000;

  /// All refuse with std::invalid_argument what is not finite, not in order or inconsistent, with
  /// std::length_error what would make the map too large; the map is unchanged then.
  void put(LocalOccupancy occupancy);
  void put(ColoredCloud cloud);
  void put(LandmarkLayer landmarks);
  void put(Trajectory trajectory);
  void put(std::vector<PlacedScan> scans);

  bool empty() const {
    return occupancies_.empty() && clouds_.empty() && !landmarks_ && !trajectory_ && !scans_;
  }

  /// By frame.
  const std::map<std::string, std::shared_ptr<const LocalOccupancy>>& occupancies() const {
    return occupancies_;
  }
  const std::map<std::string, std::shared_ptr<const ColoredCloud>>& clouds() const {
    return clouds_;
  }
  const LandmarkLayer& landmarks() const;
  const Trajectory& trajectory() const;
  /// The scans that the grid of the whole map was drawn from; their stamps are of the clock of
  /// their run.
  const std::vector<PlacedScan>& scans() const;

  /// Where grids overlap, each cell is that of the newest that knows it; the newest also gives the
  /// size of the cells. \throws std::invalid_argument if the box is empty or not finite;
  /// std::length_error if it has too many cells
  MapRegion region(const MapBox& box) const;

private:
  OccupancyGrid gridIn(const MapBox& box,
                       const std::vector<const LocalOccupancy*>& newest_first) const;
  LandmarkLayer landmarksIn(const MapBox& box) const;

  std::map<std::string, std::shared_ptr<const LocalOccupancy>> occupancies_;
  std::map<std::string, std::shared_ptr<const ColoredCloud>> clouds_;
  std::shared_ptr<const LandmarkLayer> landmarks_;
  std::shared_ptr<const Trajectory> trajectory_;
  std::shared_ptr<const std::vector<PlacedScan>> scans_;
};

}  // namespace ram_slam
