// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "ramscout_feature_detector/edge.hpp"

namespace ramscout_feature_detector {

const ram_parameters::ParameterTable<EndParameters>& EndParameters::table() {
  using namespace ram_parameters;
  using P = EndParameters;
  static const auto table =
      ParameterTable<P>()
          .add("tangent_length_m", &P::tangent_length_m, "m", positive(),
               "Length of the end of a surface whose tangent stands for its last leg if none is "
               "straight.")
          .add("continuation_sigmas", &P::continuation_sigmas, "", atLeast(0.0),
               "A reading within so many standard deviations of a line's prolongation may lie on "
               "it: no end.")
          .add("few_points", &P::few_points, "", within(0, 1000),
               "Legs of so few points or less: noise decided which points belong to them, their "
               "sampling variance is doubled.")
          .add("wall_spacings", &P::wall_spacings, "", atLeast(0.0),
               "A wall that leaves this many point spacings from where an end is expected, plus "
               "the next, meets it.")
          .add("wall_sigmas", &P::wall_sigmas, "", atLeast(0.0), "And this many laser_range_sigma.")
          .add("corner_reach_m", &P::corner_reach_m, "m", atLeast(0.0),
               "Ends closer than this to a corner are a worse description of it and left out.");
  return table;
}

const ram_parameters::ParameterTable<ObjectParameters>& ObjectParameters::table() {
  using namespace ram_parameters;
  using P = ObjectParameters;
  static const auto table = ParameterTable<P>()
                                .add("min_points", &P::min_points, "", within(1, 1000),
                                     "Surfaces of fewer points are no object.")
                                .add("depth_share", &P::depth_share, "", atLeast(0.0),
                                     "Where the middle of a thing is behind what is seen, in "
                                     "widths: of square and round posts from all sides.")
                                .add("depth_sigma_share", &P::depth_sigma_share, "", atLeast(0.0),
                                     "Standard deviation of that along the beam, in widths.")
                                .add("side_sigma_share", &P::side_sigma_share, "", atLeast(0.0),
                                     "Standard deviation across the beam, in widths.");
  return table;
}

const ram_parameters::ParameterTable<BendParameters>& BendParameters::table() {
  using namespace ram_parameters;
  using P = BendParameters;
  static const auto table =
      ParameterTable<P>()
          .add("corner_gain", &P::corner_gain, "", atLeast(0.0),
               "Chi square by which two straight lines must describe a corner better than one, at "
               "the most suitable of many points.")
          .add("bend_gain", &P::bend_gain, "", atLeast(0.0), "The same for other bends.")
          .add("max_crossing_m", &P::max_crossing_m, "m", atLeast(0.0),
               "A bend is where its arms cross if that is closer than this to where it turns, else "
               "where it turns.")
          .add("ragged_variance_m2", &P::ragged_variance_m2, "m^2", atLeast(0.0),
               "Variance added to positions of ragged or rounded edges (2 cm).")
          .add("ragged_orientation_variance_rad2", &P::ragged_orientation_variance_rad2, "rad^2",
               atLeast(0.0), "The same of their orientations.");
  return table;
}

const ram_parameters::ParameterTable<EdgeDetectorParameters>& EdgeDetectorParameters::table() {
  using namespace ram_parameters;
  using P = EdgeDetectorParameters;
  static const auto table =
      ParameterTable<P>()
          .add("laser_range_sigma", &P::laser_range_sigma, "m", within(1e-4, 1.0),
               "Standard deviation of a range reading.")
          .add("distance_threshold", &P::distance_threshold, "m", within(0.01, 10.0),
               "Neighbours farther apart belong to different surfaces (more on grazing walls).")
          .add("object_size", &P::object_size, "m", within(0.0, 2.0),
               "Smaller free-standing things are one feature at their middle.")
          .add("bend_scale", &P::bend_scale, "m", within(0.02, 2.0),
               "Length of the two arms between which a bend is measured where there are no "
               "straight legs.")
          .add("bend_angle", &P::bend_angle, "rad", within(0.1, M_PI),
               "Least change of direction at a bend.")
          .add("significance_min", &P::significance_min, "", within(0.0, 1e6),
               "Least chi square (1 dof) of the bend against the noise.")
          .add("position_sigma_limit", &P::position_sigma_limit, "m", within(1e-4, 10.0),
               "Largest standard deviation of the position in any direction; beams far apart or "
               "grazing make it large.")
          .add("feature_distance", &P::feature_distance, "m", within(0.01, 10.0),
               "Of features closer than this the first is kept, in the order objects, corners, "
               "ends, bends.")
          .add("max_features", &P::max_features, "", within(1, 1000), "Features per scan.")
          .heading("Frames")
          .include(&P::node, DetectorNodeParameters::table())
          .expert("Tuning")
          .add("corner_threshold", &P::corner_threshold, "", within(0.005, 0.5),
               "Least 1/2 (1 - |cos(opening)|) of a corner of straight legs: 0.08 is an opening of "
               "147 deg.")
          .section("ends", &P::ends, EndParameters::table())
          .section("objects", &P::objects, ObjectParameters::table())
          .section("bends", &P::bends, BendParameters::table())
          .section("segmentation", &P::segmentation, SegmentationParameters::table())
          .section("two_lines", &P::two_lines, TwoLineParameters::table());
  return table;
}

void EdgeDetectorParameters::validate() const {
  table().check(*this);
}

EdgeDetectorParameters readEdgeDetectorParameters(ram_parameters::ParameterReader& reader) {
  return EdgeDetectorParameters::table().readAll(reader);
}

}  // namespace ramscout_feature_detector
