// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/point_to_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "ram_slam/sensing/beam_finder.hpp"
#include "ram_slam/sensing/swept_angle.hpp"

namespace ram_slam {
namespace {

/// Points per block: eight vectors of eight floats; the block stays in the first-level cache.
constexpr std::size_t kBlock = 64;

/// target_from_source in single precision.
struct Transform {
  explicit Transform(const Pose2& pose)
      : cosine(static_cast<float>(std::cos(pose.yaw_rad))),
        sine(static_cast<float>(std::sin(pose.yaw_rad))),
        shift_x(static_cast<float>(pose.x_m)),
        shift_y(static_cast<float>(pose.y_m)) {}
  float cosine, sine, shift_x, shift_y;
};

/// Points of the source, turned into the target's axes and looked up, a block at a time: column by
/// column, so that the compiler works on several at once.
// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): place() fills what is used
struct Block {
  std::size_t count = 0;
  std::array<SurfacePoint, kBlock> source;
  std::array<float, kBlock> rotated_x, rotated_y, x_m, y_m;
  std::array<std::int32_t, kBlock> beam;         ///< in the direction of the point, or -1
  std::array<std::int32_t, kBlock> reach_beams;  ///< to search on both sides

  /// Takes points from `next` on, until it is full. \returns where the next block begins
  std::size_t take(const SurfaceScan& scan, std::size_t next, std::size_t stride) {
    count = 0;
    for (; next < scan.points.size() && count < kBlock; next += stride) {
      source[count++] = scan.points[next];
    }
    return next;
  }

  /// Turns the points into the target's axes and finds the beams of the target in their direction.
  /// \param reach  greatest distance of a partner, in beams at a range of 1 m
  void place(const Transform& transform,
             const BeamFinder& finder,
             float reach,
             float max_search_beams) {
    for (std::size_t i = 0; i < count; ++i) {
      const SurfacePoint& point = source[i];
      rotated_x[i] = transform.cosine * point.x_m - transform.sine * point.y_m;
      rotated_y[i] = transform.sine * point.x_m + transform.cosine * point.y_m;
      const float target_x_m = rotated_x[i] + transform.shift_x;
      const float target_y_m = rotated_y[i] + transform.shift_y;
      // Not nearer than 5 cm, so that the quotient below stays finite.
      const float range_m =
          std::max(std::sqrt(target_x_m * target_x_m + target_y_m * target_y_m), 0.05F);
      x_m[i] = target_x_m;
      y_m[i] = target_y_m;
      beam[i] = finder.beamTowards(target_x_m, target_y_m);
      reach_beams[i] = 1 + static_cast<std::int32_t>(std::min(reach / range_m, max_search_beams));
    }
  }
};

/// The nearest point within `max_distance_m` among the beams beside the one in its direction,
/// or null.
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

/// The sums over all pairs, in single precision.
struct Sums {
  float xx = 0.0F, xy = 0.0F, yy = 0.0F, xa = 0.0F, ya = 0.0F, aa = 0.0F;
  float gx = 0.0F, gy = 0.0F, ga = 0.0F, cost = 0.0F, weight = 0.0F;

