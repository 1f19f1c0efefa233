// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/wheel_scatter.hpp"

#include <algorithm>
#include <cmath>

namespace ram_slam {

const ram_parameters::ParameterTable<WheelScatterParameters>& WheelScatterParameters::table() {
  using namespace ram_parameters;
  using P = WheelScatterParameters;
  static const auto table =
      ParameterTable<P>()
          .add("memory", &P::memory, "", atLeast(1.0),
               "So many intervals later an interval counts 1/e.")
          .add("prior", &P::prior, "", positive(),
               "The stated deviation counts as so many intervals.")
          .add("min_share", &P::min_share, "", aboveUpTo(0.0, 1.0),
               "Share of the stated deviation of the yaw that is believed at least; 1: nothing is "
               "learned.")
          .add("max_deviations", &P::max_deviations, "", positive(),
               "Where a scan moves the pose by more of the believed deviations than this, the "
               "stated ones hold.")
          .add("min_scan_share", &P::min_scan_share, "", between(0.0, 1.0),
               "An interval counts only if the scans measured this share of its turn.")
          .add("turning_rad", &P::turning_rad, "rad", positive(),
               "Intervals with more turning show the scatter of turns.");
  return table;
}

WheelScatter::WheelScatter(const WheelScatterParameters& parameters)
    : parameters_(parameters), straight_{parameters.prior, parameters.prior}, turning_(straight_) {}

MotionNoise WheelScatter::of(const MotionNoise& stated) const {
  MotionNoise believed = stated;
  believed.rest_deviation_rad *= share(straight_);
  believed.deviation_rad_per_m *= share(straight_);
  believed.deviation_rad_per_rad *= share(turning_);
  return believed;
}

void WheelScatter::add(const Pose2& wheels,
                       double observed_yaw_rad,
                       const MotionNoise& stated,
                       double by_scans_rad) {
  const double stated2 = std::pow(stated.deviations(wheels).z(), 2);
  const double believed2 = std::pow(of(stated).deviations(wheels).z(), 2);
  const double scans2 = by_scans_rad * by_scans_rad;
  // The observed yaw lies by this share of the way from that of the wheels to that of the scans.
  const double scan_share = believed2 / (believed2 + scans2);
  if (!(scan_share >= parameters_.min_scan_share)) return;
  const double residual_rad = wrapAngle(observed_yaw_rad - wheels.yaw_rad) / scan_share;
  const double squared_share =
      std::clamp((residual_rad * residual_rad - scans2) / stated2, 0.0, 1.0);
  count(std::abs(wheels.yaw_rad) > parameters_.turning_rad ? turning_ : straight_, squared_share);
}

void WheelScatter::addSlip() {
  count(straight_, 1.0);
  count(turning_, 1.0);
}

void WheelScatter::count(Mean& mean, double squared_share) const {
  const double kept = std::exp(-1.0 / parameters_.memory);
  mean = {kept * mean.sum + squared_share, kept * mean.weight + 1.0};
}

double WheelScatter::share(const Mean& mean) const {
  return std::clamp(std::sqrt(mean.sum / mean.weight), parameters_.min_share, 1.0);
}

}  // namespace ram_slam
