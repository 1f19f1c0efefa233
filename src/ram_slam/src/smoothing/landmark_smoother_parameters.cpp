// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/landmark_smoother_parameters.hpp"

namespace ram_slam {

const ram_parameters::ParameterTable<PerturbationParameters>& PerturbationParameters::table() {
  using namespace ram_parameters;
  using P = PerturbationParameters;
  static const auto table =
      ParameterTable<P>()
          .expert("Attempts to agree better")
          .add("shift_deviation_m", &P::shift_deviation_m, "m", positive(),
               "Standard deviation of the shift of a part of the drive, per axis.")
          .add("removal_share", &P::removal_share, "", within(0.0, 1.0),
               "Share of the attempts that leave out a landmark; the others shift.")
          .add("rounds_after_perturbation", &P::rounds_after_perturbation, "", atLeast(1),
               "Rounds of pairing and least squares in each attempt.")
          .add("min_gain", &P::min_gain, "nat", atLeast(0.0),
               "By how much an attempt must agree better to be kept.");
  return table;
}

const ram_parameters::ParameterTable<LandmarkSmootherParameters>&
LandmarkSmootherParameters::table() {
  using namespace ram_parameters;
  using P = LandmarkSmootherParameters;
  static const auto table =
      ParameterTable<P>()
          .add("map_frame", &P::map_frame, "Frame of the estimator's trajectory and landmarks.")
          .add("base_frame", &P::base_frame, "Frame of the features.")
          .add("reading_share", &P::reading_share, "", aboveUpTo(0.0, 1.0),
               "Share of a feature's information that is new: errors of successive readings are "
               "alike.")
          .add("robust_chi2", &P::robust_chi2, "", positive(),
               "Squared Mahalanobis distance at which a feature counts half.")
          .heading("Pairing of features with landmarks, in rounds with least squares in between")
          .add("association_gate", &P::association_gate, "", positive(),
               "Largest squared Mahalanobis distance of a pair.")
          .add("first_deviation_m", &P::first_deviation_m, "m", positive(),
               "Standard deviation of landmarks in the first round, per axis; it shrinks from "
               "round to round.")
          .rule(&P::first_deviation_m, ">= last_deviation_m",
                [](const P& p) { return p.first_deviation_m >= p.last_deviation_m; })
          .add("last_deviation_m", &P::last_deviation_m, "m", positive(),
               "Standard deviation of landmarks in the last round, per axis.")
          .add("round_count", &P::round_count, "", atLeast(1),
               "Rounds of pairing and least squares.")
          .add("least_evidence", &P::least_evidence, "nat", positive(),
               "What a landmark must explain beyond what its neighbours do; others are removed.")
          .add("attempt_count", &P::attempt_count, "", atLeast(0),
               "Attempts to agree better with a landmark left out or a part of the drive shifted; "
               "each takes three rounds.")
          .expert("Node")
          .add("motion_patience_s", &P::motion_patience_s, "s", atLeast(0.0),
               "Features whose motion is unknown are left out once features so much newer have "
               "arrived.")
          .expert("Least squares")
          .add("rounds_between_revisions", &P::rounds_between_revisions, "", atLeast(1),
               "After so many rounds landmarks are removed and made.")
          .add("max_iterations", &P::max_iterations, "", atLeast(1),
               "Most iterations of one least-squares solution.")
          .add("precision", &P::precision, "", positive(),
               "Relative change of the cost at which a solution ends.")
          .add("rest_deviation_m", &P::rest_deviation_m, "m", positive(),
               "Added to the odometry's deviation, which may be 0 for a robot at rest.")
          .add("rest_deviation_rad", &P::rest_deviation_rad, "rad", positive(),
               "Added to the odometry's deviation, which may be 0 for a robot at rest.")
          .include(&P::perturbation, PerturbationParameters::table());
  return table;
}

LandmarkSmootherParameters readLandmarkSmootherParameters(ram_parameters::ParameterReader& reader) {
  return LandmarkSmootherParameters::table().readAll(reader);
}

}  // namespace ram_slam
