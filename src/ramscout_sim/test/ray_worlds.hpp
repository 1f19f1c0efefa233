// SPDX-License-Identifier: BSD-3-Clause
// Worlds to cast rays in.
#pragma once

#include <algorithm>

#include "ramscout_sim/random.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim::testing {

/// Solids of every shape, in every attitude.
inline World clutter() {
  Random random(3, Stream::kBuilding);
  World world;
  for (int i = 0; i < 60; ++i) {
    Solid solid;
    solid.shape = i % 3 == 0 ? Shape::kBox : i % 3 == 1 ? Shape::kCylinder : Shape::kSphere;
    const double width_m = random.uniform(0.1, 1.0);
    solid.size_m = {width_m, width_m,
                    solid.shape == Shape::kSphere ? width_m : random.uniform(0.5, 2.0)};
    solid.world_from_solid.translate(Eigen::Vector3d(
        random.uniform(-10, 10), random.uniform(-10, 10), random.uniform(0.3, 0.8)));
    solid.world_from_solid.rotate(
        Eigen::AngleAxisd(random.uniform(-3, 3), Eigen::Vector3d::UnitZ()));
    if (solid.shape == Shape::kBox)
      solid.world_from_solid.rotate(
          Eigen::AngleAxisd(random.uniform(-1, 1), Eigen::Vector3d::UnitY()));
    world.solids.push_back(solid);
  }
  return world;
}

inline void removeAllButBoxes(World& world) {
  world.solids.erase(std::remove_if(world.solids.begin(), world.solids.end(),
                                    [](const Solid& s) { return s.shape != Shape::kBox; }),
                     world.solids.end());
}

}  // namespace ramscout_sim::testing
