// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// How likely a reading is to end in each cell of a part of the map, and at level h the greatest of
/// the 2^h x 2^h cells of which it is the lower left one: what a reading can meet when it is
/// shifted by less than 2^h cells up and to the right (Hess et al., ICRA 2016, equation 15).
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

  int levelCount() const { return static_cast<int>(levels_.size()); }
  /// The cells of a level, 0 .. 255, row by row.
  const std::uint8_t* level(int level) const {
    return levels_[static_cast<std::size_t>(level)].data();
  }
  /// Of a cell, at every level. Cells outside share those of the margin, where all is 0 so far to
  /// the right and above that four squares of any level beside each other fit in.
  std::ptrdiff_t indexOf(int column, int row) const {
    return static_cast<std::ptrdiff_t>(std::clamp(row, -margin_, rows_) + margin_) * stride_ +
           std::clamp(column, -margin_, columns_) + margin_;
  }
  /// Indices from a row to the next.
  int stride() const { return stride_; }
  double resolution_m() const { return resolution_m_; }
  /// Lower left corner of fine cell (0, 0).
  Eigen::Vector2f origin_m() const { return origin_m_; }

private:
  double resolution_m_;
  Eigen::Vector2f origin_m_;
  int columns_ = 0;
  int rows_ = 0;
  int margin_ = 0;  ///< cells to the left and below
  int stride_ = 0;
  std::vector<std::vector<std::uint8_t>> levels_;
};

/// Where to search, about a centre.
struct SearchWindow {
  double distance_m = 0.5;  ///< to each side
  double angle_rad = 0.2;   ///< to each side
  double angle_step_rad = 0.01;
  std::optional<Pose2> excluded = {};  ///< poses within `excluded_gate` of this are left out
  MotionGate excluded_gate = {};
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
