// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ram_slam/fast_slam/landmark_tree.hpp"
#include "ram_slam/fast_slam/parameters.hpp"
#include "ram_slam/geometry/random.hpp"
#include "ram_slam/landmarks/landmark.hpp"

namespace ram_slam {

/// A landmark that a feature may show, the same for all particles: near enough for some particle,
/// of the same type.
struct AssociationCandidate {
  LandmarkId id = 0;
  bool confirmed = false;             ///< may correct the pose
  double log_likelihood_ratio = 0.0;  ///< of the classifiers
};

/// One feature as all particles see it.
struct Observation {
  std::string type;
  PointMeasurement measured;
  std::vector<AssociationCandidate> candidates;
};

/// What a particle associates a feature with.
enum class AssociationOutcome {
  kMatched,  ///< a landmark seen again
  kNew,      ///< something seen for the first time
  kIgnored,  ///< neither is certain enough: no use is made of it
};
struct Association {
  AssociationOutcome outcome = AssociationOutcome::kIgnored;
  LandmarkId id = 0;  ///< of the landmark, if matched
};

/// What one particle concludes from the features of one reading.
struct Evidence {
  PoseWithCovariance2
      map_from_base;  ///< with the confirmed landmarks among the matched taken into account
  double log_likelihood_ratio =
      0.0;  ///< of the features, to their showing things unknown: the weight
  std::vector<Association> associations;  ///< one per observation
  double squared_mahalanobis = 0.0;       ///< sum over the features that corrected the pose
  int correction_count = 0;               ///< their number

  bool hasMatched(LandmarkId id) const;
};

/// How well features have been matched recently.
struct MatchQuality {
  double matched_fraction = 1.0;  ///< of the features that were landmarks seen again
  double normalised_innovation =
      1.0;                ///< squared Mahalanobis distance per degree of freedom; 1 is expected
  int matched_count = 0;  ///< of the last list
  int new_count = 0;
  int ignored_count = 0;

  /// \param memory  weight of the past in the running means, in [0, 1]
  void add(const Evidence& evidence, double memory);
};

/// FastSLAM 2.0: associates by position (Mahalanobis distance within the gate) and classifier, each
/// landmark at most once, and corrects the pose by one confirmed landmark after the other, the
/// most certain first. What was uncertain is associated again from the corrected pose; what stays
/// uncertain is sampled in proportion to the likelihoods, so that particles come to differ and
/// later readings choose among them. (Montemerlo et al., IJCAI 2003; the weight is the product of
/// the innovations' densities, each over the density of unknown features; with `draw_jointly` that
/// of sampled pairs is the sum over all ways to pair them.) \param random  for this
/// particle and reading alone
Evidence associate(const std::vector<Observation>& observations,
                   const LandmarkTree& landmarks,
                   const PoseWithCovariance2& map_from_base,
                   const FastSlamParameters& parameters,
                   Random random);

/// The same without samples: what stays uncertain is ignored. For filters that hold one hypothesis.
Evidence associateCertain(const std::vector<Observation>& observations,
                          const LandmarkTree& landmarks,
                          const PoseWithCovariance2& map_from_base,
                          const FastSlamParameters& parameters);

/// FastSLAM 1.0 as the source describes it: the nearest landmark is matched below
/// `feature_match_distance`, the feature is new beyond `minimum_feature_separation`, and ignored
/// between; the pose stays as it is.
Evidence associateByDistance(const std::vector<Observation>& observations,
                             const LandmarkTree& landmarks,
                             const Pose2& map_from_base,
                             const FastSlamParameters& parameters);

}  // namespace ram_slam
