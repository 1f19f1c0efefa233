// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include <embree3/rtcore.h>

#include "ramscout_sim/ray_caster.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// Embree's tree of what can be seen in a world, and which solid each of its surfaces belongs to.
///
/// Boxes are triangles, hit from either side: a ray that seems to hit one from inside either
/// started there or has slipped through an edge, where the triangles of two faces do not quite
/// meet; the box itself then tells how far it goes. Watertight triangles (Embree's robust scenes)
/// would cost a quarter of the speed; only meshes, which have no inside, get them. Cylinders and
/// spheres are not triangles: on them rays end where intersect() says.
class RayScene {
public:
  /// \throws std::runtime_error if Embree refuses
  RayScene(const World& world, InstructionSet widest);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  RTCScene tree() const { return scene_; }
  /// Whether packets of sixteen rays are the fastest here, and not those of eight.
  bool takesSixteen() const { return takes_sixteen_; }

  // By Embree's numbers of a hit.
  static bool isBox(unsigned geometry) { return geometry == kBoxes; }
  static bool isMesh(unsigned geometry) {
    return geometry >= kFirstMesh && geometry != RTC_INVALID_GEOMETRY_ID;
  }
  const Solid& solidOf(unsigned geometry, unsigned primitive) const {
    if (geometry == kBoxes) return boxes_[primitive / kTrianglesPerBox];
    if (geometry == kCurved) return curved_[primitive];
    return meshes_[geometry - kFirstMesh];
  }

private:
  static constexpr unsigned kBoxes = 0;
  static constexpr unsigned kCurved = 1;
  static constexpr unsigned kFirstMesh = 2;
  static constexpr unsigned kTrianglesPerBox = 12;

  void attachBoxes();
  void attachCurved();
  void attachMesh(const Solid& mesh, unsigned number);
  void attachTriangles(const std::vector<Eigen::Vector3d>& corners,
                       const std::vector<std::array<unsigned, 3>>& triangles,
                       unsigned number);
  void attach(RTCGeometry geometry, unsigned number);

  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  bool takes_sixteen_ = false;
  std::vector<Solid> boxes_;   // the floor first
  std::vector<Solid> curved_;  // cylinders and spheres
  std::vector<Solid> meshes_;
};

/// As parseInstructionSet reads it and Embree calls it.
const char* nameOf(InstructionSet set);

}  // namespace ramscout_sim
