// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ramscout_sim/lidar_effects.hpp"
#include "ramscout_sim/random.hpp"

namespace ramscout_sim {

Lidar::Lidar(const LidarParameters& parameters, std::uint64_t seed)
    : parameters_((parameters.validate(), parameters)),
      seed_(seed),
      range_bias_m_(parameters.range_bias_sigma_m * Random(seed, Stream::kLidarBias).gaussian()),
      directions_in_laser_(parameters.beams, 2) {
  for (int beam = 0; beam < parameters_.beams; ++beam) {
    const double bearing_rad = parameters_.angle_min_rad + beam * parameters_.angleIncrement_rad();
    directions_in_laser_(beam, 0) = static_cast<float>(std::cos(bearing_rad));
    directions_in_laser_(beam, 1) = static_cast<float>(std::sin(bearing_rad));
    beam_offsets_ns_.push_back(std::llround(beam * parameters_.time_increment_s * 1e9));
  }
}

Rays Lidar::rays(std::int64_t stamp_ns, const SensorPath& path) const {
  const Eigen::Index count = directions_in_laser_.rows();
  Rays rays(static_cast<std::size_t>(count));
  Eigen::Index first = 0;
  for (std::size_t sample = 0; first < count; ++sample) {
    Eigen::Index last = count;
    if (sample + 1 < path.stamps_ns.size()) {  // the beams before the next sample
      last = std::lower_bound(beam_offsets_ns_.begin() + first, beam_offsets_ns_.end(),
                              path.stamps_ns[sample + 1] - stamp_ns) -
             beam_offsets_ns_.begin();
    }
    if (last > first) interpolate(path, sample, stamp_ns, {first, last}, rays);
    first = last;
  }
  return rays;
}

/// The beams between a sample of the path and the next.
void Lidar::interpolate(const SensorPath& path,
                        std::size_t sample,
                        std::int64_t stamp_ns,
                        BeamRange beams,
                        Rays& rays) const {
  const auto [first, last] = beams;
  const std::size_t next = std::min(sample + 1, path.stamps_ns.size() - 1);
  const Eigen::Matrix<float, 3, 4> at =
      path.world_from_laser[sample].matrix().topRows<3>().cast<float>();
  const Eigen::Matrix<float, 3, 4> change =
      (path.world_from_laser[next].matrix() - path.world_from_laser[sample].matrix())
          .topRows<3>()
          .cast<float>();
  const double gap_ns =
      static_cast<double>(std::max<std::int64_t>(1, path.stamps_ns[next] - path.stamps_ns[sample]));
  const Eigen::Index count = last - first;
  const double begin_ns = static_cast<double>(
      stamp_ns + beam_offsets_ns_[static_cast<std::size_t>(first)] - path.stamps_ns[sample]);
  const Eigen::ArrayXf share =
      Eigen::ArrayXf::LinSpaced(count, 0.0F, static_cast<float>(count - 1)) *
          static_cast<float>(parameters_.time_increment_s * 1e9 / gap_ns) +
      static_cast<float>(begin_ns / gap_ns);
  const Eigen::ArrayXf s = share.max(0.0F).min(1.0F);
  const auto along = directions_in_laser_.col(0).segment(first, count);
  const auto across = directions_in_laser_.col(1).segment(first, count);
  Eigen::ArrayX3f directions(count, 3);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    directions.col(axis) =
        (at(axis, 0) + s * change(axis, 0)) * along + (at(axis, 1) + s * change(axis, 1)) * across;
    rays.origins_m.col(axis).segment(first, count).array() = at(axis, 3) + s * change(axis, 3);
  }
  const Eigen::ArrayXf length = directions.square().rowwise().sum().sqrt();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    rays.directions.col(axis).segment(first, count).array() = directions.col(axis) / length;
  }
}

Scan Lidar::measure(std::int64_t stamp_ns,
                    std::uint64_t scan_index,
                    const SensorPath& path,
                    const RayCaster& world,
                    const std::vector<Solid>& moving) const {
  Scan scan;
  scan.stamp_ns = stamp_ns;
  const Rays beams = rays(stamp_ns, path);
  const std::vector<BeamWindow> windows =
      moving.empty() ? std::vector<BeamWindow>() : windowsOf(moving, path);
  if (needsEffects(parameters_, world, moving)) {
    scan.ranges_m =
        illuminate({beams, world, moving, windows}, parameters_, seed_, scan_index * kMaxBeams);
  } else {
    scan.ranges_m = world.cast(beams, static_cast<float>(parameters_.range_max_m));
    castMoving(beams, moving, windows, scan.ranges_m);
  }
  if (parameters_.outlier_probability > 0.0) addOutliers(scan.ranges_m, scan_index);
  toReadings(scan.ranges_m, scan_index);
  return scan;
}

