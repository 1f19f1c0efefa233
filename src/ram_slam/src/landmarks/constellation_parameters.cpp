// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "ram_slam/landmarks/constellation.hpp"

namespace ram_slam {

const ram_parameters::ParameterTable<ConstellationParameters::Search>&
ConstellationParameters::Search::table() {
  using P = ConstellationParameters::Search;
  using namespace ram_parameters;
  static const auto table =
      ParameterTable<P>()
          .add("max_putatives", &P::max_putatives, "", atLeast(2),
               "Pairs of points that may be the same, the most alike first.")
          .add("max_votes", &P::max_votes, "", atLeast(1), "Poses that two of these pairs give.")
          .add("max_scored", &P::max_scored, "", atLeast(1), "Poses that are scored and refined.")
          .add("refinements", &P::refinements, "", atLeast(0),
               "Rounds of weighted least squares, at most.")
          .add("pair_gate", &P::pair_gate, "", positive(),
               "Squared Mahalanobis distance of a pair, at most. 9.21 is 99 % of chi-squared with "
               "2 degrees of freedom.")
          .add("max_pair_distance_m", &P::max_pair_distance_m, "m", positive(),
               "Distance of a pair, at most.")
          .add("rigidity_sigmas", &P::rigidity_sigmas, "", positive(),
               "Standard deviations by which distances in both may differ.")
          .add("vote_cell_m", &P::vote_cell_m, "m", positive(), "Cells in which poses vote.")
          .add("vote_cell_rad", &P::vote_cell_rad, "rad", positive(), "The same of the yaw.")
          .add("vote_base", &P::vote_base, "nat", anyNumber(),
               "Weight of a vote before appearance and orientation count.")
          .add("min_vote", &P::min_vote, "nat", positive(), "Least weight of a vote.")
          .add("orientation_sigma_rad", &P::orientation_sigma_rad, "rad", positive(),
               "Of things as they are, beyond what detectors state.")
          .add("wrong_orientations", &P::wrong_orientations, "", between(0.0, 1.0),
               "Share of the orientations that are plainly wrong.")
          .add("chance_cell_sigmas", &P::chance_cell_sigmas, "", positive(),
               "Poses that differ by so many position_sigma are clearly different ...")
          .add("chance_arm_m", &P::chance_arm_m, "m", positive(),
               "... and so are turns that move a point at this distance by as much.");
  return table;
}

const ram_parameters::ParameterTable<ConstellationParameters>& ConstellationParameters::table() {
  using P = ConstellationParameters;
  using namespace ram_parameters;
  static const auto table =
      ParameterTable<P>()
          .add("position_sigma", &P::position_sigma, "m", positive(),
               "The features are matched with the landmarks: standard deviation per axis of both "
               "beyond the stated one, for drift and what detectors do.")
          .add("minimum_baseline", &P::minimum_baseline, "m", positive(),
               "Two features nearer to each other than this give no direction.")
          .add("minimum_pairs", &P::minimum_pairs, "", atLeast(2),
               "A place is accepted with so many pairs ...")
          .add("minimum_overlap", &P::minimum_overlap, "", within(0.0, 1.0),
               "... that are at least this share of the features, ...")
          .add("minimum_score", &P::minimum_score, "nat", atLeast(0.0),
               "... with a score this much better than chance ...")
          .add("minimum_lead", &P::minimum_lead, "nat", atLeast(0.0),
               "... and than the second best place; twice in a row.")
          .expert("Matching of constellations")
          .add("minimum_likeness", &P::minimum_likeness, "nat", anyNumber(),
               "Pairs whose appearance is less alike than this start no hypothesis.")
          .rule(&P::minimum_likeness, "finite",
                [](const P& p) { return std::isfinite(p.minimum_likeness); })
          .add("unknown_feature_density", &P::unknown_feature_density, "1/m^2", positive(),
               "Of points that have no partner.")
          .add("expected_overlap", &P::expected_overlap, "", between(0.0, 1.0),
               "Share of the features that the map is expected to hold.")
          .add("most_hypotheses", &P::most_hypotheses, "", atLeast(2), "That are returned.")
          .add("distinct_distance", &P::distinct_distance, "m", positive(),
               "A hypothesis nearer to a better one than this ...")
          .add("distinct_angle", &P::distinct_angle, "rad", positive(), "... and this is the same.")
          .section("constellation_search", &P::search, Search::table());
  return table;
}

}  // namespace ram_slam
