// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <embree3/rtcore.h>

#include "ramscout_sim/ray_caster.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// Embree's tree of the triangles of meshes, which are watertight (a robust scene) and hit from
/// both sides. Rays go through it sixteen at a time (AVX-512) or eight.
class MeshScene {
public:
  /// \param meshes  at least one
  /// \throws std::runtime_error if Embree refuses
  MeshScene(std::vector<Solid> meshes, InstructionSet widest);
  ~MeshScene();
  MeshScene(const MeshScene&) = delete;
  MeshScene& operator=(const MeshScene&) = delete;

  /// Shortens the distances of those rays that meet a mesh earlier, and no farther away.
  void cast(const Rays& rays, float farthest_m, std::vector<float>& distances_m) const;

  /// The same for hits.
  void trace(const Rays& rays, float farthest_m, std::vector<Hit>& hits) const;

private:
  void attach(unsigned number);
  template <typename Distance, typename Use>
  void eachPacket(const Rays& rays, const Distance& limit_m, const Use& use) const;
  template <typename Packet, typename Distance, typename Use>
  void eachPacketOf(const Rays& rays, const Distance& limit_m, const Use& use) const;

  std::vector<Solid> meshes_;  // by Embree's number of their geometry
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

}  // namespace ramscout_sim
