// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/occupancy/occupancy_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace ram_slam {
namespace {

/// Cell indices of a millimetre then still fit in an int.
constexpr double kFarthestPoseM = 1e6;
/// Per beam [m], [rad]: what rounding makes of a laser at rest.
constexpr double kNegligibleTwist = 1e-9;
/// Calls `change(first, length)` for the first bit and length of every run of set bits.
template <typename Change>
void forEachRun(std::uint64_t bits, Change change) {
  while (bits != 0) {
    const int first = __builtin_ctzll(bits);
    const std::uint64_t rest = ~(bits >> first);
    const int length = rest == 0 ? kTileCells : __builtin_ctzll(rest);
    change(first, length);
    if (first + length >= kTileCells) return;
    bits &= ~std::uint64_t{0} << (first + length);
  }
}

template <typename Visit>
void forEachTile(const TileBox& box, Visit visit) {
  for (int y = box.begin.y; y < box.end.y; ++y) {
    for (int x = box.begin.x; x < box.end.x; ++x) visit(TileIndex{x, y});
  }
}

bool isEmpty(const ScanFootprint& footprint, const TileIndex& tile) {
  std::uint64_t any = 0;
  for (int row = 0; row < kTileCells; ++row)
    any |= footprint.freeRow(tile, row) | footprint.hitRow(tile, row);
  return any == 0;
}

/// Adds `increment` to the counters of the cells of a row whose bits are set.
void count(std::uint64_t bits, std::uint32_t* row, std::uint32_t increment) {
  forEachRun(bits, [&](int first, int length) {
    for (int i = first; i < first + length; ++i) row[i] += increment;
  });
}

bool allPositive(std::uint64_t bits, const std::uint32_t* row) {
  bool positive = true;
  forEachRun(bits, [&](int first, int length) {
    for (int i = first; i < first + length; ++i) positive = positive && row[i] > 0;
  });
  return positive;
}

}  // namespace

OccupancyMapper::OccupancyMapper(const OccupancyMapperParameters& parameters)
    : parameters_(parameters) {
  parameters_.validate();
}

BeamCounts OccupancyMapper::add(const LaserScan& scan,
                                const Pose2& map_from_laser,
                                const Pose2& last_beam) {
  const TracedScan traced = trace(scan, map_from_laser, last_beam);
  const ScanFootprint& footprint = traced.footprint;
  ++revision_;
  forEachTile(footprint.box(), [&](const TileIndex& index) {
    if (isEmpty(footprint, index)) return;
    Tile& tile = tiles_[index];
    tile.revision = revision_;
    box_ = box_.joined({index, {index.x + 1, index.y + 1}});
    for (int row = 0; row < kTileCells; ++row) {
      const std::uint64_t hit = footprint.hitRow(index, row);
      count(footprint.freeRow(index, row) | hit, tile.visits.data() + row * kTileCells, 1);
      count(hit, tile.hits.data() + row * kTileCells, 1);
    }
  });
  return traced.counts;
}

void OccupancyMapper::remove(const LaserScan& scan,
                             const Pose2& map_from_laser,
                             const Pose2& last_beam) {
  const ScanFootprint footprint = trace(scan, map_from_laser, last_beam).footprint;
  if (!holds(footprint)) throw std::invalid_argument("cannot remove a scan that was not added");
  ++revision_;
  const std::uint32_t minus_one = ~std::uint32_t{0};  // unsigned numbers wrap around
  forEachTile(footprint.box(), [&](const TileIndex& index) {
    if (isEmpty(footprint, index)) return;
    const auto found = tiles_.find(index);
    Tile& tile = found->second;
    tile.revision = revision_;
    for (int row = 0; row < kTileCells; ++row) {
      const std::uint64_t hit = footprint.hitRow(index, row);
      count(footprint.freeRow(index, row) | hit, tile.visits.data() + row * kTileCells, minus_one);
      count(hit, tile.hits.data() + row * kTileCells, minus_one);
    }
    if (std::any_of(tile.visits.begin(), tile.visits.end(), [](std::uint32_t n) { return n > 0; }))
      return;
    tiles_.erase(found);
    shrunk_at_revision_ = revision_;
  });
  if (shrunk_at_revision_ != revision_) return;
  box_ = {};
  for (const auto& [index, tile] : tiles_) box_ = box_.joined({index, {index.x + 1, index.y + 1}});
}

