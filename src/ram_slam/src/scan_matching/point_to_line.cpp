// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/point_to_line.hpp"

#include <algorithm>
#include <cmath>

namespace ram_slam {
namespace {

constexpr std::int32_t kMaxSearchBeams = 12;

/// atan2 to 2e-4 rad: enough to find a beam, three times as fast.
float roughBearing(float y, float x) {
  const float ax = std::abs(x);
  const float ay = std::abs(y);
  const float ratio = std::min(ax, ay) / std::max(std::max(ax, ay), 1e-12F);
  const float square = ratio * ratio;
  float angle =
      ((-0.0464964749F * square + 0.15931422F) * square - 0.327622764F) * square * ratio + ratio;
  if (ay > ax) angle = static_cast<float>(M_PI_2) - angle;
  if (x < 0.0F) angle = static_cast<float>(M_PI) - angle;
  return y < 0.0F ? -angle : angle;
}

/// Finds the points of a scan near a place from the beam that looks there.
class BeamIndex {
public:
  explicit BeamIndex(const SurfaceScan& scan)
      : scan_(scan),
        beam_count_(static_cast<std::int32_t>(scan.point_of_beam.size())),
        angle_min_(static_cast<float>(scan.angle_min_rad)),
        inverse_increment_(static_cast<float>(1.0 / scan.angle_increment_rad)),
        beams_per_turn_(static_cast<float>(2.0 * M_PI * std::abs(1.0 / scan.angle_increment_rad))) {
  }

  /// The beam that looks towards a place, or -1 if none does.
  std::int32_t beamTowards(float x_m, float y_m) const {
    float beam = (roughBearing(y_m, x_m) - angle_min_) * inverse_increment_ + 0.5F;
    if (beam < 0.0F) beam += beams_per_turn_;
    if (beam >= static_cast<float>(beam_count_) && beam >= beams_per_turn_) beam -= beams_per_turn_;
    const auto index = static_cast<std::int32_t>(beam);
    return beam >= 0.0F && index < beam_count_ ? index : -1;
  }

  /// The nearest point within `max_distance_m` among the beams beside `beam`, or null.
  const SurfacePoint* nearest(std::int32_t beam, float x_m, float y_m, float max_distance_m) const {
    const float range_m = std::sqrt(x_m * x_m + y_m * y_m);
    const float reach = max_distance_m * std::abs(inverse_increment_) / std::max(range_m, 0.05F);
    const auto reach_beams =
        1 + static_cast<std::int32_t>(std::min(reach, static_cast<float>(kMaxSearchBeams)));
    const auto point_count = static_cast<std::int32_t>(scan_.points.size());
    const std::int32_t begin =
        scan_.point_of_beam[static_cast<std::size_t>(std::max(beam - reach_beams, 0))];
    const std::int32_t last_beam = beam + reach_beams + 1;
    const std::int32_t end = last_beam < beam_count_
                                 ? scan_.point_of_beam[static_cast<std::size_t>(last_beam)]
                                 : point_count;
    float least = max_distance_m * max_distance_m;
    const SurfacePoint* best = nullptr;
    for (std::int32_t i = begin; i < end; ++i) {
      const SurfacePoint& point = scan_.points[static_cast<std::size_t>(i)];
      const float dx = point.x_m - x_m;
      const float dy = point.y_m - y_m;
      const float squared = dx * dx + dy * dy;
      if (squared < least) {
        least = squared;
        best = &point;
      }
    }
    return best;
  }

private:
  const SurfaceScan& scan_;
  std::int32_t beam_count_;
  float angle_min_;
  float inverse_increment_;
  float beams_per_turn_;
};

}  // namespace

PointToLineSum sumPointToLine(const SurfaceScan& target,
                              const SurfaceScan& source,
                              const Pose2& target_from_source,
                              const PairingLimits& limits) {
  const BeamIndex index(target);
  const auto cosine = static_cast<float>(std::cos(target_from_source.yaw_rad));
  const auto sine = static_cast<float>(std::sin(target_from_source.yaw_rad));
  const auto shift_x = static_cast<float>(target_from_source.x_m);
  const auto shift_y = static_cast<float>(target_from_source.y_m);
  const auto max_distance_m = static_cast<float>(limits.max_distance_m);
  const auto min_cosine = static_cast<float>(limits.min_normal_cosine);
  const auto inverse_scale2 =
      static_cast<float>(1.0 / (limits.robust_scale_m * limits.robust_scale_m));

  PointToLineSum sum;
  float xx = 0.0F, xy = 0.0F, yy = 0.0F, xa = 0.0F, ya = 0.0F, aa = 0.0F;
  float gx = 0.0F, gy = 0.0F, ga = 0.0F, cost = 0.0F, weight_sum = 0.0F;
  for (std::size_t i = 0; i < source.points.size(); i += limits.point_stride) {
    const SurfacePoint& point = source.points[i];
    if (!point.hasNormal()) continue;
    const float rotated_x = cosine * point.x_m - sine * point.y_m;
    const float rotated_y = sine * point.x_m + cosine * point.y_m;
    const float x_m = rotated_x + shift_x;
    const float y_m = rotated_y + shift_y;
    const std::int32_t beam = index.beamTowards(x_m, y_m);
    if (beam < 0) continue;
    ++sum.visible_count;
    const SurfacePoint* partner = index.nearest(beam, x_m, y_m, max_distance_m);
    if (partner == nullptr || !partner->hasNormal()) continue;
    const float nx = partner->normal_x;
    const float ny = partner->normal_y;
    const float normal_x = cosine * point.normal_x - sine * point.normal_y;
    const float normal_y = sine * point.normal_x + cosine * point.normal_y;
    if (nx * normal_x + ny * normal_y < min_cosine) continue;
    const float residual = nx * (x_m - partner->x_m) + ny * (y_m - partner->y_m);
    const float lever = ny * rotated_x - nx * rotated_y;
    const float weight = 1.0F / (1.0F + residual * residual * inverse_scale2);
    const float wx = weight * nx;
    const float wy = weight * ny;
    const float wa = weight * lever;
    xx += wx * nx;
    xy += wx * ny;
    yy += wy * ny;
    xa += wx * lever;
    ya += wy * lever;
    aa += wa * lever;
    gx += wx * residual;
    gy += wy * residual;
    ga += wa * residual;
    cost += weight * residual * residual;
    weight_sum += weight;
    ++sum.pair_count;
  }
  sum.information << xx, xy, xa, xy, yy, ya, xa, ya, aa;
  sum.gradient << gx, gy, ga;
  sum.cost_m2 = cost;
  sum.weight = weight_sum;
  return sum;
}

}  // namespace ram_slam
