// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/parameters.hpp"

#include <algorithm>
#include <cmath>

namespace ramscout_feature_detector {
namespace {

/// Farthest that corners are usually seen with legs long enough to fit.
constexpr double kUsualRangeM = 10.0;
/// A pixel of 0.1 m is the shortest leg: coarser ones show corners where there are none.
constexpr double kCoarsestPpm = 10.0;

using P = FeatureDetectorParameters;
using Table = ram_parameters::ParameterTable<P>;
using ram_parameters::positive;
using ram_parameters::within;

void addSurfaces(Table& table) {
  table.heading("Image")
      .add("ppm", &P::ppm, "1/m", within(10.0, 1000.0), "Pixels per metre of the finest level.")
      .advised(within(50.0, 200.0))
      .add("kernel_radius", &P::kernel_radius, "px", within(1, 500),
           "Where the blur of a reading is cut off.")
      .advised(within(15, 100))
      .add("scale_levels", &P::scale_levels, "", within(1, 5),
           "Levels of the pyramid, each half as fine.")
      .advised(within(1, 3))
      .add("laser_range_sigma", &P::laser_range_sigma, "m", within(1e-4, 1.0),
           "Standard deviation of a range reading.")
      .add("laser_angular_sigma", &P::laser_angular_sigma, "rad", within(1e-6, 0.1),
           "Standard deviation of a beam's direction.")
      .heading("Surfaces and their ends")
      .add("distance_threshold", &P::distance_threshold, "m", within(0.01, 10.0),
           "Neighbours farther apart belong to different surfaces (more on grazing walls).")
      .advised(within(0.3, 1.0))
      .add("occlude_limit", &P::occlude_limit, "m", within(0.01, 10.0),
           "No feature is accepted closer to the end of a surface.")
      .advised(within(0.3, 10.0))
      .add("extrapolation_distance", &P::extrapolation_distance, "m", within(0.01, 20.0),
           "Surfaces are prolonged by this, so that their ends do not appear as corners.")
      .rule(&P::extrapolation_distance, "> occlude_limit",
            [](const P& p) { return p.extrapolation_distance > p.occlude_limit; })
      .advised(within(1.0, 20.0));
}

void addSelection(Table& table) {
  table.heading("Which corners count")
      .add("corner_threshold", &P::corner_threshold, "", within(0.005, 0.5),
           "Least smaller eigenvalue / trace of the structure tensor: 0.08 is an opening of "
           "147 deg, 0.5 of 90 deg.")
      .add("significance_min", &P::significance_min, "", within(0.0, 1e6),
           "Least chi square (1 dof) of the bend against the noise.")
      .add("position_sigma_limit", &P::position_sigma_limit, "m", within(1e-4, 10.0),
           "Largest standard deviation of the position in any direction.")
      .add("covariance_limit", &P::covariance_limit, "m^2", within(1e-8, 1e3),
           "Largest entry of the position's covariance.")
      .add("feature_distance", &P::feature_distance, "m", within(0.01, 10.0),
           "Of features closer than this the strongest is kept.")
      .advised(within(0.15, 10.0))
      .add("max_features", &P::max_features, "", within(1, 1000), "Features per surface.")
      .advised(within(5, 1000))
      .add("relative_threshold", &P::relative_threshold,
           "Whether feature_threshold is demanded, too (a strong corner then hides weaker "
           "ones).")
      .add("feature_threshold", &P::feature_threshold, "", within(0.0, 1.0),
           "Least response as a fraction of the best on the same surface.")
      .advised(within(0.7, 0.95), [](const P& p) { return p.relative_threshold; });
}

void addTuning(Table& table) {
  table.heading("Frames")
      .include(&P::node, DetectorNodeParameters::table())
      .expert("Tuning")
      .add("tangent_length_m", &P::tangent_length_m, "m", positive(),
           "Length of the end of a surface whose tangent prolongs it.")
      .add("max_peak_offset_px", &P::max_peak_offset_px, "px", positive(),
           "Farthest that the point of a response may be from the crossing of the lines that "
           "it confirms.")
      .add("single_level_significance", &P::single_level_significance, "",
           ram_parameters::atLeast(0.0),
           "A corner as significant as this needs one level of the pyramid, others two "
           "consecutive ones.")
      .section("segmentation", &P::segmentation, SegmentationParameters::table())
      .section("two_lines", &P::two_lines, TwoLineParameters::table())
      .section("picture", &P::picture, PictureParameters::table());
}

}  // namespace

const ram_parameters::ParameterTable<PictureParameters>& PictureParameters::table() {
  using namespace ram_parameters;
  using P = PictureParameters;
  static const auto table = ParameterTable<P>()
                                .add("reach_m", &P::reach_m, "m", positive(),
                                     "Half of the side of the surroundings shown.")
                                .add("max_pixels", &P::max_pixels, "px", within(10, 10000),
                                     "Largest side of each of the three panels.")
                                .add("cross_pixels", &P::cross_pixels, "px", within(0, 1000),
                                     "Length of the arms of the cross at a corner.")
                                .add("brightest_response", &P::brightest_response, "", positive(),
                                     "Corner response that is shown white.");
  return table;
}

const ram_parameters::ParameterTable<FeatureDetectorParameters>&
FeatureDetectorParameters::table() {
  static const Table table = [] {
    Table parameters;
    addSurfaces(parameters);
    addSelection(parameters);
    addTuning(parameters);
    return parameters;
  }();
  return table;
}

void FeatureDetectorParameters::validate() const {
  table().check(*this);
}

std::vector<std::string> FeatureDetectorParameters::warnings() const {
  std::vector<std::string> warnings = table().warnings(*this);
  const double needed_px =
      std::ceil(3.0 * ppm * std::max(laser_range_sigma, kUsualRangeM * laser_angular_sigma));
  if (kernel_radius < needed_px) {
    warnings.push_back("kernel_radius = " + std::to_string(kernel_radius) +
                       " cuts the kernel off before three standard deviations at 10 m; it takes " +
                       std::to_string(static_cast<int>(needed_px)));
  }
  const double coarsest_ppm = std::ldexp(ppm, 1 - scale_levels);
  if (coarsest_ppm < kCoarsestPpm) {
    warnings.push_back("the coarsest of scale_levels = " + std::to_string(scale_levels) +
                       " levels has only " + ram_parameters::toPlainText(coarsest_ppm) +
                       " pixels per metre: expect features where there are none");
  }
  return warnings;
}

FeatureDetectorParameters readFeatureDetectorParameters(ram_parameters::ParameterReader& reader) {
  return FeatureDetectorParameters::table().readAll(reader);
}

}  // namespace ramscout_feature_detector
