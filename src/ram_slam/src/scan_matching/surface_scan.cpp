// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/surface_scan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ram_slam/geometry/median.hpp"

namespace ram_slam {
namespace {

struct Sums {
  double count = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;

  void add(const SurfacePoint& point, const SurfacePoint& origin) {
    const double dx = point.x_m - origin.x_m;
    const double dy = point.y_m - origin.y_m;
    count += 1.0;
    x += dx;
    y += dy;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
};

float squaredDistance(const SurfacePoint& a, const SurfacePoint& b) {
  const float dx = a.x_m - b.x_m;
  const float dy = a.y_m - b.y_m;
  return dx * dx + dy * dy;
}

Eigen::Isometry2d toIsometry(const Pose2& pose) {
  return Eigen::Translation2d(pose.translation()) * Eigen::Rotation2Dd(pose.yaw_rad);
}

/// Standard deviation of a reading: of the distance, along the beam, from the middle one of three
/// neighbours to the line through the other two. By the median, as edges are no noise.
double readingDeviation(const std::vector<SurfacePoint>& ends,
                        const std::vector<float>& max_gaps_m) {
  std::vector<float> misfits_m;
  misfits_m.reserve(ends.size());
  for (std::size_t i = 1; i + 1 < ends.size(); ++i) {
    const SurfacePoint& before = ends[i - 1];
    const SurfacePoint& end = ends[i];
    const SurfacePoint& after = ends[i + 1];
    const float max_squared_gap = max_gaps_m[i] * max_gaps_m[i];
    if (std::max(squaredDistance(before, end), squaredDistance(end, after)) > max_squared_gap)
      continue;
    const Eigen::Vector2f line(after.x_m - before.x_m, after.y_m - before.y_m);
    const float offset = line.x() * (end.y_m - before.y_m) - line.y() * (end.x_m - before.x_m);
    const float facing = line.x() * end.y_m - line.y() * end.x_m;
    if (facing != 0.0F)
      misfits_m.push_back(std::abs(offset / facing) * std::hypot(end.x_m, end.y_m));
  }
  if (misfits_m.empty()) return 0.0;
  constexpr double kVariance = 1.5;  // of the misfit, over that of a reading
  return kDeviationPerMedian / std::sqrt(kVariance) * median(std::move(misfits_m));
}

/// The neighbours of a point, itself included, as far as they follow each other without a gap and
/// are within the window.
Sums sumNeighbours(const std::vector<SurfacePoint>& ends,
                   std::size_t index,
                   float max_gap_m,
                   float window_m,
                   const SurfaceParameters& parameters) {
  const float max_squared_gap = max_gap_m * max_gap_m;
  const float squared_window = window_m * window_m;
  const auto least = static_cast<std::size_t>(parameters.neighbour_count);
  const auto most = static_cast<std::size_t>(parameters.max_neighbour_count);
  Sums sums;
  sums.add(ends[index], ends[index]);
  for (std::size_t i = index; i + 1 < ends.size() && i < index + most; ++i) {
    if (squaredDistance(ends[i], ends[i + 1]) > max_squared_gap) break;
    if (i >= index + least && squaredDistance(ends[index], ends[i + 1]) > squared_window) break;
    sums.add(ends[i + 1], ends[index]);
  }
  for (std::size_t i = index; i > 0 && i + most > index; --i) {
    if (squaredDistance(ends[i], ends[i - 1]) > max_squared_gap) break;
    if (i + least <= index && squaredDistance(ends[index], ends[i - 1]) > squared_window) break;
    sums.add(ends[i - 1], ends[index]);
  }
  return sums;
}

/// The point on the line of least squares through its neighbours, with the line's normal; the bare
/// point if they do not lie on a line.
SurfacePoint fitLine(const SurfacePoint& end,
                     const Sums& sums,
                     double max_deviation_m,
                     const SurfaceParameters& parameters) {
  if (sums.count < parameters.min_line_points) return end;
  const double mean_x = sums.x / sums.count;
  const double mean_y = sums.y / sums.count;
  const double xx = sums.xx / sums.count - mean_x * mean_x;
  const double xy = sums.xy / sums.count - mean_x * mean_y;
  const double yy = sums.yy / sums.count - mean_y * mean_y;
  const double half_difference = std::sqrt(0.25 * (xx - yy) * (xx - yy) + xy * xy);
  const double along = 0.5 * (xx + yy) + half_difference;
  const double across = std::max(0.0, 0.5 * (xx + yy) - half_difference);
  const double min_elongation = parameters.min_line_elongation;
  const bool is_line = across <= max_deviation_m * max_deviation_m &&
                       along >= min_elongation * min_elongation * across;
  if (!is_line || along <= 0.0) return end;

  // The line's direction has half the angle of (xx - yy, 2 xy).
  const double cosine = 0.5 * (xx - yy) / half_difference;
  const double sine = xy / half_difference;
  const double larger = std::sqrt(0.5 * (1.0 + std::abs(cosine)));
  const double smaller = 0.5 * sine / larger;
  double normal_x = cosine >= 0.0 ? -smaller : -larger;
  double normal_y = cosine >= 0.0 ? larger : smaller;
  if (normal_x * end.x_m + normal_y * end.y_m > 0.0) {
    normal_x = -normal_x;
    normal_y = -normal_y;
  }
  const double offset = normal_x * mean_x + normal_y * mean_y;
  SurfacePoint point;
  point.x_m = static_cast<float>(end.x_m + offset * normal_x);
  point.y_m = static_cast<float>(end.y_m + offset * normal_y);
  point.normal_x = static_cast<float>(normal_x);
  point.normal_y = static_cast<float>(normal_y);
  return point;
}

}  // namespace

const ram_parameters::ParameterTable<SurfaceParameters>& SurfaceParameters::table() {
  using namespace ram_parameters;
  using P = SurfaceParameters;
  static const auto table =
      ParameterTable<P>()
          .heading("Lines in a scan")
          .add("neighbour_count", &P::neighbour_count, "", within(2, 100),
               "Beams on each side that a line is fitted through, at least.")
          .add("max_neighbour_count", &P::max_neighbour_count, "", within(2, 100),
               "The same, at most.")
          .rule(&P::max_neighbour_count, ">= neighbour_count",
                [](const P& p) { return p.max_neighbour_count >= p.neighbour_count; })
          .add("window_m", &P::window_m, "m", positive(),
               "Between these, a line is fitted through the readings up to this distance to each "
               "side.")
          .add("max_gap_m", &P::max_gap_m, "m", positive(),
               "Greatest distance between neighbours of one surface.")
          .add("max_line_deviation_m", &P::max_line_deviation_m, "m", positive(),
               "Standard deviation of the readings from their line.")
          .add("max_range_m", &P::max_range_m, "m", positive(), "Readings beyond are not used.")
          .expert("Lines in a scan: details")
          .add("window_in_deviations", &P::window_in_deviations, "", atLeast(0.0),
               "window_m grows to so many standard deviations of the scan's readings.")
          .add("max_line_in_deviations", &P::max_line_in_deviations, "", atLeast(0.0),
               "max_line_deviation_m grows to so many standard deviations of the scan's readings.")
          .add("max_gap_in_beams", &P::max_gap_in_beams, "", positive(),
               "Far away max_gap_m grows to so many times the distance of neighbouring beams on a "
               "facing wall.")
          .add("grazing_gap_factor", &P::grazing_gap_factor, "", atLeast(1.0),
               "A reading with fewer neighbours than min_line_points may have them across gaps so "
               "many times as wide, if they lie on a line: a wall at a grazing angle.")
          .add("min_line_points", &P::min_line_points, "", atLeast(2),
               "Readings without a gap between them that a line needs.")
          .add("min_line_elongation", &P::min_line_elongation, "", atLeast(1.0),
               "Readings are a line if their standard deviation along it is at least so many times "
               "that across it.");
  return table;
}

void SurfaceParameters::validate() const {
  table().check(*this);
}

bool lieOnOneLine(const SurfacePoint& a, const SurfacePoint& b, double max_deviation_m) {
  if (!a.hasNormal() || !b.hasNormal()) return false;
  const float x_m = b.x_m - a.x_m;
  const float y_m = b.y_m - a.y_m;
  const float from_a_m = std::abs(a.normal_x * x_m + a.normal_y * y_m);
  const float from_b_m = std::abs(b.normal_x * x_m + b.normal_y * y_m);
  return std::max(from_a_m, from_b_m) <= static_cast<float>(max_deviation_m);
}

SurfaceScan extractSurfaces(const LaserScan& scan,
                            const SurfaceParameters& parameters,
                            const Pose2& last_beam) {
  scan.validate();
  const double last = static_cast<double>(std::max<std::size_t>(scan.ranges_m.size(), 2) - 1);
  const Eigen::Vector3d twist = logarithm(last_beam) / last;  // per beam
  SurfaceScan surfaces;
  surfaces.angle_min_rad = scan.angle_min_rad;
  surfaces.angle_increment_rad = scan.angle_increment_rad + twist.z();
  surfaces.point_of_beam.reserve(scan.ranges_m.size());
  std::vector<SurfacePoint> ends;
  std::vector<float> max_gaps_m;
  ends.reserve(scan.ranges_m.size());
  max_gaps_m.reserve(scan.ranges_m.size());
  const auto beam_gap = static_cast<float>(parameters.max_gap_in_beams) *
                        static_cast<float>(std::abs(scan.angle_increment_rad));
  const Eigen::Isometry2d moved = toIsometry(exponential(twist));
  const Eigen::Isometry2d turned(Eigen::Rotation2Dd(scan.angle_increment_rad));
  Eigen::Isometry2d first_from_beam(Eigen::Rotation2Dd(scan.angle_min_rad));
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    if (beam > 0) first_from_beam = moved * first_from_beam * turned;
    surfaces.point_of_beam.push_back(static_cast<std::int32_t>(ends.size()));
    if (scan.at(beam) != Return::kHit || scan.ranges_m[beam] > parameters.max_range_m) continue;
    const Eigen::Vector2f end =
        (first_from_beam * Eigen::Vector2d(scan.ranges_m[beam], 0.0)).cast<float>();
    ends.push_back({end.x(), end.y(), 0.0F, 0.0F});
    max_gaps_m.push_back(
        std::max(static_cast<float>(parameters.max_gap_m), beam_gap * scan.ranges_m[beam]));
  }
  surfaces.points.reserve(ends.size());
  const double deviation_m = readingDeviation(ends, max_gaps_m);
  const auto window_m = static_cast<float>(
      std::max(parameters.window_m, parameters.window_in_deviations * deviation_m));
  const double max_line_deviation_m =
      std::max(parameters.max_line_deviation_m, parameters.max_line_in_deviations * deviation_m);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    Sums sums = sumNeighbours(ends, i, max_gaps_m[i], window_m, parameters);
    if (sums.count < parameters.min_line_points) {
      const float gap_m = static_cast<float>(parameters.grazing_gap_factor) * max_gaps_m[i];
      sums = sumNeighbours(ends, i, gap_m, window_m, parameters);
    }
    surfaces.points.push_back(fitLine(ends[i], sums, max_line_deviation_m, parameters));
  }
  return surfaces;
}

}  // namespace ram_slam