bool OccupancyMapper::holds(const ScanFootprint& footprint) const {
  bool held = true;
  forEachTile(footprint.box(), [&](const TileIndex& index) {
    if (!held || isEmpty(footprint, index)) return;
    const auto found = tiles_.find(index);
    held = found != tiles_.end();
    for (int row = 0; held && row < kTileCells; ++row) {
      const std::uint64_t hit = footprint.hitRow(index, row);
      held = allPositive(hit, found->second.hits.data() + row * kTileCells) &&
             allPositive(footprint.freeRow(index, row) | hit,
                         found->second.visits.data() + row * kTileCells);
    }
  });
  return held;
}

OccupancyGrid OccupancyMapper::grid() const {
  OccupancyGrid grid = emptyGrid();
  grid.cells.assign(grid.index(0, grid.height), kUnknownCell);
  for (const auto& [index, tile] : tiles_) render(index, tile, grid);
  return grid;
}

CellCounts OccupancyMapper::counts(int x, int y) const {
  const auto tileOf = [](int cell) {
    return cell >= 0 ? cell / kTileCells : -((-cell - 1) / kTileCells) - 1;
  };
  const TileIndex index{tileOf(x), tileOf(y)};
  const auto found = tiles_.find(index);
  if (found == tiles_.end()) return {};
  const auto cell =
      static_cast<std::size_t>((y - index.y * kTileCells) * kTileCells + x - index.x * kTileCells);
  return {found->second.hits[cell], found->second.visits[cell]};
}

GridChange OccupancyMapper::refresh(OccupancyGrid& grid, std::uint64_t revision) const {
  const OccupancyGrid fresh = emptyGrid();
  const bool same_box = fresh.width == grid.width && fresh.height == grid.height &&
                        fresh.map_from_grid.x_m == grid.map_from_grid.x_m &&
                        fresh.map_from_grid.y_m == grid.map_from_grid.y_m;
  if (!same_box || shrunk_at_revision_ > revision) {
    grid = this->grid();
    return {true, 0, 0, grid.width, grid.height};
  }
  TileBox changed;
  for (const auto& [index, tile] : tiles_) {
    if (tile.revision <= revision) continue;
    render(index, tile, grid);
    changed = changed.joined({index, {index.x + 1, index.y + 1}});
  }
  return {false, (changed.begin.x - box_.begin.x) * kTileCells,
          (changed.begin.y - box_.begin.y) * kTileCells,
          (changed.end.x - changed.begin.x) * kTileCells,
          (changed.end.y - changed.begin.y) * kTileCells};
}

OccupancyMapper::TracedScan OccupancyMapper::trace(const LaserScan& scan,
                                                   const Pose2& map_from_laser,
                                                   const Pose2& last_beam) {
  scan.validate();
  for (const Pose2& pose : {map_from_laser, map_from_laser * last_beam}) {
    if (pose.isFinite() && pose.translation().cwiseAbs().maxCoeff() <= kFarthestPoseM) continue;
    std::ostringstream message;
    message << "cannot map a scan seen from (" << pose.x_m << ", " << pose.y_m << ") m";
    throw std::invalid_argument(message.str());
  }
  BeamCounts counts;
  const std::vector<Beam> beams = beamsOf(scan, map_from_laser, last_beam, counts);
  const Eigen::Vector2d sensor = map_from_laser.translation() / parameters_.resolution;
  const TileBox box = ScanFootprint::boxOf(sensor, beams);
  const double cells = box_.joined(box).cellCount();
  if (cells > parameters_.max_cell_count) {
    std::ostringstream message;
    message << "the map would grow to " << cells << " cells of " << parameters_.resolution
            << " m, more than max_cell_count " << parameters_.max_cell_count;
    throw std::length_error(message.str());
  }
  return {ScanFootprint(sensor, beams, box), counts};
}