  /// \param nx, ny  normal of the line
  /// \param lever   derivative of the residual by the yaw
  void add(float nx, float ny, float lever, float residual, float pair_weight) {
    const float wx = pair_weight * nx;
    const float wy = pair_weight * ny;
    const float wa = pair_weight * lever;
    xx += wx * nx;
    xy += wx * ny;
    yy += wy * ny;
    xa += wx * lever;
    ya += wy * lever;
    aa += wa * lever;
    gx += wx * residual;
    gy += wy * residual;
    ga += wa * residual;
    cost += pair_weight * residual * residual;
    weight += pair_weight;
  }
};

/// Calls `use(point, partner, residual, lever)` for each pair; `lever` is the derivative of the
/// residual by the yaw.
/// \return points of `source` on lines within the target's field of view
template <typename Use>
std::size_t forEachPair(const SurfaceScan& target,
                        const SurfaceScan& source,
                        const Pose2& target_from_source,
                        const PairingLimits& limits,
                        const Use& use) {
  const BeamFinder finder(target.angle_min_rad, target.angle_increment_rad,
                          target.point_of_beam.size());
  const Transform transform(target_from_source);
  const auto max_distance_m = static_cast<float>(limits.max_distance_m);
  const auto min_cosine = static_cast<float>(limits.min_normal_cosine);
  const auto beams_per_rad = static_cast<float>(1.0 / std::abs(target.angle_increment_rad));
  const float reach = max_distance_m * beams_per_rad;
  const auto max_search_beams = static_cast<float>(limits.max_search_beams);

  std::size_t visible_count = 0;
  Block block;
  for (std::size_t next = 0; next < source.points.size();) {
    next = block.take(source, next, limits.point_stride);
    block.place(transform, finder, reach, max_search_beams);
    for (std::size_t i = 0; i < block.count; ++i) {
      if (block.beam[i] < 0) continue;
      const SurfacePoint& point = block.source[i];
      if (point.hasNormal()) ++visible_count;
      const SurfacePoint* partner = nearest(target, block, i, max_distance_m);
      if (partner == nullptr || !partner->hasNormal()) continue;
      const float nx = partner->normal_x;
      const float ny = partner->normal_y;
      const float normal_x = transform.cosine * point.normal_x - transform.sine * point.normal_y;
      const float normal_y = transform.sine * point.normal_x + transform.cosine * point.normal_y;
      if (point.hasNormal() && nx * normal_x + ny * normal_y < min_cosine) continue;
      const float residual =
          nx * (block.x_m[i] - partner->x_m) + ny * (block.y_m[i] - partner->y_m);
      use(point, *partner, residual, ny * block.rotated_x[i] - nx * block.rotated_y[i]);
    }
  }
  return visible_count;
}

/// Where a point moves for each second of a mirror turn, in the axes of its scan [m/s].
Eigen::Vector2d movedBySweep(const SweepingScan& scan, const SurfacePoint& point) {
  const double swept_rad =
      sweptAngle_rad(std::atan2(point.y_m, point.x_m), scan.surfaces.angle_min_rad,
                     scan.surfaces.angle_increment_rad);
  return swept_rad / (2.0 * M_PI) *
         (scan.velocity.head<2>() + scan.velocity.z() * Eigen::Vector2d(-point.y_m, point.x_m));
}

}  // namespace

PointToLineSum sumPointToLine(const SurfaceScan& target,
                              const SurfaceScan& source,
                              const Pose2& target_from_source,
                              const PairingLimits& limits) {
  const auto inverse_scale2 =
      static_cast<float>(1.0 / (limits.robust_scale_m * limits.robust_scale_m));
  PointToLineSum sum;
  Sums sums;
  sum.visible_count = forEachPair(
      target, source, target_from_source, limits,
      [&](const SurfacePoint& point, const SurfacePoint& partner, float residual, float lever) {
        sums.add(partner.normal_x, partner.normal_y, lever, residual,
                 1.0F / (1.0F + residual * residual * inverse_scale2));
        if (point.hasNormal()) ++sum.pair_count;
      });
  sum.information << sums.xx, sums.xy, sums.xa, sums.xy, sums.yy, sums.ya, sums.xa, sums.ya,
      sums.aa;
  sum.gradient << sums.gx, sums.gy, sums.ga;
  sum.cost_m2 = sums.cost;
  sum.weight = sums.weight;
  return sum;
}

ScanPairSum sumScanPair(const SweepingScan& target,
                        const SweepingScan& source,
                        const Pose2& target_from_source,
                        const PairingLimits& limits) {
  const Eigen::Matrix2d rotation = target_from_source.rotation();
  ScanPairSum sum;
  forEachPair(
      target.surfaces, source.surfaces, target_from_source, limits,
      [&](const SurfacePoint& point, const SurfacePoint& partner, float residual, float lever) {
        const Eigen::Vector2d normal(partner.normal_x, partner.normal_y);
        const Eigen::Vector2d moved =
            rotation * movedBySweep(source, point) - movedBySweep(target, partner);
        const Eigen::Vector4d row(normal.x(), normal.y(), lever, moved.dot(normal));
        const double weight = 1.0 / (1.0 + std::pow(residual / limits.robust_scale_m, 2));
        sum.information += weight * row * row.transpose();
        sum.gradient += weight * residual * row;
      });
  return sum;
}

}  // namespace ram_slam
