// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/point_to_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "ram_slam/sensing/beam_finder.hpp"

namespace ram_slam {
namespace {

constexpr float kMaxSearchBeams = 12.0F;
constexpr std::size_t kBlock = 64;

/// Points of the source that lie on lines, turned into the target's axes and looked up, a block at
/// a time: column by column, so that the compiler works on several at once.
struct Block {
  std::size_t count = 0;
  std::array<SurfacePoint, kBlock> source;
  std::array<float, kBlock> rotated_x, rotated_y, x_m, y_m;
  std::array<std::int32_t, kBlock> beam;         ///< that looks towards the point, or -1
  std::array<std::int32_t, kBlock> reach_beams;  ///< to search on both sides

  /// Takes points from `next` on, until it is full. \returns where the next block begins
  std::size_t take(const SurfaceScan& scan, std::size_t next, std::size_t stride) {
    count = 0;
    for (; next < scan.points.size() && count < kBlock; next += stride) {
      if (scan.points[next].hasNormal()) source[count++] = scan.points[next];
    }
    return next;
  }
};

/// The nearest point within `max_distance_m` among the beams beside the one that looks there, or
/// null.
const SurfacePoint* nearest(const SurfaceScan& scan,
                            const Block& block,
                            std::size_t index,
                            float max_distance_m) {
  const auto beam_count = static_cast<std::int32_t>(scan.point_of_beam.size());
  const std::int32_t first_beam = std::max(block.beam[index] - block.reach_beams[index], 0);
  const std::int32_t last_beam = block.beam[index] + block.reach_beams[index] + 1;
  const SurfacePoint* point =
      scan.points.data() + scan.point_of_beam[static_cast<std::size_t>(first_beam)];
  const SurfacePoint* const end =
      scan.points.data() + (last_beam < beam_count
                                ? scan.point_of_beam[static_cast<std::size_t>(last_beam)]
                                : static_cast<std::int32_t>(scan.points.size()));
  float least = max_distance_m * max_distance_m;
  const SurfacePoint* best = nullptr;
  for (; point != end; ++point) {
    const float dx = point->x_m - block.x_m[index];
    const float dy = point->y_m - block.y_m[index];
    const float squared = dx * dx + dy * dy;
    best = squared < least ? point : best;
    least = std::min(squared, least);
  }
  return best;
}

}  // namespace

PointToLineSum sumPointToLine(const SurfaceScan& target,
                              const SurfaceScan& source,
                              const Pose2& target_from_source,
                              const PairingLimits& limits) {
  const BeamFinder finder(target.angle_min_rad, target.angle_increment_rad,
                          target.point_of_beam.size());
  const auto cosine = static_cast<float>(std::cos(target_from_source.yaw_rad));
  const auto sine = static_cast<float>(std::sin(target_from_source.yaw_rad));
  const auto shift_x = static_cast<float>(target_from_source.x_m);
  const auto shift_y = static_cast<float>(target_from_source.y_m);
  const auto max_distance_m = static_cast<float>(limits.max_distance_m);
  const auto min_cosine = static_cast<float>(limits.min_normal_cosine);
  const auto inverse_scale2 =
      static_cast<float>(1.0 / (limits.robust_scale_m * limits.robust_scale_m));

  const auto beams_per_rad = static_cast<float>(1.0 / std::abs(target.angle_increment_rad));
  const float reach = max_distance_m * beams_per_rad;

  PointToLineSum sum;
  float xx = 0.0F, xy = 0.0F, yy = 0.0F, xa = 0.0F, ya = 0.0F, aa = 0.0F;
  float gx = 0.0F, gy = 0.0F, ga = 0.0F, cost = 0.0F, weight_sum = 0.0F;
  Block block;
  for (std::size_t next = 0; next < source.points.size();) {
    next = block.take(source, next, limits.point_stride);
    for (std::size_t i = 0; i < block.count; ++i) {
      const SurfacePoint& point = block.source[i];
      block.rotated_x[i] = cosine * point.x_m - sine * point.y_m;
      block.rotated_y[i] = sine * point.x_m + cosine * point.y_m;
      const float x_m = block.rotated_x[i] + shift_x;
      const float y_m = block.rotated_y[i] + shift_y;
      const float range_m = std::max(std::sqrt(x_m * x_m + y_m * y_m), 0.05F);
      block.x_m[i] = x_m;
      block.y_m[i] = y_m;
      block.beam[i] = finder.beamTowards(x_m, y_m);
      block.reach_beams[i] =
          1 + static_cast<std::int32_t>(std::min(reach / range_m, kMaxSearchBeams));
    }
    for (std::size_t i = 0; i < block.count; ++i) {
      if (block.beam[i] < 0) continue;
      ++sum.visible_count;
      const SurfacePoint* partner = nearest(target, block, i, max_distance_m);
      if (partner == nullptr || !partner->hasNormal()) continue;
      const float nx = partner->normal_x;
      const float ny = partner->normal_y;
      const float normal_x = cosine * block.source[i].normal_x - sine * block.source[i].normal_y;
      const float normal_y = sine * block.source[i].normal_x + cosine * block.source[i].normal_y;
      if (nx * normal_x + ny * normal_y < min_cosine) continue;
      const float residual =
          nx * (block.x_m[i] - partner->x_m) + ny * (block.y_m[i] - partner->y_m);
      const float lever = ny * block.rotated_x[i] - nx * block.rotated_y[i];
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
  }
  sum.information << xx, xy, xa, xy, yy, ya, xa, ya, aa;
  sum.gradient << gx, gy, ga;
  sum.cost_m2 = cost;
  sum.weight = weight_sum;
  return sum;
}

}  // namespace ram_slam
