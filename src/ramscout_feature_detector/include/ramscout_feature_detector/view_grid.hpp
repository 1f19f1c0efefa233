// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "ram_slam/sensing/laser_scan.hpp"
#include "ramscout_feature_detector/polar_grid.hpp"

namespace ramscout_feature_detector {

/// A view of the surroundings of a place: a polar grid centred on it whose axis points to the
/// laser. One physical edge is an end seen from here and a bend seen from there, so that nothing
/// about it gives a direction that all views share; where it was seen from is known, and grids of
/// views from nearby are turned against each other by little.
///
/// Rings grow with the distance, to 8 m. Text form "pg2:8x48:8.0:RANGE:<128 base64 characters>"
/// with the distance of the laser in cm; two bits a cell, ring by ring from the inside, sectors
/// counter-clockwise from the axis, first cell in the lowest bits.
class ViewGrid {
public:
  static constexpr int kRings = 8;
  static constexpr int kSectors = 48;
  static constexpr int kCells = kRings * kSectors;
  static constexpr double kInnerRadiusM = 0.05;
  static constexpr double kOuterRadiusM = 8.0;
  static constexpr double kRingOffsetM = 0.35;  ///< rings are nearly as wide as this inside
  static constexpr int kFarthestCm = 100000;

  /// What the scan shows around a place in the laser's frame.
  static ViewGrid around(const Eigen::Vector2d& place_m, const ram_slam::LaserScan& scan);

  /// Nothing if the text is not a grid of this scheme and size.
  static std::optional<ViewGrid> parse(const std::string& text);
  std::string toString() const;

  PolarGrid::Cell at(int ring, int sector) const { return cells_[ring * kSectors + sector]; }
  double range_m() const { return 0.01 * range_cm_; }

private:
  std::array<PolarGrid::Cell, kCells> cells_{};
  int range_cm_ = 0;  ///< in [0, kFarthestCm]
};

/// Weights of the comparison of two views. The ratios of EdgeMatcher were measured with these.
struct ViewComparison {
  int largest_turn = ViewGrid::kSectors / 6;  ///< in sectors, to either side
  double outermost_ring = 2.0;                ///< of the innermost ring 1, linear in between
  double least_common_share = 0.2;            ///< of all weights, to be compared at all
  double prior_cells = 60.0;                  ///< the prior counts as much as so many cells
  double prior_difference = 0.12;             ///< of views with nothing in common
  double one_sided = 0.1;                     ///< of the share of weights known in one only
  double apart_per_m = 0.01;                  ///< of the distance of the two lasers
  double farthest_apart_m = 4.0;              ///< farther ones count as this
};

/// A view prepared for comparing: the cells of each ring as bits.
class ComparableView {
public:
  explicit ComparableView(const ViewGrid& grid);

  /// How different the surroundings appear, at least 0, for the best of the turns within 60
  /// degrees:
  ///
  /// (sum of w * squared differences of occupancy + 60 * 0.12) / (sum of w of cells known in both +
  ///   60) + 0.1 * (share of w known in one only) + 0.01 / m * min(d, 4 m)
  ///
  /// with occupancy 0 (free), 1/2 (mixed), 1 (occupied), the weight w of a ring from 1 inside to 2
  /// outside, and d the distance between the two places of the laser if the grids are turned like
  /// that: few common cells mean little, and from about the same place about the same cells are
  /// seen. Nothing if less than a fifth is known in both. Symmetric.
  std::optional<double> distance(const ComparableView& other,
                                 const ViewComparison& weights = {}) const;

private:
  struct Ring {
    std::uint64_t free = 0, mixed = 0, occupied = 0;
  };
  std::array<Ring, ViewGrid::kRings> rings_;
  double range_m_;
};

}  // namespace ramscout_feature_detector
