// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "ram_slam/sensing/laser_scan.hpp"

namespace ramscout_feature_detector {

/// What one scan shows of the surroundings of a corner: a polar grid centred on the corner whose
/// axis is the corner's bisector. Text form "pg1:8x24:4.0:<64 base64 characters>", two bits a cell,
/// ring by ring from the inside, sectors counter-clockwise from the bisector, first cell in the
/// lowest bits.
class PolarGrid {
public:
  static constexpr int kRings = 8;
  static constexpr int kSectors = 24;
  static constexpr int kCells = kRings * kSectors;
  static constexpr double kInnerRadiusM = 0.05;
  static constexpr double kOuterRadiusM = 4.0;

  enum Cell : std::uint8_t { kUnknown = 0, kFree = 1, kMixed = 2, kOccupied = 3 };

  /// What the scan shows around a place in the laser's frame.
  static PolarGrid around(const Eigen::Vector2d& place_m,
                          double orientation_rad,
                          const ram_slam::LaserScan& scan);

  /// Nothing if the text is not a grid of this scheme and size.
  static std::optional<PolarGrid> parse(const std::string& text);
  std::string toString() const;

  /// \param sector  any integer; counted round
  Cell at(int ring, int sector) const {
    return cells_[ring * kSectors + ((sector % kSectors) + kSectors) % kSectors];
  }
  void set(int ring, int sector, Cell cell) { cells_[ring * kSectors + sector] = cell; }

private:
  std::array<Cell, kCells> cells_{};
};

/// Weights of the comparison of two grids. The ratios of CornerMatcher were measured with these.
struct GridComparison {
  int least_common_cells = PolarGrid::kCells / 5;
  double prior_cells = 20.0;       ///< the prior counts as much as so many cells
  double prior_difference = 0.12;  ///< of grids with nothing in common
  double one_sided = 0.1;          ///< of the share of all cells known in one only
  double per_sector = 0.01;        ///< turned
};

/// A grid prepared for comparing: its cells as bits, turned by -1, 0 and 1 sector.
class ComparableGrid {
public:
  explicit ComparableGrid(const PolarGrid& grid);

  /// How different the surroundings appear, at least 0, for the best of the turns by -1, 0 and 1
  /// sector:
  ///
  /// (sum of squared differences of occupancy + 20 * 0.12) / (cells known in both + 20)
  ///   + 0.1 * (share of all cells known in one only) + 0.01 * |turn|
  ///
  /// with occupancy 0 (free), 1/2 (mixed), 1 (occupied): few common cells mean little, and from
  /// about the same place about the same cells are seen. Nothing if fewer than a fifth of the cells
  /// are known in both. Symmetric.
  std::optional<double> distance(const ComparableGrid& other,
                                 const GridComparison& weights = {}) const;

private:
  static constexpr int kWords = PolarGrid::kCells / 64;
  struct Planes {
    std::array<std::uint64_t, kWords> free{}, mixed{}, occupied{};
  };
  static Planes planesOf(const PolarGrid& grid, int turn);

  std::array<Planes, 3> turned_;  ///< by -1, 0, 1 sector
};

}  // namespace ramscout_feature_detector
