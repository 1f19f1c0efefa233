// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "ramscout_sim/ray_caster.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// Where a ray enters a box, cylinder or sphere (exact, in double precision), or leaves it if it
/// starts inside; nothing if it misses. Meshes are missed.
std::optional<Hit> intersect(const Ray& ray, const Solid& solid);

/// Half-open range of beams that can meet solid number `solid`.
struct BeamWindow {
  std::size_t solid = 0;
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Shortens the ranges of those rays that meet a solid earlier.
void castMoving(const Rays& rays,
                const std::vector<Solid>& solids,
                const std::vector<BeamWindow>& windows,
                std::vector<float>& ranges_m);

/// The same for hits.
void traceMoving(const Rays& rays,
                 const std::vector<Solid>& solids,
                 const std::vector<BeamWindow>& windows,
                 std::vector<Hit>& hits);

}  // namespace ramscout_sim
