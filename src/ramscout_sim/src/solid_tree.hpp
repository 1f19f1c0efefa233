// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ramscout_sim/ray_caster.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// A tree of boxes, cylinders and spheres, made for the rays of planar lidars: neighbouring beams
/// lie in a narrow wedge that stands upright, and what is outside the wedge is left out for all of
/// them at once. Rays in any other direction are right as well, but go one by one.
///
/// Upright boxes are met in single precision, in vector code; results are the same to the bit
/// whatever the vector instructions, as none fuses multiplication and addition. On all else, and
/// where a ray grazes a surface or starts inside, rays end where intersect() puts them.
class SolidTree {
public:
  /// \param solids  no meshes; the first is a floor under all others
  explicit SolidTree(std::vector<Solid> solids);

  /// What a ray hits first.
  struct Result {
    std::vector<float> distances_m;    ///< +Inf for none
    std::vector<std::int32_t> solids;  ///< which of the solids; -1 for none
  };
  /// \param farthest_m  what is farther away may be left out
  Result cast(const Rays& rays, float farthest_m, InstructionSet widest) const;

  const Solid& operator[](std::size_t index) const { return solids_[index]; }

  static constexpr int kChildren = 16;

  /// The upright boxes around its children, and which they are.
  struct alignas(64) Node {
    using Lanes = std::array<float, kChildren>;
    // Lowest and highest x and y; `bounds[0]` is x from, `bounds[1]` x to, then y.
    std::array<Lanes, 4> bounds_m;
    Lanes low_z_m;
    Lanes high_z_m;
    std::array<std::int32_t, kChildren> child;  // >= 0: a node; < 0: ~index of a solid
  };

  /// A solid as the vector code sees it.
  struct Body {
    float x_m, y_m, z_m;  // center
    float cos_yaw, sin_yaw;
    float half_x_m, half_y_m, half_z_m;
    bool upright_box;
  };

private:
  std::vector<Solid> solids_;
  std::vector<Body> bodies_;
  std::vector<Node> nodes_;  // the root first; of all solids but the floor
  double overlap_m_;
};

}  // namespace ramscout_sim
