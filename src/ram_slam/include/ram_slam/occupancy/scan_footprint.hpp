// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace ram_slam {

/// Edge of a tile of cells: a row of a tile is one machine word of bits.
constexpr int kTileCells = 64;

/// Index of a tile: cell index divided by kTileCells, rounded down.
struct TileIndex {
  int x = 0;
  int y = 0;
  bool operator<(const TileIndex& other) const { return y != other.y ? y < other.y : x < other.x; }
  bool operator==(const TileIndex& other) const { return x == other.x && y == other.y; }
};

/// A half-open box of tiles, [begin, end) in both axes; empty by default.
struct TileBox {
  TileIndex begin;
  TileIndex end;

  bool empty() const { return begin.x >= end.x || begin.y >= end.y; }
  bool operator==(const TileBox& other) const { return begin == other.begin && end == other.end; }
  /// The smallest box that holds both.
  TileBox joined(const TileBox& other) const;
  double cellCount() const;
};

/// A beam in units of cells, in the map's axes.
struct Beam {
  Eigen::Vector2d end = Eigen::Vector2d::Zero();  ///< where it hit; only if `hit`
  Eigen::Vector2d free_end =
      Eigen::Vector2d::Zero();  ///< cells left before this point are free; its own cell is not
  bool hit = false;
};

/// The set of cells that one scan saw free and the set in which it hit something; disjoint, a hit
/// wins.
///
/// Bit sets over whole tiles, so that a cell that many beams cross is counted once and sets are
/// merged into a map word by word.
class ScanFootprint {
public:
  /// The tiles that the sensor and all ends of beams lie in.
  static TileBox boxOf(const Eigen::Vector2d& sensor, const std::vector<Beam>& beams);

  /// Exact traversal: every cell whose interior a beam crosses (as Amanatides & Woo, "A fast voxel
  /// traversal algorithm for ray tracing", Eurographics 1987, but by runs of cells per row). \param
  /// box  boxOf(sensor, beams)
  ScanFootprint(const Eigen::Vector2d& sensor, const std::vector<Beam>& beams, const TileBox& box);

  const TileBox& box() const { return box_; }

  /// Bits of the 64 cells of a row of a tile; bit 0 is the lowest x.
  std::uint64_t freeRow(const TileIndex& tile, int row) const {
    const std::size_t word = wordOf(tile, row);
    return free_[word] & ~hit_[word];
  }
  std::uint64_t hitRow(const TileIndex& tile, int row) const { return hit_[wordOf(tile, row)]; }

private:
  std::size_t wordOf(const TileIndex& tile, int row) const {
    return (static_cast<std::size_t>(tile.y - box_.begin.y) * width_tiles_ +
            static_cast<std::size_t>(tile.x - box_.begin.x)) *
               kTileCells +
           static_cast<std::size_t>(row);
  }
  /// Sets the bits of the cells first_x .. last_x of a row; indices count from the box's corner.
  void setFree(std::int64_t row, std::int64_t first_x, std::int64_t last_x) {
    const std::uint64_t first_mask = ~std::uint64_t{0} << (first_x & 63);
    const std::uint64_t last_mask = ~std::uint64_t{0} >> (63 - (last_x & 63));
    std::uint64_t* words = free_.data() + (row >> 6) * width_words_ + (row & 63);
    std::uint64_t* first = words + (first_x & ~63);
    std::uint64_t* last = words + (last_x & ~63);
    if (first == last) {
      *first |= first_mask & last_mask;
      return;
    }
    *first |= first_mask;
    for (first += 64; first != last; first += 64) *first = ~std::uint64_t{0};
    *last |= last_mask;
  }
  void traceFree(const Eigen::Vector2d& from, const Eigen::Vector2d& to);

  TileBox box_;
  std::size_t width_tiles_ = 0;
  std::int64_t width_words_ = 0;
  std::vector<std::uint64_t> free_;
  std::vector<std::uint64_t> hit_;
};

}  // namespace ram_slam