const std::vector<Eigen::Vector2d>& OccupancyMapper::directionsOf(const LaserScan& scan) {
  if (directions_.size() != scan.ranges_m.size() ||
      directions_scan_.angle_min_rad != scan.angle_min_rad ||
      directions_scan_.angle_increment_rad != scan.angle_increment_rad) {
    directions_scan_.angle_min_rad = scan.angle_min_rad;
    directions_scan_.angle_increment_rad = scan.angle_increment_rad;
    directions_.resize(scan.ranges_m.size());
    for (std::size_t i = 0; i < directions_.size(); ++i) {
      directions_[i] = {std::cos(scan.bearing_rad(i)), std::sin(scan.bearing_rad(i))};
    }
  }
  return directions_;
}

std::vector<Beam> OccupancyMapper::beamsOf(const LaserScan& scan,
                                           const Pose2& map_from_laser,
                                           const Pose2& last_beam,
                                           BeamCounts& counts) {
  const std::vector<Eigen::Vector2d>& directions = directionsOf(scan);
  const Eigen::Matrix2d map_from_laser_rotation = map_from_laser.rotation();
  const Eigen::Vector2d sensor = map_from_laser.translation() / parameters_.resolution;
  const double last = static_cast<double>(std::max<std::size_t>(scan.ranges_m.size(), 2) - 1);
  const Eigen::Vector3d twist = logarithm(last_beam) / last;  // per beam
  const bool moves = !twist.isZero(kNegligibleTwist);
  const double nothing_m = std::min<double>(scan.range_max_m, parameters_.clear_max_range_m);
  std::vector<Beam> beams;
  beams.reserve(scan.ranges_m.size());
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const Return kind = scan.at(i);
    double range_m = nothing_m;
    if (kind == Return::kHit) range_m = std::min<double>(scan.ranges_m[i], parameters_.max_range_m);
    if (kind == Return::kTooClose) ++counts.too_close;
    if (kind == Return::kInvalid || (kind == Return::kNothing && nothing_m == 0.0))
      ++counts.invalid;
    if ((kind != Return::kHit && kind != Return::kNothing) || range_m == 0.0) continue;

    const bool hit = kind == Return::kHit && scan.ranges_m[i] <= parameters_.max_range_m;
    ++(hit ? counts.hit : counts.cleared);
    Eigen::Vector2d direction = directions[i];
    if (moves) {
      const Eigen::Vector2d end_m =
          exponential(static_cast<double>(i) * twist) * Eigen::Vector2d(range_m * direction);
      range_m = end_m.norm();
      direction = end_m.normalized();
    }
    direction = map_from_laser_rotation * direction;
    const double length = range_m / parameters_.resolution;
    beams.push_back({sensor + length * direction,
                     sensor + std::max(0.0, length - parameters_.clearance_cells) * direction,
                     hit});
  }
  return beams;
}

std::int8_t OccupancyMapper::valueOf(std::uint32_t hits, std::uint32_t visits) const {
  if (visits < static_cast<std::uint32_t>(parameters_.min_visits)) return kUnknownCell;
  return hits > parameters_.occupied_threshold * visits ? kOccupiedCell : kFreeCell;
}

OccupancyGrid OccupancyMapper::emptyGrid() const {
  OccupancyGrid grid;
  grid.resolution_m = parameters_.resolution;
  if (box_.empty()) return grid;
  const double tile_m = kTileCells * parameters_.resolution;
  grid.map_from_grid = {box_.begin.x * tile_m, box_.begin.y * tile_m, 0.0};
  grid.width = (box_.end.x - box_.begin.x) * kTileCells;
  grid.height = (box_.end.y - box_.begin.y) * kTileCells;
  return grid;
}

void OccupancyMapper::render(const TileIndex& index, const Tile& tile, OccupancyGrid& grid) const {
  for (int row = 0; row < kTileCells; ++row) {
    std::int8_t* cells =
        grid.cells.data() + grid.index((index.x - box_.begin.x) * kTileCells,
                                       (index.y - box_.begin.y) * kTileCells + row);
    const std::uint32_t* hits = tile.hits.data() + row * kTileCells;
    const std::uint32_t* visits = tile.visits.data() + row * kTileCells;
    for (int x = 0; x < kTileCells; ++x) cells[x] = valueOf(hits[x], visits[x]);
  }
}

}  // namespace ram_slam
