// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/landmarks/feature_matcher.hpp"

namespace ram_slam {

/// Something at a place in some planar frame, and its appearance.
struct ConstellationPoint {
  std::string type;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Zero();
  std::vector<DescriptorPointer> descriptors;  ///< empty: no evidence by appearance
  double orientation_rad = 0.0;
  double orientation_variance_rad2 = 1e6;  ///< 1e6: not observed
};

/// Features whose positions relative to each other are known: a landmark map, or what a robot has
/// seen recently.
using Constellation = std::vector<ConstellationPoint>;

/// The table explains the fields.
struct ConstellationParameters {
  double position_sigma = 0.08;
  double minimum_baseline = 1.5;
  double minimum_likeness = -1.0;
  double unknown_feature_density = 0.05;
  double expected_overlap = 0.7;
  int most_hypotheses = 10;
  double distinct_distance = 1.0;
  double distinct_angle = 0.2;

  /// Of uniqueHypothesis().
  int minimum_pairs = 4;
  double minimum_score = 10.0;
  double minimum_lead = 6.0;
  double minimum_overlap = 0.45;

  /// How the search goes about it.
  struct Search {
    int max_putatives = 2000;
    int max_votes = 200000;
    int max_scored = 150;
    int refinements = 4;
    double pair_gate = 9.21;
    double max_pair_distance_m = 2.0;
    double rigidity_sigmas = 3.0;
    double vote_cell_m = 0.5;
    double vote_cell_rad = 0.15;
    double vote_base = 1.5;
    double min_vote = 0.1;
    double orientation_sigma_rad = 0.07;
    double wrong_orientations = 0.1;
    double chance_cell_sigmas = 4.0;
    double chance_arm_m = 5.0;
    static const ram_parameters::ParameterTable<Search>& table();
  };
  Search search;

  static const ram_parameters::ParameterTable<ConstellationParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// A point of the target and one of the source that are taken for the same thing.
struct ConstellationPair {
  std::size_t target = 0;
  std::size_t source = 0;
};

/// A way to lay one constellation over another.
struct PoseHypothesis {
  PoseWithCovariance2 target_from_source;
  /// Log-likelihood ratio [nat] to the two having nothing to do with each other.
  double score = 0.0;
  std::vector<ConstellationPair> pairs;
};

/// The most likely poses of one constellation in another, best first, each distinct from those
/// before it.
///
/// Two pairs of points whose distances agree fix a pose (rotation and translation, never a
/// mirror image); poses vote in a grid, the ones with most votes are scored and refined by
/// weighted least squares. The score of a pose is the sum over one-to-one pairs of
/// ln N(difference; 0, S) + ln L + ln O - ln(density) + ln(overlap), L the likelihood ratio of the
/// classifiers and O that of the orientations, and of ln(1 - overlap) over source points without a
/// partner. Deterministic; the cost is bounded whatever the input.
///
/// \param matchers  by type; a type without one is compared by geometry alone
/// \throws std::invalid_argument as ConstellationParameters::validate(), or if a position or
/// covariance is not finite
std::vector<PoseHypothesis> matchConstellations(const Constellation& target,
                                                const Constellation& source,
                                                const FeatureMatchers& matchers,
                                                const ConstellationParameters& parameters);

/// What matchConstellations() would make of the source if it lay there: the same score, after the
/// same refinement. \throws as matchConstellations()
PoseHypothesis hypothesisAt(const Constellation& target,
                            const Constellation& source,
                            const FeatureMatchers& matchers,
                            const ConstellationParameters& parameters,
                            const Pose2& target_from_source);

/// The logarithm of how many clearly different poses a source can have in that target: what the
/// best of so many chance hits is expected to score.
double chanceScore(const Constellation& target, const ConstellationParameters& parameters);

/// The best of the hypotheses if it is good enough and no other comes near it, otherwise null.
/// \param hypotheses  in any order
/// \param source_size  number of points of the source
/// \param chance_score  from chanceScore()
const PoseHypothesis* uniqueHypothesis(const std::vector<PoseHypothesis>& hypotheses,
                                       std::size_t source_size,
                                       double chance_score,
                                       const ConstellationParameters& parameters);

/// The rotation and translation that bring the sources onto the targets with the least weighted
/// squared error: yaw = atan2(sum w a x b, sum w a . b) about the centroids. \throws
/// std::invalid_argument for fewer than two points, different counts, or weights that are not
/// positive
Pose2 alignPoints(const std::vector<Eigen::Vector2d>& targets_m,
                  const std::vector<Eigen::Vector2d>& sources_m,
                  const std::vector<double>& weights);

}  // namespace ram_slam
