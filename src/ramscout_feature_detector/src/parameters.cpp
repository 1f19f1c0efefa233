// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/parameters.hpp"

#include <cmath>
#include <stdexcept>

#include "require_within.hpp"

namespace ramscout_feature_detector {
namespace {

constexpr double kWarnRangeM = 10.0;
constexpr double kWarnCoarsestPpm = 10.0;

void warnOutside(
    const char* name, double value, double low, double high, std::vector<std::string>& warnings) {
  if (low <= value && value <= high) return;
  warnings.push_back(std::string(name) + " = " + std::to_string(value) +
                     " is outside the range that is known to work, " + std::to_string(low) +
                     " to " + std::to_string(high));
}

}  // namespace

void FeatureDetectorParameters::validate() const {
  requireWithin("ppm", ppm, 10.0, 1000.0);
  requireWithin("kernel_radius", kernel_radius, 1, 500);
  requireWithin("scale_levels", scale_levels, 1, 5);
  requireWithin("laser_range_sigma", laser_range_sigma, 1e-4, 1.0);
  requireWithin("laser_angular_sigma", laser_angular_sigma, 1e-6, 0.1);
  requireWithin("distance_threshold", distance_threshold, 0.01, 10.0);
  requireWithin("occlude_limit", occlude_limit, 0.01, 10.0);
  requireWithin("extrapolation_distance", extrapolation_distance, 0.01, 20.0);
  requireWithin("max_features", max_features, 1, 1000);
  requireWithin("feature_threshold", feature_threshold, 0.0, 1.0);
  requireWithin("feature_distance", feature_distance, 0.01, 10.0);
  requireWithin("covariance_limit", covariance_limit, 1e-8, 1e3);
  requireWithin("corner_threshold", corner_threshold, 0.005, 0.5);
  requireWithin("significance_min", significance_min, 0.0, 1e6);
  requireWithin("position_sigma_limit", position_sigma_limit, 1e-4, 10.0);
  if (!(extrapolation_distance > occlude_limit)) {
    throw std::invalid_argument(
        "extrapolation_distance (" + std::to_string(extrapolation_distance) +
        ") must be greater than occlude_limit (" + std::to_string(occlude_limit) + ")");
  }
  requireFrame("base_frame", base_frame);
}

std::vector<std::string> FeatureDetectorParameters::warnings() const {
  std::vector<std::string> warnings;
  warnOutside("ppm", ppm, 50.0, 200.0, warnings);
  warnOutside("kernel_radius", kernel_radius, 15, 100, warnings);
  warnOutside("scale_levels", scale_levels, 1, 3, warnings);
  warnOutside("distance_threshold", distance_threshold, 0.3, 1.0, warnings);
  warnOutside("occlude_limit", occlude_limit, 0.3, 10.0, warnings);
  warnOutside("extrapolation_distance", extrapolation_distance, 1.0, 20.0, warnings);
  warnOutside("max_features", max_features, 5, 1000, warnings);
  if (relative_threshold) warnOutside("feature_threshold", feature_threshold, 0.7, 0.95, warnings);
  warnOutside("feature_distance", feature_distance, 0.15, 10.0, warnings);
  const double needed_px =
      std::ceil(3.0 * ppm * std::max(laser_range_sigma, kWarnRangeM * laser_angular_sigma));
  if (kernel_radius < needed_px) {
    warnings.push_back("kernel_radius = " + std::to_string(kernel_radius) +
                       " cuts the kernel off before three standard deviations at 10 m; it takes " +
                       std::to_string(static_cast<int>(needed_px)));
  }
  const double coarsest_ppm = std::ldexp(ppm, 1 - scale_levels);
  if (coarsest_ppm < kWarnCoarsestPpm) {
    warnings.push_back("the coarsest of scale_levels = " + std::to_string(scale_levels) +
                       " levels has only " + std::to_string(coarsest_ppm) +
                       " pixels per metre: expect features where there are none");
  }
  return warnings;
}

FeatureDetectorParameters readFeatureDetectorParameters(ram_parameters::ParameterReader& reader) {
  FeatureDetectorParameters parameters;
  reader.read("ppm", parameters.ppm);
  reader.read("kernel_radius", parameters.kernel_radius);
  reader.read("scale_levels", parameters.scale_levels);
  reader.read("laser_range_sigma", parameters.laser_range_sigma);
  reader.read("laser_angular_sigma", parameters.laser_angular_sigma);
  reader.read("distance_threshold", parameters.distance_threshold);
  reader.read("occlude_limit", parameters.occlude_limit);
  reader.read("extrapolation_distance", parameters.extrapolation_distance);
  reader.read("max_features", parameters.max_features);
  reader.read("relative_threshold", parameters.relative_threshold);
  reader.read("feature_threshold", parameters.feature_threshold);
  reader.read("feature_distance", parameters.feature_distance);
  reader.read("covariance_limit", parameters.covariance_limit);
  reader.read("corner_threshold", parameters.corner_threshold);
  reader.read("significance_min", parameters.significance_min);
  reader.read("position_sigma_limit", parameters.position_sigma_limit);
  reader.read("base_frame", parameters.base_frame);
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
}

}  // namespace ramscout_feature_detector
