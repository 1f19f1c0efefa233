// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "ram_slam/landmarks/constellation.hpp"
#include "ram_slam/tracking/local_constellation.hpp"
#include "ram_slam/tracking/map_views.hpp"

namespace ram_slam {

/// Where in the map the robot is; none as long as no place is much likelier than all others.
///
/// Places are proposed by the features (matchConstellations()) and by the views
/// (MapViews::candidates()), each is judged by both: score = features that fit + landmarks that the
/// views should show and do not (contradiction()) + how the views agree with those of the map
/// (MapViews::judge()). The best is accepted if uniqueHypothesis() says so. Where the map has views
/// they have to agree, and then fewer features will do, since rooms that look alike to a few
/// features seldom have the same walls. \param expected  where the robot is if what made it lost
/// was an error: of places that are as good as each other this one is taken
std::optional<PoseWithCovariance2> findPlace(const Constellation& map,
                                             const LocalConstellation& local,
                                             const MapViews& map_views,
                                             const std::optional<Pose2>& expected,
                                             const FeatureMatchers& matchers,
                                             const ConstellationParameters& parameters);

}  // namespace ram_slam
