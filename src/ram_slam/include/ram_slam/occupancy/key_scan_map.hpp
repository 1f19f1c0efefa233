// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <optional>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/occupancy/occupancy_mapper.hpp"
#include "ram_slam/occupancy/occupancy_mapper_parameters.hpp"
#include "ram_slam/sensing/laser_scan.hpp"
#include "ram_slam/sensing/placed_scan.hpp"

namespace ram_slam {

/// An occupancy map of key scans that follows corrections of the trajectory: when poses of the past
/// change, the scans taken there are taken out of the map and put in again where they belong.
///
/// Key scans are the first scan and those before which the laser moved or turned enough; what a
/// robot at rest sees is in the map once. Drawing waits for draw(), so that a scan whose pose
/// changes before anyone asks for the map is drawn once.
class KeyScanMap {
public:
  /// \param loaded  scans of a map made before, which this one continues: they stay where they are
  /// \throws std::invalid_argument as OccupancyMapperParameters::validate(), or std::length_error
  /// as OccupancyMapper::add()
  explicit KeyScanMap(const OccupancyMapperParameters& parameters,
                      std::vector<PlacedScan> loaded = {});

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

  /// Takes out the scans of later stamps than this one; loaded ones and those that are no longer
  /// kept stay. \return how many
  int removeAfter(std::int64_t stamp_ns);

  /// Called for a scan that cannot be drawn because of its pose or the map's size limit.
  using DrawFailure = std::function<void(std::int64_t stamp_ns, const std::exception& error)>;
  /// Draws new scans, and moved ones again. A new scan that cannot be drawn is forgotten, a moved
  /// one stays where it was drawn. \return what became of the beams of new scans
  BeamCounts draw(const DrawFailure& onFailure = {});

  /// As draw() left it.
  const OccupancyMapper& mapper() const { return mapper_; }
  std::size_t scanCount() const { return scans_.size(); }
  const std::vector<PlacedScan>& loaded() const { return loaded_; }
  /// All scans that are kept, where draw() left them: the loaded ones first.
  std::vector<PlacedScan> scans() const;
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
  std::vector<PlacedScan> loaded_;
  std::deque<KeyScan> scans_;
  std::size_t settled_count_ = 0;
};

}  // namespace ram_slam
