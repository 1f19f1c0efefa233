// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/occupancy/occupancy_grid.hpp"
#include "ram_slam/occupancy/occupancy_mapper_parameters.hpp"
#include "ram_slam/occupancy/scan_footprint.hpp"
#include "ram_slam/sensing/laser_scan.hpp"

namespace ram_slam {

/// What became of a scan's beams (REP 117).
struct BeamCounts {
  int hit = 0;        ///< marked a cell occupied
  int cleared = 0;    ///< beyond max_range_m or +Inf with clearing on: only cleared
  int too_close = 0;  ///< -Inf: ignored
  int invalid = 0;    ///< NaN or outside the limits, or +Inf with clearing off: ignored
};

/// How often a cell was seen: the map's stored truth.
struct CellCounts {
  std::uint32_t hits = 0;
  std::uint32_t visits = 0;  ///< scans that saw the cell, free or hit
  bool operator==(const CellCounts& other) const {
    return hits == other.hits && visits == other.visits;
  }
};

/// Which cells of a grid were written.
struct GridChange {
  bool whole = false;  ///< the grid is a new one: its box changed
  int x = 0;           ///< first column
  int y = 0;           ///< first row
  int width = 0;       ///< columns; 0: nothing changed
  int height = 0;      ///< rows
};

/// An occupancy map that scans are added to and can be taken out of again.
///
/// Each scan counts once per cell: a visit to every cell it saw, and a hit where it hit (a hit wins
/// over a pass). Counts are integers, so that any order of scans gives the same map and removing a
/// scan restores exactly what was before. Cells lie on a fixed lattice: cell (i, j) covers [i, i +
/// 1) x [j, j + 1) times the resolution. The map grows by tiles of 64 x 64 cells up to a size cap.
class OccupancyMapper {
public:
  /// \throws std::invalid_argument as OccupancyMapperParameters::validate()
  explicit OccupancyMapper(const OccupancyMapperParameters& parameters);

  /// Adds a scan seen from `map_from_laser`. The map is unchanged if this throws.
  /// \param last_beam  pose of the laser at the last beam, seen from the first one; in between it
  /// moves at constant twist (what the beams pass is drawn as if it had not moved)
  /// \throws std::invalid_argument for a scan of no use (LaserScan::validate()) or a pose that is
  /// not finite or absurdly
  ///         far away
  /// \throws std::length_error if the map would grow beyond max_cell_count
  BeamCounts add(const LaserScan& scan, const Pose2& map_from_laser, const Pose2& last_beam = {});

  /// Takes out a scan that was added with exactly these arguments. The map is unchanged if this
  /// throws. \throws std::invalid_argument if it cannot have been added
  void remove(const LaserScan& scan, const Pose2& map_from_laser, const Pose2& last_beam = {});

  /// The whole map; its box consists of whole tiles. Empty (0 x 0) before the first scan.
  OccupancyGrid grid() const;

  /// Counts of the cell at (x, y), which are cell indices on the map's lattice.
  CellCounts counts(int x, int y) const;

  /// Changes with every add() and remove().
  std::uint64_t revision() const { return revision_; }

  /// Brings `grid`, which grid() or refresh() made at `revision`, up to date. Costs as much as
  /// there are changed tiles, unless the map's box changed.
  GridChange refresh(OccupancyGrid& grid, std::uint64_t revision) const;

private:
  struct Tile {
    std::array<std::uint32_t, kTileCells * kTileCells> visits{};
    std::array<std::uint32_t, kTileCells * kTileCells> hits{};
    std::uint64_t revision = 0;
  };
  struct TracedScan {
    ScanFootprint footprint;
    BeamCounts counts;
  };

  TracedScan trace(const LaserScan& scan, const Pose2& map_from_laser, const Pose2& last_beam);
  /// Unit vectors along the beams, in the laser's frame; kept from scan to scan.
  const std::vector<Eigen::Vector2d>& directionsOf(const LaserScan& scan);
  std::vector<Beam> beamsOf(const LaserScan& scan,
                            const Pose2& map_from_laser,
                            const Pose2& last_beam,
                            BeamCounts& counts);
  std::int8_t valueOf(std::uint32_t hits, std::uint32_t visits) const;
  bool holds(const ScanFootprint& footprint) const;
  /// The map's box, without cells.
  OccupancyGrid emptyGrid() const;
  void render(const TileIndex& index, const Tile& tile, OccupancyGrid& grid) const;

  OccupancyMapperParameters parameters_;
  std::map<TileIndex, Tile> tiles_;
  TileBox box_;
  std::uint64_t revision_ = 0;
  std::uint64_t shrunk_at_revision_ = 0;  ///< when a tile was last dropped

  LaserScan directions_scan_;  ///< the geometry that directions_ belongs to; no ranges
  std::vector<Eigen::Vector2d> directions_;
};

}  // namespace ram_slam
