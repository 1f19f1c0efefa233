// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/pose_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ram_slam/sensing/beam_finder.hpp"

namespace ram_slam {
namespace {

/// What a scan saw in a direction, about a point in it.
struct Sighting {
  float distance_m = std::numeric_limits<float>::infinity();  ///< of the nearest surface
  float nearest_range_m = std::numeric_limits<float>::infinity();
  bool in_view = false;
};

/// A scan that points of another are compared with.
class View {
public:
  View(const SurfaceScan& scan, const Pose2& map_from_laser, double reach_m)
      : scan_(scan),
        finder_(scan.angle_min_rad, scan.angle_increment_rad, scan.point_of_beam.size()),
        laser_from_map_(map_from_laser.inverse()),
        reach_m_(static_cast<float>(reach_m)),
        beam_rad_(static_cast<float>(std::abs(scan.angle_increment_rad))) {}

  Sighting at(const Eigen::Vector2d& point_in_map_m) const {
    const Eigen::Vector2f point_m = (laser_from_map_ * point_in_map_m).cast<float>();
    const float range_m = std::max(point_m.norm(), reach_m_);
    const std::int32_t beam = finder_.beamTowards(point_m.x(), point_m.y());
    Sighting sighting;
    if (beam < 0) return sighting;
    const auto reach_beams = 1 + static_cast<std::int32_t>(reach_m_ / (range_m * beam_rad_));
    // The line through a point counts as far as the next beams on a wall seen at 60 degrees.
    const float line_m = std::max(reach_m_, 2.0F * range_m * beam_rad_);
    for (std::int32_t i = pointOfBeam(beam - reach_beams); i < pointOfBeam(beam + reach_beams + 1);
         ++i) {
      const SurfacePoint& other = scan_.points[static_cast<std::size_t>(i)];
      const Eigen::Vector2f away_m(point_m.x() - other.x_m, point_m.y() - other.y_m);
      sighting.distance_m = std::min(sighting.distance_m, distanceFrom(other, away_m, line_m));
    }
    for (std::int32_t i = pointOfBeam(beam - 1); i < pointOfBeam(beam + 2); ++i) {
      const SurfacePoint& other = scan_.points[static_cast<std::size_t>(i)];
      sighting.nearest_range_m =
          std::min(sighting.nearest_range_m, std::hypot(other.x_m, other.y_m));
      sighting.in_view = true;
    }
    return sighting;
  }

  float rangeOf(const Eigen::Vector2d& point_in_map_m) const {
    return static_cast<float>((laser_from_map_ * point_in_map_m).norm());
  }

private:
  std::int32_t pointOfBeam(std::int32_t beam) const {
    if (beam <= 0) return 0;
    return beam < static_cast<std::int32_t>(scan_.point_of_beam.size())
               ? scan_.point_of_beam[static_cast<std::size_t>(beam)]
               : static_cast<std::int32_t>(scan_.points.size());
  }

  /// From the line through a point, up to `line_m` along it, or from the point.
  static float distanceFrom(const SurfacePoint& other,
                            const Eigen::Vector2f& away_m,
                            float line_m) {
    if (!other.hasNormal()) return away_m.norm();
    const float across_m = std::abs(other.normal_x * away_m.x() + other.normal_y * away_m.y());
    const float along_m = std::abs(other.normal_x * away_m.y() - other.normal_y * away_m.x());
    return along_m < line_m ? across_m : away_m.norm();
  }

  const SurfaceScan& scan_;
  BeamFinder finder_;
  Pose2 laser_from_map_;
  float reach_m_;
  float beam_rad_;
};

/// Minus the logarithm of the likelihood of one reading over its greatest.
class ReadingCost {
public:
  explicit ReadingCost(const PoseLikelihoodParameters& parameters)
      : inverse_variance_(1.0 / (parameters.deviation_m * parameters.deviation_m)),
        margin_m_(parameters.margin_m),
        unseen_(-std::log(parameters.unseen)),
        contradicting_(-std::log(parameters.contradicting)) {}

  double of(const Eigen::Vector2d& point_in_map_m, const std::vector<View>& views) const {
    double least = contradicting_;
    bool is_seen_through = false;
    for (const View& view : views) {
      const Sighting sighting = view.at(point_in_map_m);
      const double distance_m = sighting.distance_m;
      if (std::isfinite(sighting.distance_m))
        least = std::min(least, 0.5 * distance_m * distance_m * inverse_variance_);
      is_seen_through |=
          sighting.in_view && view.rangeOf(point_in_map_m) + margin_m_ < sighting.nearest_range_m;
    }
    return is_seen_through ? least : std::min(least, unseen_);
  }

private:
  double inverse_variance_;
  double margin_m_;
  double unseen_;
  double contradicting_;
};

/// Mean cost of the readings of a scan, compared with the views.
double meanCost(const SurfaceScan& scan,
                const Pose2& map_from_laser,
                const std::vector<View>& views,
                const PoseLikelihoodParameters& parameters) {
  const ReadingCost cost(parameters);
  const auto most = static_cast<std::size_t>(parameters.max_points);
  const std::size_t stride = std::max<std::size_t>(1, (scan.points.size() + most - 1) / most);
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < scan.points.size(); i += stride, count += 1.0) {
    const SurfacePoint& point = scan.points[i];
    sum += cost.of(map_from_laser * Eigen::Vector2d(point.x_m, point.y_m), views);
  }
  return sum / std::max(count, 1.0);
}

}  // namespace

const ram_parameters::ParameterTable<PoseLikelihoodParameters>& PoseLikelihoodParameters::table() {
  using namespace ram_parameters;
  using P = PoseLikelihoodParameters;
  static const auto table =
      ParameterTable<P>()
          .add("deviation_m", &P::deviation_m, "m", positive(),
               "Standard deviation of a reading from a surface that the other scan saw.")
          .add("unseen", &P::unseen, "", between(0.0, 1.0),
               "Likelihood of a reading where the other scan saw nothing, relative to one on a "
               "surface that it saw.")
          .add("contradicting", &P::contradicting, "", between(0.0, 1.0),
               "The same of a reading in front of what the other scan saw: people, glass.")
          .add("margin_m", &P::margin_m, "m", positive(),
               "A reading is before or behind what the other scan saw if it is so much nearer or "
               "farther.")
          .add("max_points", &P::max_points, "", atLeast(1),
               "Points of each scan that are used, evenly spread.")
          .add("correlated_beams", &P::correlated_beams, "", atLeast(1.0),
               "How many readings share their error and count as one.");
  return table;
}

double poseLogLikelihood(const SurfaceScan& scan,
                         const std::vector<ReferenceScan>& references,
                         const Pose2& map_from_laser,
                         const PoseLikelihoodParameters& parameters) {
  const double reach_m = 3.0 * parameters.deviation_m;
  std::vector<View> views;
  for (const ReferenceScan& reference : references)
    views.emplace_back(*reference.surfaces, reference.map_from_laser, reach_m);
  double cost = meanCost(scan, map_from_laser, views, parameters);
  const std::vector<View> own{View(scan, map_from_laser, reach_m)};
  double back = 0.0;
  for (const ReferenceScan& reference : references)
    back += meanCost(*reference.surfaces, reference.map_from_laser, own, parameters) /
            static_cast<double>(references.size());
  cost = 0.5 * (cost + back);
  const double count =
      std::min(static_cast<double>(scan.points.size()), static_cast<double>(parameters.max_points));
  return -cost * count / parameters.correlated_beams;
}

}  // namespace ram_slam
