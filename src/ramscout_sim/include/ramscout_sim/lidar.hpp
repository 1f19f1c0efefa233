// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "ramscout_sim/lidar_parameters.hpp"
#include "ramscout_sim/moving_solids.hpp"
#include "ramscout_sim/ray_caster.hpp"

namespace ramscout_sim {

/// What the lidar measured; beam i points to angle_min_rad + i * angleIncrement_rad().
struct Scan {
  std::int64_t stamp_ns = 0;  ///< of the first beam
  /// REP 117: +Inf nothing in range, -Inf nearer than range_min_m.
  std::vector<float> ranges_m;
};

/// Poses that a moving sensor had, in order of time, not empty.
struct SensorPath {
  std::vector<std::int64_t> stamps_ns;
  std::vector<Eigen::Isometry3d> world_from_laser;
};

class Lidar {
public:
  /// \throws std::invalid_argument from LidarParameters::validate
  Lidar(const LidarParameters& parameters, std::uint64_t seed);

  const LidarParameters& parameters() const { return parameters_; }

  /// One scan. Each beam starts where the sensor is at its own moment; between two samples of the
  /// path position and direction are interpolated linearly.
  ///
  /// \param scan_index  keys the noise: same index, same noise
  /// \param moving  solids that the world does not hold, where they are when the beams pass them
  Scan measure(std::int64_t stamp_ns,
               std::uint64_t scan_index,
               const SensorPath& path,
               const RayCaster& world,
               const std::vector<Solid>& moving = {}) const;

  /// The rays of a scan, in world axes.
  Rays rays(std::int64_t stamp_ns, const SensorPath& path) const;

private:
  /// Beams of a scan from `first` on, `last` not included.
  struct BeamRange {
    Eigen::Index first = 0;
    Eigen::Index last = 0;
  };
  void interpolate(const SensorPath& path,
                   std::size_t sample,
                   std::int64_t stamp_ns,
                   BeamRange beams,
                   Rays& rays) const;
  void addOutliers(std::vector<float>& ranges_m, std::uint64_t scan_index) const;
  double bias_m(std::uint64_t scan_index) const;
  void toReadings(std::vector<float>& ranges_m, std::uint64_t scan_index) const;
  std::vector<BeamWindow> windowsOf(const std::vector<Solid>& moving, const SensorPath& path) const;

  LidarParameters parameters_;
  std::uint64_t seed_;
  double range_bias_m_;
  std::vector<std::int64_t> beam_offsets_ns_;
  Eigen::ArrayX2f directions_in_laser_;  // in the plane of the beams
};

}  // namespace ramscout_sim
