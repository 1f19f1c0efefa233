// SPDX-License-Identifier: BSD-3-Clause
// Rays side by side and the wedge that holds them, for solid_tree.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "ramscout_sim/ray_caster.hpp"

#include "precision.hpp"

/// What rays go through is inlined into one function per set of vector instructions.
#define RAMSCOUT_SIM_INLINE [[gnu::always_inline]] static inline

namespace ramscout_sim {

/// Neighbouring rays and what they hit so far.
template <int kRays>
struct alignas(64) Packet {
  float origin_x[kRays], origin_y[kRays], origin_z[kRays];
  float direction_x[kRays], direction_y[kRays], direction_z[kRays];
  float inverse_z[kRays];
  float distance[kRays];
  std::int32_t solid[kRays];
};

/// What holds all rays of a packet, seen from above two half planes: points p with
/// (left_x, left_y) p <= left and (right_x, right_y) p <= right [m].
struct Wedge {
  float left_x, left_y, left;
  float right_x, right_y, right;
  float forward_x, forward_y;  ///< the middle of the rays, length 1
  float foremost, rearmost;    ///< of the origins along it [m]
  float low_z, high_z;         ///< of the origins [m]
  float down, up;  ///< lowest slope, at most 0, and highest, at least 0, per metre forward
};

/// Nothing is hit yet.
template <int kRays>
RAMSCOUT_SIM_INLINE void reset(float farthest_m, Packet<kRays>& packet) {
  for (int i = 0; i < kRays; ++i) {
    packet.inverse_z[i] = 1.0F / nonzero(packet.direction_z[i]);
    packet.distance[i] = farthest_m;
    packet.solid[i] = -1;
  }
}

/// `count` rays from `first` on; the last one fills up.
template <int kRays, typename Count>
RAMSCOUT_SIM_INLINE void load(
    const Rays& rays, Eigen::Index first, Count count, float farthest_m, Packet<kRays>& packet) {
  const auto& [origins_m, directions] = rays;
  const float* const from[6] = {origins_m.col(0).data(),  origins_m.col(1).data(),
                                origins_m.col(2).data(),  directions.col(0).data(),
                                directions.col(1).data(), directions.col(2).data()};
  float* const to[6] = {packet.origin_x,    packet.origin_y,    packet.origin_z,
                        packet.direction_x, packet.direction_y, packet.direction_z};
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < count; ++k) to[i][k] = from[i][first + k];
    for (int k = count; k < kRays; ++k) to[i][k] = to[i][count - 1];
  }
  reset(farthest_m, packet);
}

/// The wedge between two rays of a packet.
/// \return false if the others are not in between, or it is too wide to be of use
template <int kRays>
RAMSCOUT_SIM_INLINE bool enclose(const Packet<kRays>& p, int first, int last, Wedge& w) {
  constexpr float kWide = 0.5F;    // cosine to the middle
  constexpr float kSlack = 1e-6F;  // of directions; the tree's boxes have room for it
  constexpr float kSlack_m = 2e-3F;
  const float first_x = p.direction_x[first], first_y = p.direction_y[first];
  const float last_x = p.direction_x[last], last_y = p.direction_y[last];
  const float middle_x = first_x + last_x, middle_y = first_y + last_y;
  const float length = std::sqrt(middle_x * middle_x + middle_y * middle_y);
  if (!(length > 2.0F * kWide)) return false;
  const float x = middle_x / length, y = middle_y / length;
  const bool to_left = first_x * last_y - first_y * last_x > 0.0F;
  w.left_x = to_left ? -last_y : -first_y;
  w.left_y = to_left ? last_x : first_x;
  w.right_x = to_left ? first_y : last_y;
  w.right_y = to_left ? -first_x : -last_x;
  w.forward_x = x;
  w.forward_y = y;
  const float x0 = p.origin_x[first], y0 = p.origin_y[first], z0 = p.origin_z[first];
  const float x1 = p.origin_x[last], y1 = p.origin_y[last], z1 = p.origin_z[last];
  w.left = std::max(w.left_x * x0 + w.left_y * y0, w.left_x * x1 + w.left_y * y1) + kSlack_m;
  w.right = std::max(w.right_x * x0 + w.right_y * y0, w.right_x * x1 + w.right_y * y1) + kSlack_m;
  w.foremost = std::max(x * x0 + y * y0, x * x1 + y * y1) + kSlack_m;
  w.rearmost = std::min(x * x0 + y * y0, x * x1 + y * y1) - kSlack_m;
  w.low_z = std::min(z0, z1) - kSlack_m;
  w.high_z = std::max(z0, z1) + kSlack_m;
  const float slope0 = p.direction_z[first] / (x * first_x + y * first_y);
  const float slope1 = p.direction_z[last] / (x * last_x + y * last_y);
  w.down = std::min(0.0F, 1.01F * std::min(slope0, slope1));
  w.up = std::max(0.0F, 1.01F * std::max(slope0, slope1));
  int outside = 0;
  for (int i = 0; i < kRays; ++i) {
    const float ox = p.origin_x[i], oy = p.origin_y[i], oz = p.origin_z[i];
    const float dx = p.direction_x[i], dy = p.direction_y[i], dz = p.direction_z[i];
    const float along = x * dx + y * dy;
    const float at = x * ox + y * oy;
    const bool in = (along >= kWide) & (w.left_x * dx + w.left_y * dy <= kSlack) &
                    (w.right_x * dx + w.right_y * dy <= kSlack) &
                    (w.left_x * ox + w.left_y * oy <= w.left) &
                    (w.right_x * ox + w.right_y * oy <= w.right) & (at <= w.foremost) &
                    (at >= w.rearmost) & (oz <= w.high_z) & (oz >= w.low_z) &
                    (dz <= w.up * along + kSlack) & (dz >= w.down * along - kSlack);
    outside |= in ? 0 : 1;
  }
  return outside == 0;
}

/// The same between the outermost rays, whichever they are.
template <int kRays>
RAMSCOUT_SIM_INLINE bool encloseInAnyOrder(const Packet<kRays>& p, Wedge& w) {
  int left = 0, right = 0;
  for (int i = 1; i < kRays; ++i) {
    const float dx = p.direction_x[i], dy = p.direction_y[i];
    if (p.direction_x[left] * dy - p.direction_y[left] * dx > 0.0F) left = i;
    if (p.direction_x[right] * dy - p.direction_y[right] * dx < 0.0F) right = i;
  }
  return enclose(p, left, right, w);
}

/// Around rays straight up or down there is only a limit of height.
RAMSCOUT_SIM_INLINE Wedge column(const Packet<16>& packet) {
  constexpr float kFar = 1e30F;
  Wedge w = {};
  w.low_z = packet.direction_z[0] < 0.0F ? -kFar : packet.origin_z[0];
  w.high_z = packet.direction_z[0] > 0.0F ? kFar : packet.origin_z[0];
  return w;
}

template <int kRays>
Ray rayIn(const Packet<kRays>& packet, int i) {
  return {{packet.origin_x[i], packet.origin_y[i], packet.origin_z[i]},
          {packet.direction_x[i], packet.direction_y[i], packet.direction_z[i]}};
}

}  // namespace ramscout_sim
