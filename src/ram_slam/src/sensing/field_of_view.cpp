// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/sensing/field_of_view.hpp"

#include <algorithm>

namespace ram_slam {
namespace {

/// Points that two views must both know about to be compared: the share of those that contradict
/// each other then has a standard deviation of at most sqrt(0.25 / 40) = 0.08.
constexpr int kMinCommonPoints = 40;

struct Agreement {
  int agreeing = 0;
  int contradicting = 0;
};

void compare(const FieldOfView& view,
             const std::vector<Eigen::Vector2d>& surface_m,
             const Pose2& view_from_surface,
             Agreement& sum) {
  const Eigen::Matrix2d rotation = view_from_surface.rotation();
  const Eigen::Vector2d origin_m = view_from_surface.translation();
  for (const Eigen::Vector2d& point_m : surface_m) {
    const Sight sight = view.look(origin_m + rotation * point_m);
    if (sight == Sight::kVisible) ++sum.agreeing;
    if (sight == Sight::kEmpty) ++sum.contradicting;
  }
}

}  // namespace

const std::vector<Eigen::Vector2d>& FieldOfView::surface_m() const {
  static const std::vector<Eigen::Vector2d> kNone;
  return kNone;
}

const ram_parameters::ParameterTable<LaserViewParameters>& LaserViewParameters::table() {
  using namespace ram_parameters;
  using P = LaserViewParameters;
  static const auto table =
      ParameterTable<P>()
          .add("margin_at_max_range_m", &P::margin_at_max_range_m, "m", atLeast(0.0),
               "Points this near to the greatest range count as hidden.")
          .add("blocked_m", &P::blocked_m, "m", positive(),
               "A reading this much nearer than a point hides it.")
          .add("passed_m", &P::passed_m, "m", positive(),
               "A reading this much farther means that nothing is at the point.")
          .add("beams_beside", &P::beams_beside, "", atLeast(0),
               "Beams on each side of a point's own that must agree with it.")
          .add("surface_points", &P::surface_points, "", atLeast(1),
               "Readings of a scan that are compared with other views, about.");
  return table;
}

LaserView::LaserView(const LaserScan& scan,
                     const Pose2& base_from_laser,
                     const LaserViewParameters& parameters)
    : parameters_(parameters),
      scan_(scan),
      finder_(scan.angle_min_rad, scan.angle_increment_rad, scan.ranges_m.size()),
      base_from_laser_rotation_(base_from_laser.rotation()),
      base_from_laser_m_(base_from_laser.translation()) {
  scan_.validate();
  const std::size_t step = std::max<std::size_t>(
      1, scan_.ranges_m.size() / static_cast<std::size_t>(parameters_.surface_points));
  for (std::size_t i = 0; i < scan_.ranges_m.size(); i += step) {
    if (scan_.at(i) == Return::kHit)
      surface_m_.push_back(base_from_laser_m_ + base_from_laser_rotation_ * scan_.end_m(i));
  }
}

double LaserView::range_m() const {
  return scan_.range_max_m + base_from_laser_m_.norm();
}

Sight LaserView::look(const Eigen::Vector2d& point_in_base_m) const {
  const Eigen::Vector2d point =
      base_from_laser_rotation_.transpose() * (point_in_base_m - base_from_laser_m_);
  const double range_m = point.norm();
  if (range_m < scan_.range_min_m ||
      range_m > scan_.range_max_m - parameters_.margin_at_max_range_m) {
    return Sight::kHidden;
  }
  const int beam =
      finder_.beamTowards(static_cast<float>(point.x()), static_cast<float>(point.y()));
  const int beside = parameters_.beams_beside;
  if (beam < beside || beam + beside >= static_cast<int>(scan_.ranges_m.size())) {
    return Sight::kHidden;
  }
  bool near_hit = false;
  bool all_pass = true;
  for (int i = beam - beside; i <= beam + beside; ++i) {
    const Return reading = scan_.at(i);
    if (reading == Return::kInvalid || reading == Return::kTooClose) return Sight::kHidden;
    const double beyond_m =
        reading == Return::kNothing ? scan_.range_max_m : scan_.ranges_m[i] - range_m;
    if (beyond_m < -parameters_.blocked_m) return Sight::kHidden;
    near_hit = near_hit || beyond_m < parameters_.passed_m;
    all_pass = all_pass && beyond_m > parameters_.passed_m;
  }
  if (all_pass) return Sight::kEmpty;
  return near_hit ? Sight::kVisible : Sight::kHidden;
}

std::optional<double> discontinuity(const FieldOfView& before,
                                    const FieldOfView& now,
                                    const Pose2& before_from_now) {
  Agreement sum;
  compare(before, now.surface_m(), before_from_now, sum);
  compare(now, before.surface_m(), before_from_now.inverse(), sum);
  const int common = sum.agreeing + sum.contradicting;
  if (common < kMinCommonPoints) return std::nullopt;
  return static_cast<double>(sum.contradicting) / common;
}

std::vector<PlacedView> viewsOf(const std::vector<PlacedScan>& scans) {
  std::vector<PlacedView> views;
  views.reserve(scans.size());
  for (const PlacedScan& placed : scans) {
    views.push_back({placed.map_from_base(),
                     std::make_shared<const LaserView>(placed.scan, placed.base_from_laser)});
  }
  return views;
}

}  // namespace ram_slam
