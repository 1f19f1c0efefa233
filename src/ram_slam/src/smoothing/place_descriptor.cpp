// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/place_descriptor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace ram_slam {
namespace {

/// About so many points; their pairs fill the bins well.
constexpr std::size_t kPoints = 100;
/// Bins per metre: finer than rooms differ, coarser than the points are spread along a wall.
constexpr float kBinsPerM = 2.0F;
/// Bins of the cosine between the walls of a pair, 0 .. 1.
constexpr std::size_t kAngleBins = 3;

/// Points on walls, evenly spread over the beams.
std::vector<SurfacePoint> sampledPoints(const SurfaceScan& surfaces, double max_range_m) {
  std::vector<SurfacePoint> points;
  for (const SurfacePoint& point : surfaces.points) {
    if (point.hasNormal() && std::hypot(point.x_m, point.y_m) <= static_cast<float>(max_range_m))
      points.push_back(point);
  }
  const std::size_t stride = points.size() / kPoints + 1;
  std::vector<SurfacePoint> sampled;
  for (std::size_t i = 0; i < points.size(); i += stride) sampled.push_back(points[i]);
  return sampled;
}

}  // namespace

PlaceDescriptor describePlace(const SurfaceScan& surfaces, double max_range_m) {
  const std::vector<SurfacePoint> points = sampledPoints(surfaces, max_range_m);
  if (points.size() < 2) return {};
  const auto distance_bins =
      static_cast<std::size_t>(2.0F * static_cast<float>(max_range_m) * kBinsPerM) + 1;
  PlaceDescriptor bins(distance_bins * kAngleBins, 0.0F);
  const auto count = static_cast<float>(points.size() * (points.size() - 1) / 2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const SurfacePoint& a = points[i];
      const SurfacePoint& b = points[j];
      const float cosine = std::abs(a.normal_x * b.normal_x + a.normal_y * b.normal_y);
      const auto angle_bin = std::min(
          kAngleBins - 1, static_cast<std::size_t>(cosine * static_cast<float>(kAngleBins)));
      const float distance_m = std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
      const auto distance_bin =
          std::min(distance_bins - 1, static_cast<std::size_t>(distance_m * kBinsPerM));
      bins[distance_bin * kAngleBins + angle_bin] += 1.0F / count;
    }
  }
  return bins;
}

double likeness(const PlaceDescriptor& a, const PlaceDescriptor& b) {
  if (a.size() != b.size()) return 0.0;
  float common = 0.0F;
  for (std::size_t i = 0; i < a.size(); ++i) common += std::min(a[i], b[i]);
  return static_cast<double>(common);
}

}  // namespace ram_slam
