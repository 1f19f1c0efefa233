// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/occupancy/occupancy_mapper.hpp"
#include "ram_slam/occupancy/occupancy_mapper_parameters.hpp"
#include "ram_slam/sensing/laser_scan.hpp"

namespace ram_slam {

/// An occupancy map of key scans that follows corrections of the trajectory: when poses of the past
/// change, the scans taken there are taken out of the map and put in again where they belong.
///
/// Key scans are the first scan and those before which the laser moved or turned enough; what a
/// robot at rest sees is in the map once.
class KeyScanMap {
public:
  /// \throws std::invalid_argument as OccupancyMapperParameters::validate()
  explicit KeyScanMap(const OccupancyMapperParameters& parameters);

  /// Maps a scan if it is a key scan.
  /// \param last_beam  pose of the laser at the last beam, seen from the first one
  /// \return what became of its beams; nothing if it is none
  /// \throws std::invalid_argument if it is not later than the last key scan, or as
  /// OccupancyMapper::add() \throws std::length_error as OccupancyMapper::add()
  std::optional<BeamCounts> add(const LaserScan& scan,
                                const Pose2& map_from_base,
                                const Pose2& base_from_laser,
                                const Pose2& last_beam = {});

  /// Moves the kept scans to where a corrected trajectory of the base says they were taken. Scans
  /// before its start stay; scans after its end move rigidly with the last one inside. \return how
  /// many scans moved \throws std::invalid_argument as validate(Trajectory) \throws
  /// std::length_error if some scan would grow the map beyond its cap; that scan and later ones did
  /// not move
  int correct(const Trajectory& map_from_base);

  const OccupancyMapper& mapper() const { return mapper_; }
  std::size_t scanCount() const { return scans_.size(); }
  /// Scans that are in the map but no longer kept, so that no correction moves them.
  std::size_t settledCount() const { return settled_count_; }

private:
  struct KeyScan {
    LaserScan scan;
    Pose2 base_from_laser;
    Pose2 map_from_laser;
    Pose2 last_beam;
  };

  OccupancyMapperParameters parameters_;
  OccupancyMapper mapper_;
  std::deque<KeyScan> scans_;
  std::size_t settled_count_ = 0;
};

}  // namespace ram_slam
