// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/occupancy/scan_footprint.hpp"

#include <algorithm>
#include <cmath>

namespace ram_slam {
namespace {

/// Of a column in fixed point: half a 64-bit number, so that 2^31 columns fit.
constexpr int kFractionBits = 32;
constexpr double kFixedPointOne = static_cast<double>(std::int64_t{1} << kFractionBits);

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
  width_words_ = static_cast<std::int64_t>(width_tiles_ * kTileCells);
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

void ScanFootprint::traceFree(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const auto first_row = static_cast<std::int64_t>(from.y());
  const auto last_row = static_cast<std::int64_t>(to.y());
  const auto last_x = static_cast<std::int64_t>(to.x());
  const bool up = first_row < last_row;
  // Where the beam leaves its row, in fixed point: quicker than floating point, off by 2^-32 cells
  // per row at most.
  const double slope =
      first_row == last_row ? 0.0 : (to.x() - from.x()) / std::abs(to.y() - from.y());
  const double first_part = up ? static_cast<double>(first_row + 1) - from.y()
                               : from.y() - static_cast<double>(first_row);
  std::int64_t leaves_at =
      static_cast<std::int64_t>((from.x() + first_part * slope) * kFixedPointOne);
  const std::int64_t row_count = std::abs(last_row - first_row);
  // A beam that enters just one more row may be so flat that its slope has no fixed point.
  const std::int64_t step = row_count > 1 ? static_cast<std::int64_t>(slope * kFixedPointOne) : 0;
  auto x = static_cast<std::int64_t>(from.x());
  const std::int64_t row_step = up ? 1 : -1;
  std::int64_t row = first_row;
  if (slope >= 0.0) {
    for (std::int64_t i = 0; i < row_count; ++i, row += row_step, leaves_at += step) {
      const std::int64_t next_x = std::min(leaves_at >> kFractionBits, last_x);
      setFree(row, x, next_x);
      x = next_x;
    }
  } else {
    for (std::int64_t i = 0; i < row_count; ++i, row += row_step, leaves_at += step) {
      const std::int64_t next_x = std::max(leaves_at >> kFractionBits, last_x);
      setFree(row, next_x, x);
      x = next_x;
    }
  }
  if (x < last_x) setFree(row, x, last_x - 1);
  if (x > last_x) setFree(row, last_x + 1, x);
}

}  // namespace ram_slam
