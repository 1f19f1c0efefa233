// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// Triangles of all solids that answer light in the same way, world axes.
struct Triangles {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<unsigned, 3>> triangles;
  /// Of a curved kind: the solids, and by triangle which of them it stands for.
  std::vector<Solid> solids;
  std::vector<std::size_t> solid_by_triangle;

  void addQuad(const std::array<Eigen::Vector3d, 4>& corners);
};

/// How a surface answers light.
struct SurfaceKind {
  std::uint32_t material = 0;
  bool two_sided = false;
  bool curved = false;  ///< cylinders and spheres, which triangles only stand for
  bool operator<(const SurfaceKind& other) const {
    return std::tie(material, two_sided, curved) <
           std::tie(other.material, other.two_sided, other.curved);
  }
};

/// Surfaces of all solids that are seen, and of the floor, which reaches far beyond them.
std::map<SurfaceKind, Triangles> trianglesOf(const World& world);

}  // namespace ramscout_sim
