// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/landmarks/constellation.hpp"
#include "ram_slam/landmarks/local_constellation.hpp"
#include "ram_slam/tracking/map_views.hpp"

namespace ram_slam {

/// The table explains the fields.
struct PlaceFinderParameters {
  int pairs_with_views = 3;
  int min_compared = 3;
  double max_contradiction_ratio = 0.04;
  double hopeless_ratio = 0.3;
  double sigma_m = 0.05;
  double sigma_rad = 0.02;
  int max_views = 12;
  int max_refining_views = 6;
  int max_refined = 4;
  /// Evidence of one landmark in all views together [nat]; views of one place are not independent.
  double looked_through_evidence = -2.0;
  double overlooked_evidence = -0.5;
  int min_sights = 2;

  static const ram_parameters::ParameterTable<PlaceFinderParameters>& table();
};

/// How much likelier a hypothesis about the pose gets [nat, at most 0], given the landmarks that
/// would have to be where the views show nothing.
/// \param paired  per landmark, whether the hypothesis pairs it with something seen
double missingLandmarksLogLikelihood(const Constellation& map,
                                     const std::vector<bool>& paired,
                                     const Pose2& map_from_base,
                                     const std::vector<LocalConstellation::PlacedView>& views,
                                     const PlaceFinderParameters& parameters = {});

/// What is to be found, and where.
struct PlaceQuery {
  const Constellation& map;
  const MapViews& map_views;
  const LocalConstellation& local;
  /// Where the robot is if what made it lost was an error: of places that are as good as each
  /// other this one is taken.
  std::optional<Pose2> expected;
};

/// Where in the map the robot is; none as long as no place is much likelier than all others.
///
/// Places are proposed by the features (matchConstellations()) and by the views
/// (MapViews::candidates()), each is judged by both: score = features that fit + landmarks that the
/// views should show and do not (missingLandmarksLogLikelihood()) + how the views agree with those
/// of the map (MapViews::judge()). The best is accepted if uniqueHypothesis() accepts it. Where the
/// map has views they have to agree, and then fewer features will do, since rooms that appear alike
/// to a few features seldom have the same walls.
std::optional<PoseWithCovariance2> findPlace(const PlaceQuery& query,
                                             const FeatureMatchers& matchers,
                                             const ConstellationParameters& constellation,
                                             const PlaceFinderParameters& parameters = {});

}  // namespace ram_slam