void Lidar::addOutliers(std::vector<float>& ranges_m, std::uint64_t scan_index) const {
  for (std::size_t beam = 0; beam < ranges_m.size(); ++beam) {
    if (!(ranges_m[beam] <= parameters_.range_max_m)) continue;
    Random random(seed_, Stream::kOutlier, scan_index * kMaxBeams + beam);
    if (random.uniform() < parameters_.outlier_probability)
      ranges_m[beam] = static_cast<float>(random.uniform(0.0, ranges_m[beam]));
  }
}

/// Of all beams of a scan.
double Lidar::bias_m(std::uint64_t scan_index) const {
  const double running_s = static_cast<double>(scan_index) / parameters_.scan_rate_hz;
  return range_bias_m_ +
         parameters_.warm_up_drift_m * std::exp(-running_s / parameters_.warm_up_time_s);
}

/// Adds noise and bias, rounds and replaces what is out of range by infinity.
void Lidar::toReadings(std::vector<float>& ranges_m, std::uint64_t scan_index) const {
  const double infinity = std::numeric_limits<double>::infinity();
  // Adding it leaves no bit for fractions: what comes out is rounded to a whole number.
  constexpr double kRounder = 0x1.8p52;
  const LidarParameters p = parameters_;  // a copy: the compiler then makes vector code
  const double bias_m = this->bias_m(scan_index);
  float* const ranges = ranges_m.data();
  const std::vector<float> noise =
      gaussians(Random(seed_, Stream::kRange, scan_index), ranges_m.size());
  const double steps_per_m = p.range_resolution_m > 0.0 ? 1.0 / p.range_resolution_m : 0.0;
  const std::size_t count = ranges_m.size();
  for (std::size_t beam = 0; beam < count; ++beam) {
    const double true_m = std::min(static_cast<double>(ranges[beam]), p.range_max_m);
    const double far_sigma_m = true_m >= p.far_range_m ? p.far_range_sigma_m : 0.0;
    const double sigma_m =
        std::max(std::max(p.range_sigma_m, p.range_sigma_per_m * true_m), far_sigma_m);
    const double range_m = true_m + sigma_m * noise[beam] + bias_m;
    const double rounded_m = (range_m * steps_per_m + kRounder - kRounder) * p.range_resolution_m;
    const double reading_m = steps_per_m > 0.0 ? rounded_m : range_m;
    const double low_m = reading_m < p.range_min_m ? -infinity : reading_m;
    const double high_m = low_m > p.range_max_m ? infinity : low_m;
    ranges[beam] = static_cast<float>(ranges[beam] > p.range_max_m ? infinity : high_m);
  }
}

/// Each solid's bounding circle as seen in the laser's plane from somewhere on the path.
std::vector<BeamWindow> Lidar::windowsOf(const std::vector<Solid>& moving,
                                         const SensorPath& path) const {
  const Eigen::Isometry3d& first = path.world_from_laser.front();
  const Eigen::Isometry3d& last = path.world_from_laser.back();
  const double travel_m = (last.translation() - first.translation()).norm();
  const double turn_rad = Eigen::AngleAxisd(first.linear().transpose() * last.linear()).angle();
  const double increment_rad = parameters_.angleIncrement_rad();
  std::vector<BeamWindow> windows;
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const Eigen::Vector3d center =
        first.inverse(Eigen::Isometry) * moving[i].world_from_solid.translation();
    const double radius_m = 0.5 * moving[i].size_m.norm() + travel_m;
    const double distance_m = center.head<2>().norm();
    if (std::abs(center.z()) > radius_m + distance_m * std::sin(turn_rad)) continue;
    if (distance_m - radius_m > parameters_.range_max_m) continue;
    const double half_rad =
        distance_m > radius_m ? std::asin(radius_m / distance_m) + turn_rad : M_PI;
    const double bearing_rad = std::atan2(center.y(), center.x());
    for (const double turns_rad : {-2.0 * M_PI, 0.0, 2.0 * M_PI}) {
      const double low = (bearing_rad + turns_rad - half_rad - parameters_.angle_min_rad);
      const double high = (bearing_rad + turns_rad + half_rad - parameters_.angle_min_rad);
      const double beams = parameters_.beams;
      const double begin = std::clamp(std::floor(low / increment_rad), 0.0, beams);
      const double end = std::clamp(std::ceil(high / increment_rad) + 1.0, 0.0, beams);
      if (begin < end)
        windows.push_back({i, static_cast<std::size_t>(begin), static_cast<std::size_t>(end)});
    }
  }
  return windows;
}

}  // namespace ramscout_sim
