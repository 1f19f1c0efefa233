// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "ramscout_sim/lidar.hpp"

namespace ramscout_sim {

/// Whether a scan of this lidar needs more than the distance to the first surface.
bool needsEffects(const LidarParameters& lidar,
                  const RayCaster& world,
                  const std::vector<Solid>& moving);

/// A scan's light: the rays, and what they may meet.
struct Illumination {
  const Rays& rays;
  const RayCaster& world;
  const std::vector<Solid>& moving;
  const std::vector<BeamWindow>& windows;
};

/// Distances that the light of each beam measures, before noise: through glass and along mirrors,
/// mixed at edges, +Inf where too little comes back.
///
/// \param first_reading  index of the first beam's reading in the run; with `seed` it keys the
/// random decisions
std::vector<float> illuminate(const Illumination& scan,
                              const LidarParameters& lidar,
                              std::uint64_t seed,
                              std::uint64_t first_reading);

}  // namespace ramscout_sim
