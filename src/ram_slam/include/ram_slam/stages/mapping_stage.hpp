// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/occupancy/key_scan_map.hpp"
#include "ram_slam/stages/clock_guard.hpp"
#include "ram_slam/stages/scan_synchroniser.hpp"
#include "ram_slam/stages/tracking_gate.hpp"

namespace ram_slam {

/// From scans and poses to the occupancy map: decides which scans are drawn, and draws them again
/// where a corrected trajectory moved them. What a lost robot sees is not drawn. Drawing waits
/// until the map is asked for.
class MappingStage {
public:
  /// \param loaded  scans of a map made before; if there are any it is continued, once the robot's
  /// place in it is known (set())
  /// \throws std::invalid_argument as OccupancyMapperParameters::validate(), or std::length_error
  /// if that map is too large
  explicit MappingStage(const OccupancyMapperParameters& parameters,
                        std::vector<PlacedScan> loaded = {});

  /// Takes a scan in, if the laser has moved far enough since the last one. Begins again with an
  /// empty map if the clock was set back.
  /// \param last_beam  the laser at the last beam, seen from the laser at the first one
  void add(const MountedScan& scan, const Pose2& map_from_base, const Pose2& last_beam);
  /// The robot came to be lost, or was found. What was drawn while it may have been lost is taken
  /// out. \return how many scans
  int set(const Tracking& tracking);
  /// Moves scans to where a corrected trajectory of the base has them.
  /// \return how many moved \throws std::invalid_argument as validate(Trajectory)
  int correct(const Trajectory& map_from_base) { return map_.correct(map_from_base); }
  /// Draws what is not drawn, or not where it belongs. \return what became of the beams of newly
  /// drawn scans
  BeamCounts draw();
  /// Begins again with an empty map, or the one that is continued.
  void reset();

  /// As draw() left it.
  const OccupancyMapper& mapper() const { return map_.mapper(); }
  std::size_t scanCount() const { return map_.scanCount(); }
  /// As KeyScanMap::scans().
  std::vector<PlacedScan> scans() const { return map_.scans(); }
  std::size_t settledCount() const { return map_.settledCount(); }
  int resetCount() const { return reset_count_; }
  const DropCounter& drops() const { return drops_; }
  DropCounter& drops() { return drops_; }

private:
  OccupancyMapperParameters parameters_;
  KeyScanMap map_;
  ClockGuard clock_;
  TrackingGate gate_;
  int reset_count_ = 0;
  DropCounter drops_;
};

}  // namespace ram_slam
