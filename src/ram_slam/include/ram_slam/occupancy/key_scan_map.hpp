// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
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
/// robot at rest sees is in the map once. Drawing waits for draw(), so that a scan whose pose
/// changes before anyone asks for the map is drawn once.
class KeyScanMap {
public:
  /// \throws std::invalid_argument as OccupancyMapperParameters::validate()
  explicit KeyScanMap(const OccupancyMapperParameters& parameters);

  /// Keeps a scan if it is a key scan.
  /// \param last_beam  pose of the laser at the last beam, seen from the first one
  /// \return whether it is one
  /// \throws std::invalid_argument if it is not later than the last key scan, as
  /// LaserScan::validate(), or if a pose is not finite
  bool add(const LaserScan& scan,
           const Pose2& map_from_base,
           const Pose2& base_from_laser,
           const Pose2& last_beam = {});

  /// Moves the kept scans to where they were taken by a corrected trajectory of the base. Scans
  /// before its start stay; scans after its end move rigidly with the last one inside. \return how
  /// many scans moved \throws std::invalid_argument as validate(Trajectory)
  int correct(const Trajectory& map_from_base);

  /// Called for a scan that cannot be drawn because of its pose or the map's size limit.
  using DrawFailure = std::function<void(std::int64_t stamp_ns, const std::exception& error)>;
  /// Draws new scans, and moved ones again. A new scan that cannot be drawn is forgotten, a moved
  /// one stays where it was drawn. \return what became of the beams of new scans
  BeamCounts draw(const DrawFailure& onFailure = {});

  /// As draw() left it.
  const OccupancyMapper& mapper() const { return mapper_; }
  std::size_t scanCount() const { return scans_.size(); }
  /// Scans that are in the map but no longer kept, so that no correction moves them.
  std::size_t settledCount() const { return settled_count_; }

private:
  /// Where a scan was taken.
  struct Placement {
    Pose2 map_from_laser;
    Pose2 last_beam;
  };
  struct KeyScan {
    LaserScan scan;
    Pose2 base_from_laser;
    Placement wanted;
    std::optional<Placement> drawn;  ///< none: not in the map yet
  };

  /// \return false if it is not in the map afterwards
  bool draw(KeyScan& key, BeamCounts& counts, const DrawFailure& onFailure);

  OccupancyMapperParameters parameters_;
  OccupancyMapper mapper_;
  std::deque<KeyScan> scans_;
  std::size_t settled_count_ = 0;
};

}  // namespace ram_slam
