// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// A half line in world axes; `direction` has length 1.
struct Ray {
  Eigen::Vector3f origin_m;
  Eigen::Vector3f direction;
};

/// Finds what rays hit first (Embree, single thread, instruction set pinned to AVX2 or below so
/// that results agree between processors of that kind).
class RayCaster {
public:
  /// \throws std::runtime_error if Embree refuses
  explicit RayCaster(const World& world);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  /// Distance to the first surface (solids or floor) along each ray [m]; +Inf where there is none.
  std::vector<float> cast(const std::vector<Ray>& rays) const;

private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace ramscout_sim
