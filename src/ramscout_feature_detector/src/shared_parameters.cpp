// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/shared_parameters.hpp"

#include <algorithm>

namespace ramscout_feature_detector {
namespace {

bool arePositiveAndAscending(const std::vector<double>& lengths_m) {
  return !lengths_m.empty() && lengths_m.front() > 0.0 &&
         std::is_sorted(lengths_m.begin(), lengths_m.end());
}

}  // namespace

const ram_parameters::ParameterTable<SegmentationParameters>& SegmentationParameters::table() {
  using namespace ram_parameters;
  using P = SegmentationParameters;
  static const auto table =
      ParameterTable<P>()
          .add("max_bridged_beams", &P::max_bridged_beams, "", within(0, 100),
               "Lone readings in a row across which a surface is continued.")
          .add("grazing_angle_rad", &P::grazing_angle_rad, "rad", between(0.0, M_PI_2),
               "Walls seen at this angle or steeper are not cut between two beams, however far "
               "apart their readings.")
          .add("lone_reading_m", &P::lone_reading_m, "m", positive(),
               "A reading farther in range than this from both neighbours lies on no surface: "
               "mixed pixel or noise.")
          .add("max_range_m", &P::max_range_m, "m", positive(),
               "Readings farther than this are not used.");
  return table;
}

const ram_parameters::ParameterTable<LineParameters>& LineParameters::table() {
  using namespace ram_parameters;
  using P = LineParameters;
  static const auto table =
      ParameterTable<P>()
          .add("noise_prior_points", &P::noise_prior_points, "", positive(),
               "So many points is the sensor's noise worth as a prior of the noise measured on a "
               "line.")
          .add("smoothing_half_width", &P::smoothing_half_width, "", within(0, 100),
               "Points on each side whose mean gives the smoothed contour, along which lengths are "
               "measured.")
          .add("refinements", &P::refinements, "", within(0, 10),
               "Rounds of regression along the beams.")
          .add("min_cos_incidence", &P::min_cos_incidence, "", aboveUpTo(0.0, 1.0),
               "Least cosine between beam and the line's normal in that regression: bounds the "
               "weight of grazing beams.");
  return table;
}

const ram_parameters::ParameterTable<TwoLineParameters>& TwoLineParameters::table() {
  using namespace ram_parameters;
  using P = TwoLineParameters;
  static const auto table =
      ParameterTable<P>()
          .add("split_window_m", &P::split_window_m, "m", positive(),
               "Length of the surroundings on each side of a split that two lines must describe "
               "better than one.")
          .add("split_spacing_m", &P::split_spacing_m, "m", positive(),
               "Of splits closer than this the one with the greatest improvement counts.")
          .add("leg_lengths_m", &P::leg_lengths_m,
               "Lengths of the legs that are tried, the longest straight one counts [m].")
          .rule(&P::leg_lengths_m, "positive and ascending",
                [](const P& p) { return arePositiveAndAscending(p.leg_lengths_m); })
          .add("shortest_leg_sigmas", &P::shortest_leg_sigmas, "", atLeast(0.0),
               "Legs shorter than this many laser_range_sigma have no direction.")
          .add("straight_sigma_ratio", &P::straight_sigma_ratio, "", positive(),
               "Straight: the residuals are those of noise of this many laser_range_sigma.")
          .add("straight_sigmas", &P::straight_sigmas, "", atLeast(0.0),
               "Standard deviations by which the chi square of a straight leg may exceed its mean.")
          .add("bent_splits", &P::bent_splits, "", within(2, 1000),
               "A leg is tested for a bend at this many places, less one.")
          .add("bent_significance", &P::bent_significance, "", atLeast(0.0),
               "Chi square (2 dof) by which two lines describe a leg that is bent better than one; "
               "14 is exceeded once in 1100 straight legs.")
          .add("cornerness_share", &P::cornerness_share, "", atLeast(0.0),
               "Share of corner_threshold asked of legs not yet trimmed: points counted to the "
               "wrong leg straighten it.")
          .add("significance_share", &P::significance_share, "", atLeast(0.0),
               "Share of significance_min asked of legs not yet trimmed.")
          .add("unseen_spacings", &P::unseen_spacings, "", atLeast(0.0),
               "A leg reaches the corner if no more than this many of its point spacings is "
               "missing, plus the next.")
          .add("unseen_sigmas", &P::unseen_sigmas, "", atLeast(0.0),
               "And this many laser_range_sigma.")
          .add("margin_sigmas", &P::margin_sigmas, "", atLeast(0.0),
               "Points closer to the other leg than this many laser_range_sigma are left out of a "
               "leg: noise decided to which they were counted.")
          .add("min_sin_opening", &P::min_sin_opening, "", between(0.0, 1.0),
               "Least sine of the angle between two lines that cross.")
          .add("min_cos_incidence", &P::min_cos_incidence, "", aboveUpTo(0.0, 1.0),
               "Least cosine of the incidence for which noise across a line is expected to shrink.")
          .add("model_variance_m2", &P::model_variance_m2, "m^2", atLeast(0.0),
               "Variance of the position that the model of straight legs leaves out, such as "
               "readings in steps of 1 mm.")
          .add("orientation_model_variance_rad2", &P::orientation_model_variance_rad2, "rad^2",
               atLeast(0.0), "The same of the orientation.")
          .section("line", &P::line, LineParameters::table());
  return table;
}

const ram_parameters::ParameterTable<MarkerParameters>& MarkerParameters::table() {
  using namespace ram_parameters;
  using P = MarkerParameters;
  static const auto table =
      ParameterTable<P>()
          .add("circle_steps", &P::circle_steps, "", within(3, 1000),
               "Line segments of an ellipse.")
          .add("line_width_m", &P::line_width_m, "m", positive(), "Width of lines.")
          .add("bisector_m", &P::bisector_m, "m", positive(), "Length of bisectors.")
          .add("max_orientation_variance_rad2", &P::max_orientation_variance_rad2, "rad^2",
               positive(),
               "Features whose orientation is less certain are drawn without bisector.");
  return table;
}

const ram_parameters::ParameterTable<DetectorNodeParameters>& DetectorNodeParameters::table() {
  using namespace ram_parameters;
  using P = DetectorNodeParameters;
  static const auto table =
      ParameterTable<P>()
          .add("base_frame", &P::base_frame,
               "Frame of the features; the mounting of the laser comes from tf.")
          .rule(&P::base_frame, "a frame without a leading slash",
                [](const P& p) { return !p.base_frame.empty() && p.base_frame.front() != '/'; })
          .expert("Node")
          .add("max_lasers", &P::max_lasers, "", within(1, 1000),
               "Laser frames whose mountings are kept; scans of more are refused.")
          .add("log_period_s", &P::log_period_s, "s", positive(),
               "The same warning is logged at most once in this time.")
          .section("markers", &P::markers, MarkerParameters::table());
  return table;
}

}  // namespace ramscout_feature_detector
