// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/occupancy/scan_footprint.hpp"

#include <algorithm>
#include <cmath>

namespace ram_slam {
namespace {

TileIndex tileOf(const Eigen::Vector2d& point_cells) {
  return {static_cast<int>(std::floor(point_cells.x() / kTileCells)),
          static_cast<int>(std::floor(point_cells.y() / kTileCells))};
}

}  // namespace

TileBox TileBox::joined(const TileBox& other) const {
  if (empty()) return other;
  if (other.empty()) return *this;
  return {{std::min(begin.x, other.begin.x), std::min(begin.y, other.begin.y)},
          {std::max(end.x, other.end.x), std::max(end.y, other.end.y)}};
}

double TileBox::cellCount() const {
  if (empty()) return 0.0;
  return static_cast<double>(end.x - begin.x) * static_cast<double>(end.y - begin.y) * kTileCells *
         kTileCells;
}

TileBox ScanFootprint::boxOf(const Eigen::Vector2d& sensor, const std::vector<Beam>& beams) {
  Eigen::Vector2d low = sensor;
  Eigen::Vector2d high = sensor;
  for (const Beam& beam : beams) {
    const Eigen::Vector2d& farthest = beam.hit ? beam.end : beam.free_end;
    low = low.cwiseMin(farthest);
    high = high.cwiseMax(farthest);
  }
  const TileIndex last = tileOf(high);
  return {tileOf(low), {last.x + 1, last.y + 1}};
}

ScanFootprint::ScanFootprint(const Eigen::Vector2d& sensor,
                             const std::vector<Beam>& beams,
                             const TileBox& box)
    : box_(box), width_tiles_(static_cast<std::size_t>(box.end.x - box.begin.x)) {
  const std::size_t words =
      width_tiles_ * static_cast<std::size_t>(box.end.y - box.begin.y) * kTileCells;
  free_.resize(words, 0);
  hit_.resize(words, 0);
  const Eigen::Vector2d corner = kTileCells * Eigen::Vector2d(box.begin.x, box.begin.y);
  const Eigen::Vector2d from = sensor - corner;
  for (const Beam& beam : beams) {
    traceFree(from, beam.free_end - corner);
    if (!beam.hit) continue;
    const int x = static_cast<int>(beam.end.x() - corner.x());
    const int y = static_cast<int>(beam.end.y() - corner.y());
    const TileIndex tile{box_.begin.x + x / kTileCells, box_.begin.y + y / kTileCells};
    hit_[wordOf(tile, y % kTileCells)] |= std::uint64_t{1} << (x % kTileCells);
  }
}

void ScanFootprint::setFree(int row, int first_x, int last_x) {
  const std::size_t first_tile = static_cast<std::size_t>(first_x) / kTileCells;
  const std::size_t last_tile = static_cast<std::size_t>(last_x) / kTileCells;
  const std::uint64_t first_mask = ~std::uint64_t{0} << (first_x % kTileCells);
  const std::uint64_t last_mask = ~std::uint64_t{0} >> (kTileCells - 1 - last_x % kTileCells);
  std::uint64_t* words = free_.data() +
                         static_cast<std::size_t>(row / kTileCells) * width_tiles_ * kTileCells +
                         static_cast<std::size_t>(row % kTileCells);
  if (first_tile == last_tile) {
    words[first_tile * kTileCells] |= first_mask & last_mask;
    return;
  }
  words[first_tile * kTileCells] |= first_mask;
  for (std::size_t tile = first_tile + 1; tile < last_tile; ++tile)
    words[tile * kTileCells] = ~std::uint64_t{0};
  words[last_tile * kTileCells] |= last_mask;
}

void ScanFootprint::traceFree(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const int first_x = static_cast<int>(from.x());
  const int last_x = static_cast<int>(to.x());
  const int last_row = static_cast<int>(to.y());
  int row = static_cast<int>(from.y());
  int x = first_x;
  const double slope = (to.x() - from.x()) / (to.y() - from.y());
  const int step = row < last_row ? 1 : -1;
  const int boundary = row < last_row ? 1 : 0;  // the row's edge that the beam leaves through
  for (; row != last_row; row += step) {
    const double leaves_at = from.x() + (row + boundary - from.y()) * slope;
    // Rounding may put a crossing of the last column's edge just beyond it.
    const int next_x = std::clamp(static_cast<int>(leaves_at), std::min(first_x, last_x),
                                  std::max(first_x, last_x));
    setFree(row, std::min(x, next_x), std::max(x, next_x));
    x = next_x;
  }
  if (x < last_x) setFree(row, x, last_x - 1);
  if (x > last_x) setFree(row, last_x + 1, x);
}

}  // namespace ram_slam
