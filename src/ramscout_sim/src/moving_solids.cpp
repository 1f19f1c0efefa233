// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/moving_solids.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ramscout_sim {
namespace {

/// The part of a ray that lies in a convex body: way in and way out, with the outward normal at
/// either end in the body's axes.
struct Span {
  double begin_m = -std::numeric_limits<double>::infinity();
  double end_m = std::numeric_limits<double>::infinity();
  Eigen::Vector3d begin_normal = Eigen::Vector3d::Zero();
  Eigen::Vector3d end_normal = Eigen::Vector3d::Zero();

  bool isEmpty() const { return !(begin_m <= end_m); }
};

Span emptySpan() {
  Span span;
  std::swap(span.begin_m, span.end_m);
  return span;
}

/// Cuts the span down to the slab |coordinate| <= half along one axis.
void clip(Span& span,
          const Eigen::Vector3d& origin,
          const Eigen::Vector3d& direction,
          int axis,
          double half_m) {
  if (direction[axis] == 0.0) {
    if (std::abs(origin[axis]) > half_m) span = emptySpan();
    return;
  }
  const double sign = direction[axis] > 0.0 ? 1.0 : -1.0;
  const double enter_m = (-sign * half_m - origin[axis]) / direction[axis];
  const double leave_m = (sign * half_m - origin[axis]) / direction[axis];
  const Eigen::Vector3d normal = sign * Eigen::Vector3d::Unit(axis);
  if (enter_m > span.begin_m) {
    span.begin_m = enter_m;
    span.begin_normal = -normal;
  }
  if (leave_m < span.end_m) {
    span.end_m = leave_m;
    span.end_normal = normal;
  }
}

/// Inside a sphere (all three axes) or an endless cylinder about z (the first two).
Span round(const Eigen::Vector3d& origin,
           const Eigen::Vector3d& direction,
           const Eigen::Vector3d& axes,
           double radius_m) {
  const Eigen::Vector3d o = origin.cwiseProduct(axes);
  const Eigen::Vector3d d = direction.cwiseProduct(axes);
  const double a = d.squaredNorm();
  const double c = o.squaredNorm() - radius_m * radius_m;
  if (a == 0.0) return c <= 0.0 ? Span() : emptySpan();
  const double b = o.dot(d);
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0) return emptySpan();
  const double root = std::sqrt(discriminant);
  Span span;
  span.begin_m = (-b - root) / a;
  span.end_m = (-b + root) / a;
  span.begin_normal = (o + span.begin_m * d) / radius_m;
  span.end_normal = (o + span.end_m * d) / radius_m;
  return span;
}

Span spanIn(const Solid& solid, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d half = 0.5 * solid.size_m;
  Span span;
  switch (solid.shape) {
    case Shape::kBox:
      for (int axis = 0; axis < 3; ++axis) clip(span, origin, direction, axis, half[axis]);
      return span;
    case Shape::kCylinder:
      span = round(origin, direction, {1.0, 1.0, 0.0}, half.x());
      if (!span.isEmpty()) clip(span, origin, direction, 2, half.z());
      return span;
    case Shape::kSphere:
      return round(origin, direction, Eigen::Vector3d::Ones(), half.x());
    case Shape::kMesh:
      break;
  }
  return emptySpan();
}

}  // namespace

std::optional<Hit> intersect(const Ray& ray, const Solid& solid) {
  const Eigen::Matrix3d solid_from_world = solid.world_from_solid.linear().transpose();
  const Eigen::Vector3d origin =
      solid_from_world * (ray.origin_m.cast<double>() - solid.world_from_solid.translation());
  const Span span = spanIn(solid, origin, solid_from_world * ray.direction.cast<double>());
  if (span.isEmpty() || span.end_m < 0.0) return std::nullopt;
  const bool inside = span.begin_m < 0.0;
  Hit hit;
  hit.distance_m = static_cast<float>(inside ? span.end_m : span.begin_m);
  const Eigen::Vector3d normal =
      solid.world_from_solid.linear() * (inside ? span.end_normal : span.begin_normal);
  hit.normal = normal.cast<float>();
  hit.material = static_cast<std::uint32_t>(solid.material);
  return hit;
}

void castMoving(const Rays& rays,
                const std::vector<Solid>& solids,
                const std::vector<BeamWindow>& windows,
                std::vector<float>& ranges_m) {
  for (const BeamWindow& window : windows) {
    for (std::size_t beam = window.begin; beam < window.end; ++beam) {
      const std::optional<Hit> hit = intersect(rays[beam], solids[window.solid]);
      if (hit) ranges_m[beam] = std::min(ranges_m[beam], hit->distance_m);
    }
  }
}

void traceMoving(const Rays& rays,
                 const std::vector<Solid>& solids,
                 const std::vector<BeamWindow>& windows,
                 std::vector<Hit>& hits) {
  for (const BeamWindow& window : windows) {
    for (std::size_t beam = window.begin; beam < window.end; ++beam) {
      const std::optional<Hit> hit = intersect(rays[beam], solids[window.solid]);
      if (hit && hit->distance_m < hits[beam].distance_m) hits[beam] = *hit;
    }
  }
}

}  // namespace ramscout_sim
