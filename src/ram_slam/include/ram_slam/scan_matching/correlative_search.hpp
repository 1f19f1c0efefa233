// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "ram_slam/pose2.hpp"

namespace ram_slam {

/// How likely a reading is to end in each cell of a part of the map, at several resolutions: level
/// h has cells of 2^h fine cells, each with the greatest value a reading can meet within it when it
/// is shifted by up to 2^h fine cells.
class LikelihoodPyramid {
public:
  /// \param points_in_map  end points of the readings that make up the map; at least one
  /// \param resolution_m   side of a fine cell
  /// \param deviation_m    standard deviation of the readings
  /// \param levels         number of levels, at least 1
  LikelihoodPyramid(const std::vector<Eigen::Vector2f>& points_in_map,
                    double resolution_m,
                    double deviation_m,
                    int levels);

  struct Level {
    int columns = 0;
    int rows = 0;
    std::vector<std::uint8_t> cells;  ///< 0 .. 255, row by row

    /// The value at a cell; 0 outside.
    std::uint8_t at(int column, int row) const {
      const bool inside = static_cast<unsigned>(column) < static_cast<unsigned>(columns) &&
                          static_cast<unsigned>(row) < static_cast<unsigned>(rows);
      return inside ? cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                            static_cast<std::size_t>(column)]
                    : std::uint8_t{0};
    }
  };

  const std::vector<Level>& levels() const { return levels_; }
  double resolution_m() const { return resolution_m_; }
  /// Lower left corner of fine cell (0, 0).
  Eigen::Vector2f origin_m() const { return origin_m_; }

private:
  double resolution_m_;
  Eigen::Vector2f origin_m_;
  std::vector<Level> levels_;
};

/// Where to search, about a centre.
struct SearchWindow {
  double distance_m = 0.5;  ///< to each side
  double angle_rad = 0.2;   ///< to each side
  double angle_step_rad = 0.01;
};

struct CorrelativeMatch {
  Pose2 map_from_laser;
  double score = 0.0;  ///< mean likelihood of the readings, 0 .. 1
};

/// The pose in the window at which the points fit best, by branch and bound (Hess et al., ICRA
/// 2016, section V): the same answer as trying every cell and angle. None if no pose scores at
/// least `min_score`.
std::optional<CorrelativeMatch> searchPose(const LikelihoodPyramid& pyramid,
                                           const std::vector<Eigen::Vector2f>& points_in_laser,
                                           const Pose2& map_from_laser_centre,
                                           const SearchWindow& window,
                                           double min_score);

/// Mean likelihood, 0 .. 1, of points at one pose; `points_in_laser` must not be empty.
double scorePose(const LikelihoodPyramid& pyramid,
                 const std::vector<Eigen::Vector2f>& points_in_laser,
                 const Pose2& map_from_laser);

}  // namespace ram_slam
