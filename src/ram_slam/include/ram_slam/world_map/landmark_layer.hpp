// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_slam/landmarks/landmark_map.hpp"
#include "ram_slam/world_map/world_map.hpp"

namespace ram_slam {

/// An estimator's landmarks as the feature layer of a world map, each with the stamp at which it
/// was first put into the map, without their cross-covariances.
LandmarkLayer toLandmarkLayer(const LandmarkMap& map);

/// The planar landmarks of a stored map, without their cross-covariances. The layer does
/// not hold when they were put into the map, so `placed_ns` is 0.
LandmarkMap toLandmarkMap(const LandmarkLayer& layer);

}  // namespace ram_slam
