// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "ramscout_sim/random.hpp"

namespace ramscout_sim {
namespace {

constexpr int kMaxBeams = 20000;

void require(bool condition, const char* parameter, double value, const char* bound) {
  if (!condition) {
    throw std::invalid_argument(std::string("lidar.") + parameter + " must be " + bound + ", got " +
                                std::to_string(value));
  }
}

/// Data sheets' values where they state any; the noise is a Gaussian within the stated accuracy.
LidarParameters preset(const std::string& name) {
  LidarParameters p;
  if (name == "utm_30lx") return p;
  p.far_range_sigma_m = 0.0;
  if (name == "urg_04lx") {  // steps 44 to 725 of 1024 a turn, 100 ms a turn
    p.beams = 682;
    p.angle_max_rad = 341 * 2.0 * M_PI / 1024;
    p.angle_min_rad = -340 * 2.0 * M_PI / 1024;
    p.scan_rate_hz = 10.0;
    p.time_increment_s = 0.1 / 1024;
    p.range_min_m = 0.02;
    p.range_max_m = 5.6;
    p.range_sigma_m = 0.01;
    p.range_sigma_per_m = 0.01;
  } else if (name == "sick_lms") {  // LMS 200, half degree
    p.beams = 361;
    p.angle_min_rad = -M_PI_2;
    p.angle_max_rad = M_PI_2;
    p.scan_rate_hz = 37.5;
    p.time_increment_s = 1.0 / 75.0 / 720.0;
    p.range_min_m = 0.05;
    p.range_max_m = 80.0;
    p.range_sigma_m = 0.005;
    p.range_resolution_m = 0.01;
  } else if (name == "rplidar_a2") {
    p.beams = 360;
    p.angle_min_rad = -M_PI;
    p.angle_max_rad = M_PI - 2.0 * M_PI / 360;
    p.scan_rate_hz = 10.0;
    p.time_increment_s = 0.1 / 360;
    p.range_min_m = 0.15;
    p.range_max_m = 12.0;
    p.range_sigma_m = 0.01;
    p.range_sigma_per_m = 0.01;
  } else {
    throw std::invalid_argument(
        "lidar.preset must be utm_30lx, urg_04lx, sick_lms or rplidar_a2, got '" + name + "'");
  }
  return p;
}

}  // namespace

void LidarParameters::validate() const {
  require(beams >= 2 && beams <= kMaxBeams, "beams", beams, "2 to 20000");
  require(angle_min_rad >= -2.0 * M_PI, "angle_min_rad", angle_min_rad, ">= -2 pi");
  require(angle_max_rad > angle_min_rad, "angle_max_rad", angle_max_rad, "> angle_min_rad");
  require(angle_max_rad - angle_min_rad <= 2.0 * M_PI, "angle_max_rad", angle_max_rad,
          "at most a turn after angle_min_rad");
  require(scan_rate_hz > 0.0 && scan_rate_hz <= 1000.0, "scan_rate_hz", scan_rate_hz,
          "in (0, 1000]");
  require(time_increment_s >= 0.0 && sweep_s() <= 1.0 / scan_rate_hz, "time_increment_s",
          time_increment_s, ">= 0 and so small that a sweep fits between two scans");
  require(range_min_m >= 0.0, "range_min_m", range_min_m, ">= 0");
  require(range_max_m > range_min_m, "range_max_m", range_max_m, "> range_min_m");
  require(range_sigma_m >= 0.0, "range_sigma_m", range_sigma_m, ">= 0");
  require(range_sigma_per_m >= 0.0 && range_sigma_per_m < 1.0, "range_sigma_per_m",
          range_sigma_per_m, "in [0, 1)");
  require(far_range_sigma_m >= 0.0, "far_range_sigma_m", far_range_sigma_m, ">= 0");
  require(far_range_m >= 0.0, "far_range_m", far_range_m, ">= 0");
  require(range_bias_sigma_m >= 0.0, "range_bias_sigma_m", range_bias_sigma_m, ">= 0");
  require(range_resolution_m >= 0.0 && range_resolution_m < 1.0, "range_resolution_m",
          range_resolution_m, "in [0, 1)");
  require(outlier_probability >= 0.0 && outlier_probability <= 1.0, "outlier_probability",
          outlier_probability, "in [0, 1]");
}

LidarParameters readLidarParameters(ram_parameters::ParameterReader& reader) {
  std::string preset_name = "utm_30lx";
  reader.read("preset", preset_name);
  LidarParameters p = preset(preset_name);
  reader.read("beams", p.beams);
  reader.read("angle_min_rad", p.angle_min_rad);
  reader.read("angle_max_rad", p.angle_max_rad);
  reader.read("scan_rate_hz", p.scan_rate_hz);
  reader.read("time_increment_s", p.time_increment_s);
  reader.read("range_min_m", p.range_min_m);
  reader.read("range_max_m", p.range_max_m);
  reader.read("range_sigma_m", p.range_sigma_m);
  reader.read("range_sigma_per_m", p.range_sigma_per_m);
  reader.read("far_range_sigma_m", p.far_range_sigma_m);
  reader.read("far_range_m", p.far_range_m);
  reader.read("range_bias_sigma_m", p.range_bias_sigma_m);
  reader.read("range_resolution_m", p.range_resolution_m);
  reader.read("outlier_probability", p.outlier_probability);
  reader.rejectUnknown();
  p.validate();
  return p;
}

Lidar::Lidar(const LidarParameters& parameters, std::uint64_t seed)
    : parameters_((parameters.validate(), parameters)),
      seed_(seed),
      range_bias_m_(parameters.range_bias_sigma_m * Random(seed, Stream::kLidarBias).gaussian()) {
  for (int beam = 0; beam < parameters_.beams; ++beam) {
    const double bearing_rad = parameters_.angle_min_rad + beam * parameters_.angleIncrement_rad();
    directions_in_laser_.emplace_back(std::cos(bearing_rad), std::sin(bearing_rad), 0.0);
  }
}

std::vector<Ray> Lidar::rays(std::int64_t stamp_ns, const SensorPath& path) const {
  std::vector<Ray> rays(directions_in_laser_.size());
  std::size_t before = 0;  // the sample at or before the beam
  for (std::size_t beam = 0; beam < rays.size(); ++beam) {
    const double beam_ns = static_cast<double>(beam) * parameters_.time_increment_s * 1e9;
    const std::int64_t time_ns = stamp_ns + std::llround(beam_ns);
    while (before + 1 < path.stamps_ns.size() && path.stamps_ns[before + 1] <= time_ns) ++before;
    const std::size_t after = std::min(before + 1, path.stamps_ns.size() - 1);
    const std::int64_t gap_ns = path.stamps_ns[after] - path.stamps_ns[before];
    const double share = gap_ns > 0
                             ? std::clamp(static_cast<double>(time_ns - path.stamps_ns[before]) /
                                              static_cast<double>(gap_ns),
                                          0.0, 1.0)
                             : 0.0;
    const Eigen::Isometry3d& a = path.world_from_laser[before];
    const Eigen::Isometry3d& b = path.world_from_laser[after];
    const Eigen::Vector3d& d = directions_in_laser_[beam];
    const Eigen::Vector3d direction = (1.0 - share) * (a.linear() * d) + share * (b.linear() * d);
    rays[beam].origin_m = ((1.0 - share) * a.translation() + share * b.translation()).cast<float>();
    rays[beam].direction = direction.normalized().cast<float>();
  }
  return rays;
}

Scan Lidar::measure(std::int64_t stamp_ns,
                    std::uint64_t scan_index,
                    const SensorPath& path,
                    const RayCaster& world) const {
  Scan scan;
  scan.stamp_ns = stamp_ns;
  scan.ranges_m = world.cast(rays(stamp_ns, path));
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    scan.ranges_m[beam] = toReading(scan.ranges_m[beam], scan_index * kMaxBeams + beam);
  }
  return scan;
}

float Lidar::toReading(double true_range_m, std::uint64_t reading_index) const {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const LidarParameters& p = parameters_;
  if (!(true_range_m <= p.range_max_m)) return kInfinity;
  double range_m = true_range_m;
  if (p.outlier_probability > 0.0) {
    Random random(seed_, Stream::kOutlier, reading_index);
    if (random.uniform() < p.outlier_probability) range_m = random.uniform(0.0, true_range_m);
  }
  const double sigma_m = std::max({p.range_sigma_m, p.range_sigma_per_m * range_m,
                                   range_m >= p.far_range_m ? p.far_range_sigma_m : 0.0});
  if (sigma_m > 0.0) range_m += sigma_m * Random(seed_, Stream::kRange, reading_index).gaussian();
  range_m += range_bias_m_;
  if (p.range_resolution_m > 0.0)
    range_m = std::round(range_m / p.range_resolution_m) * p.range_resolution_m;
  if (range_m < p.range_min_m) return -kInfinity;
  if (range_m > p.range_max_m) return kInfinity;
  return static_cast<float>(range_m);
}

}  // namespace ramscout_sim
