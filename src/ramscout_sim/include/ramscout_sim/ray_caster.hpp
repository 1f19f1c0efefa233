// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// A half line in world axes; `direction` has length 1.
struct Ray {
  Eigen::Vector3f origin_m;
  Eigen::Vector3f direction;
};

/// Rays side by side, one per row, so that sixteen at a time are ready to be cast.
struct Rays {
  Rays() = default;
  explicit Rays(std::size_t count);
  // NOLINTNEXTLINE(google-explicit-constructor): the same in another order
  Rays(const std::vector<Ray>& rays);

  std::size_t size() const { return static_cast<std::size_t>(origins_m.rows()); }
  Ray operator[](std::size_t index) const;

  Eigen::MatrixX3f origins_m;
  Eigen::MatrixX3f directions;
};

/// Where a ray ends.
struct Hit {
  float distance_m = std::numeric_limits<float>::infinity();
  /// Of the surface, length 1; points out of the solid, for meshes to either side.
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  std::uint32_t material = 0;
  /// Part of a mesh, which has no inside: a ray can only enter.
  bool two_sided = false;
};

/// The widest vector instructions that ray casting may use. A processor without them uses what it
/// has. Results are the same to the bit; only on meshes those of different sets differ by
/// micrometres.
enum class InstructionSet { kSse42, kAvx, kAvx2, kAvx512 };

/// Finds what rays hit first: boxes, cylinders and spheres with a tree of its own, meshes with
/// Embree. Single thread.
class RayCaster {
public:
  static constexpr float kUnlimited_m = std::numeric_limits<float>::infinity();

  /// \throws std::runtime_error if Embree refuses
  explicit RayCaster(const World& world, InstructionSet widest = InstructionSet::kAvx2);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  /// Distance to the first surface (solids or floor) along each ray [m]; +Inf where there is none.
  /// \param farthest_m  surfaces that are farther away may be left out
  std::vector<float> cast(const Rays& rays, float farthest_m = kUnlimited_m) const;

  /// The same with the surface; slower.
  std::vector<Hit> trace(const Rays& rays, float farthest_m = kUnlimited_m) const;

  /// Whether a solid that is seen is not opaque.
  bool hasClearSurfaces() const { return has_clear_surfaces_; }
  const std::vector<Material>& materials() const { return materials_; }

private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
  std::vector<Material> materials_;
  bool has_clear_surfaces_ = false;
};

}  // namespace ramscout_sim
