// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ode_objects.hpp"

namespace ramscout_sim {

/// What wheels and casters stand on: the floor z = 0, ramps and other solids that can be driven on.
class Ground {
public:
  explicit Ground(const World& world);

  /// Fills in where a ball touches it deepest, with the normal towards the ball; false if it
  /// touches nothing.
  bool touch(const Eigen::Vector3d& center_m, double radius_m, dContactGeom& contact) const;

private:
  bool is_even_ = true;
  SpaceHandle solids_;
  GeomHandle ball_;
};

}  // namespace ramscout_sim
