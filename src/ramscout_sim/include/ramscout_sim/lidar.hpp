// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "ram_parameters/parameter_reader.hpp"
#include "ramscout_sim/moving_solids.hpp"
#include "ramscout_sim/ray_caster.hpp"

namespace ramscout_sim {

/// A planar lidar; defaults are a Hokuyo UTM-30LX.
struct LidarParameters {
  int beams = 1081;
  double angle_min_rad = -2.35619449;
  double angle_max_rad = 2.35619449;
  double scan_rate_hz = 40.0;
  /// From one beam to the next; 0: all beams at once.
  double time_increment_s = 1.7361111e-5;
  double range_min_m = 0.1;
  double range_max_m = 30.0;
  /// Standard deviation of a range: the largest of the three.
  double range_sigma_m = 0.01;
  double range_sigma_per_m = 0.0;
  double far_range_sigma_m = 0.03;  ///< holds from far_range_m on
  double far_range_m = 10.0;
  /// Standard deviation of an error that all beams share and that stays for a run.
  double range_bias_sigma_m = 0.0;
  /// Of a lidar that was switched on when the simulation began: all ranges are this much too long,
  /// and the error dies away with the time constant.
  double warm_up_drift_m = 0.0;
  double warm_up_time_s = 600.0;
  /// Ranges are multiples of it; 0: not rounded.
  double range_resolution_m = 0.001;
  /// Chance of a reading anywhere before the surface.
  double outlier_probability = 0.0;
  /// At which a white wall (reflectivity 0.9) that is hit head-on answers every other time; the
  /// chance depends on reflectivity * cos(incidence) / range^2. 0: every surface always answers.
  double half_detection_range_m = 0.0;
  /// Half the angle that the beam's footprint covers along the scan; 0: beams are lines.
  double beam_divergence_rad = 0.0;
  /// Echoes of one beam that are less apart merge into one between them (a mixed pixel); of others
  /// the strongest counts.
  double pulse_length_m = 0.3;

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
  double angleIncrement_rad() const { return (angle_max_rad - angle_min_rad) / (beams - 1); }
  /// From the first to the last beam.
  double sweep_s() const { return time_increment_s * (beams - 1); }
};

/// Reads key `preset` (utm_30lx, urg_04lx, sick_lms, sick_lms_180, rplidar_a2), then every other
/// key as in LidarParameters, which overrides the preset.
LidarParameters readLidarParameters(ram_parameters::ParameterReader& reader);

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
  void interpolate(const SensorPath& path,
                   std::size_t sample,
                   std::int64_t stamp_ns,
                   Eigen::Index first,
                   Eigen::Index last,
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
