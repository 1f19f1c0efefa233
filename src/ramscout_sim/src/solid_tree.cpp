// SPDX-License-Identifier: BSD-3-Clause
#include "solid_tree.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include "ramscout_sim/moving_solids.hpp"

#include "ray_packet.hpp"
#include "solid_tree_builder.hpp"

namespace ramscout_sim {
namespace {

using Node = SolidTree::Node;
using Body = SolidTree::Body;

// A surface exactly as far away as asked for is found although boxes are met micrometres too near
// or too far.
constexpr float kLeeway_m = 1e-2F;

struct Tree {
  const Node* nodes;
  const Body* bodies;
  const Solid* solids;
  float overlap_m;
  float farthest_m;
};

/// Which children reach into the wedge, as bits, and how far away they begin at least.
RAMSCOUT_SIM_INLINE unsigned overlapping(const Node& node,
                                         const Wedge& w,
                                         float limit,
                                         float* nearest) {
  // The corners of the boxes that are least and most far along a direction.
  const float* const left_x = node.bounds_m[w.left_x > 0.0F ? 0 : 1].data();
  const float* const left_y = node.bounds_m[w.left_y > 0.0F ? 2 : 3].data();
  const float* const right_x = node.bounds_m[w.right_x > 0.0F ? 0 : 1].data();
  const float* const right_y = node.bounds_m[w.right_y > 0.0F ? 2 : 3].data();
  const float* const near_x = node.bounds_m[w.forward_x > 0.0F ? 0 : 1].data();
  const float* const near_y = node.bounds_m[w.forward_y > 0.0F ? 2 : 3].data();
  const float* const far_x = node.bounds_m[w.forward_x > 0.0F ? 1 : 0].data();
  const float* const far_y = node.bounds_m[w.forward_y > 0.0F ? 3 : 2].data();
  unsigned bits = 0;
  for (int i = 0; i < SolidTree::kChildren; ++i) {
    const bool in_left = w.left_x * left_x[i] + w.left_y * left_y[i] <= w.left;
    const bool in_right = w.right_x * right_x[i] + w.right_y * right_y[i] <= w.right;
    const float far = w.forward_x * far_x[i] + w.forward_y * far_y[i] - w.rearmost;
    const float near = w.forward_x * near_x[i] + w.forward_y * near_y[i] - w.foremost;
    const bool in_height =
        (node.low_z_m[i] <= w.high_z + w.up * far) & (node.high_z_m[i] >= w.low_z + w.down * far);
    nearest[i] = near;
    const bool in = in_left & in_right & in_height & (far >= 0.0F) & (near <= limit);
    bits |= in ? 1U << i : 0U;
  }
  return bits;
}

/// In double precision, for the rays that are marked.
template <int kRays>
RAMSCOUT_SIM_INLINE void meetExactly(const Solid& solid,
                                     std::int32_t index,
                                     const std::int32_t* marked,
                                     Packet<kRays>& packet) {
  for (int i = 0; i < kRays; ++i) {
    if (marked[i] == 0) continue;
    const std::optional<Hit> hit = intersect(rayIn(packet, i), solid);
    if (!hit || !(hit->distance_m < packet.distance[i])) continue;
    packet.distance[i] = hit->distance_m;
    packet.solid[i] = index;
  }
}

/// Boxes are a little too large here, which is taken back; a ray that would miss one that is as
/// much too small passes close to an edge, and is looked at exactly. And single precision places a
/// surface to a micrometre, which a grazing ray sees as millimetres: so are such, and those that
/// start inside.
template <int kRays>
RAMSCOUT_SIM_INLINE void meetBox(const Tree& tree, std::int32_t index, Packet<kRays>& packet) {
  const Body& s = tree.bodies[index];
  const float shrink = 2.0F * tree.overlap_m;
  const float grazing = shrink / kGrazing;
  alignas(64) std::int32_t doubtful[kRays];
  for (int i = 0; i < kRays; ++i) {
    const float ox = packet.origin_x[i] - s.x_m;
    const float oy = packet.origin_y[i] - s.y_m;
    const float oz = packet.origin_z[i] - s.z_m;
    const float x = s.cos_yaw * ox + s.sin_yaw * oy;
    const float y = s.cos_yaw * oy - s.sin_yaw * ox;
    const float to_x = s.cos_yaw * packet.direction_x[i] + s.sin_yaw * packet.direction_y[i];
    const float to_y = s.cos_yaw * packet.direction_y[i] - s.sin_yaw * packet.direction_x[i];
    const float inverse_x = 1.0F / nonzero(to_x);
    const float inverse_y = 1.0F / nonzero(to_y);
    const float inverse_z = packet.inverse_z[i];
    const float x0 = (-s.half_x_m - x) * inverse_x, x1 = (s.half_x_m - x) * inverse_x;
    const float y0 = (-s.half_y_m - y) * inverse_y, y1 = (s.half_y_m - y) * inverse_y;
    const float z0 = (-s.half_z_m - oz) * inverse_z, z1 = (s.half_z_m - oz) * inverse_z;
    const float in_x = std::min(x0, x1), in_y = std::min(y0, y1), in_z = std::min(z0, z1);
    const float out_x = std::max(x0, x1), out_y = std::max(y0, y1), out_z = std::max(z0, z1);
    const float in = std::max(std::max(in_x, in_y), in_z);
    const float out = std::min(std::min(out_x, out_y), out_z);
    const float rim_x = shrink * std::abs(inverse_x);
    const float rim_y = shrink * std::abs(inverse_y);
    const float rim_z = shrink * std::abs(inverse_z);
    const float rims_in = std::max(std::max(in_x + rim_x, in_y + rim_y), in_z + rim_z);
    const float rims_out = std::min(std::min(out_x - rim_x, out_y - rim_y), out_z - rim_z);
    const float rim = in == in_x ? rim_x : in == in_y ? rim_y : rim_z;
    const float distance = in + 0.5F * rim;
    const bool sure = (rims_in <= rims_out) & (rim <= grazing) & (in >= 0.0F);
    const bool found = (in <= out) & (out >= 0.0F) & (in < packet.distance[i]);
    const bool hit = found & sure & (distance < packet.distance[i]);
    doubtful[i] = found ? (sure ? 0 : 1) : 0;
    packet.distance[i] = hit ? distance : packet.distance[i];
    packet.solid[i] = hit ? index : packet.solid[i];
  }
  std::int32_t doubts = 0;
  for (int i = 0; i < kRays; ++i) doubts |= doubtful[i];
  if (doubts != 0) meetExactly(tree.solids[index], index, doubtful, packet);
}

/// Solids of other shapes and attitudes, ray by ray where one passes close enough.
template <int kRays>
RAMSCOUT_SIM_INLINE void meetOther(const Tree& tree, std::int32_t index, Packet<kRays>& packet) {
  const Body& s = tree.bodies[index];
  alignas(64) std::int32_t close[kRays];
  for (int i = 0; i < kRays; ++i) {
    const float x = s.x_m - packet.origin_x[i], y = s.y_m - packet.origin_y[i];
    const float dx = packet.direction_x[i], dy = packet.direction_y[i];
    const float ahead = x * dx + y * dy;
    const bool passes = (std::abs(x * dy - y * dx) <= s.half_x_m) & (ahead >= -s.half_x_m) &
                        (ahead - s.half_x_m <= packet.distance[i]);
    close[i] = passes ? 1 : 0;
  }
  meetExactly(tree.solids[index], index, close, packet);
}

template <int kRays>
RAMSCOUT_SIM_INLINE float farthest(const Packet<kRays>& packet) {
  alignas(64) float distance[kRays];  // the greater of either half until one is left
  for (int i = 0; i < kRays; ++i) distance[i] = packet.distance[i];
  for (int half = kRays / 2; half > 0; half /= 2) {
    for (int i = 0; i < half; ++i) distance[i] = std::max(distance[i], distance[i + half]);
  }
  return distance[0];
}

/// Through the tree, what is near first.
template <int kRays>
RAMSCOUT_SIM_INLINE void traverse(const Tree& tree, const Wedge& wedge, Packet<kRays>& packet) {
  struct Waiting {
    float nearest;
    std::int32_t child;
  };
  float limit = tree.farthest_m;
  Waiting waiting[kMostWaiting];
  waiting[0] = {0.0F, 0};  // the root
  int count = 1;
  alignas(64) float nearest[SolidTree::kChildren];
  while (count > 0) {
    const Waiting next = waiting[--count];
    if (next.nearest > limit) continue;
    if (next.child < 0) {
      const std::int32_t index = ~next.child;
      if (tree.bodies[index].upright_box)
        meetBox(tree, index, packet);
      else
        meetOther(tree, index, packet);
      limit = farthest(packet);
      continue;
    }
    const Node& node = tree.nodes[next.child];
    const int begin = count;
    for (unsigned bits = overlapping(node, wedge, limit, nearest); bits != 0; bits &= bits - 1) {
      const int i = __builtin_ctz(bits);
      int place = count++;
      for (; place > begin && waiting[place - 1].nearest < nearest[i]; --place)
        waiting[place] = waiting[place - 1];
      waiting[place] = {nearest[i], node.child[static_cast<std::size_t>(i)]};
    }
  }
  const bool reaches_floor = wedge.low_z < 0.0F || wedge.low_z + wedge.down * limit < 0.0F;
  if (reaches_floor) meetBox(tree, 0, packet);
}

/// Rays that do not go the same way: each as if it were sixteen.
template <int kRays>
RAMSCOUT_SIM_INLINE void castEach(const Tree& tree, Packet<kRays>& packet) {
  for (int i = 0; i < kRays; ++i) {
    Packet<16> copies;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled next
    for (int k = 0; k < 16; ++k) {
      copies.origin_x[k] = packet.origin_x[i];
      copies.origin_y[k] = packet.origin_y[i];
      copies.origin_z[k] = packet.origin_z[i];
      copies.direction_x[k] = packet.direction_x[i];
      copies.direction_y[k] = packet.direction_y[i];
      copies.direction_z[k] = packet.direction_z[i];
    }
    reset(tree.farthest_m, copies);
    Wedge wedge;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled next
    if (!enclose(copies, 0, 0, wedge)) wedge = column(copies);
    traverse(tree, wedge, copies);
    packet.distance[i] = copies.distance[0];
    packet.solid[i] = copies.solid[0];
  }
}

template <int kRays, typename Count>
RAMSCOUT_SIM_INLINE void castPacket(const Tree& tree,
                                    const Rays& rays,
                                    Eigen::Index first,
                                    Count count,
                                    SolidTree::Result& result) {
  Packet<kRays> packet;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled next
  load(rays, first, count, tree.farthest_m, packet);
  Wedge wedge;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled next
  if (enclose(packet, 0, kRays - 1, wedge) || encloseInAnyOrder(packet, wedge))
    traverse(tree, wedge, packet);
  else
    castEach(tree, packet);
  for (int i = 0; i < count; ++i) {
    result.distances_m[static_cast<std::size_t>(first + i)] =
        packet.solid[i] < 0 ? kInfinity : packet.distance[i];
    result.solids[static_cast<std::size_t>(first + i)] = packet.solid[i];
  }
}

RAMSCOUT_SIM_INLINE void castPackets(const Tree& tree,
                                     const Rays& rays,
                                     SolidTree::Result& result) {
  constexpr int kRays = 32;  // two AVX-512 registers of floats
  const auto count = static_cast<Eigen::Index>(rays.size());
  Eigen::Index first = 0;
  for (; first + kRays <= count; first += kRays)  // of a size known beforehand
    castPacket<kRays>(tree, rays, first, std::integral_constant<int, kRays>(), result);
  if (first < count) castPacket<kRays>(tree, rays, first, static_cast<int>(count - first), result);
}

#ifdef __x86_64__
[[gnu::target("avx512f,avx512vl,avx512dq,avx512bw,prefer-vector-width=512")]] void castAvx512(
    const Tree& tree, const Rays& rays, SolidTree::Result& result) {
  castPackets(tree, rays, result);
}

[[gnu::target("avx2")]] void castAvx2(const Tree& tree,
                                      const Rays& rays,
                                      SolidTree::Result& result) {
  castPackets(tree, rays, result);
}

#endif

void castPlain(const Tree& tree, const Rays& rays, SolidTree::Result& result) {
  castPackets(tree, rays, result);
}

}  // namespace

SolidTree::SolidTree(std::vector<Solid> solids)
    : solids_(std::move(solids)), nodes_(buildNodes(solids_)), overlap_m_(overlapOf(solids_)) {
  for (const Solid& solid : solids_) bodies_.push_back(bodyOf(solid, overlap_m_));
}

SolidTree::Result SolidTree::cast(const Rays& rays,
                                  float farthest_m,
                                  [[maybe_unused]] InstructionSet widest) const {
  Result result{std::vector<float>(rays.size(), kInfinity),
                std::vector<std::int32_t>(rays.size(), -1)};
  const Tree tree = {nodes_.data(), bodies_.data(), solids_.data(), static_cast<float>(overlap_m_),
                     farthest_m + kLeeway_m};
#ifdef __x86_64__
  if (widest >= InstructionSet::kAvx512 && __builtin_cpu_supports("avx512f") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw")) {
    castAvx512(tree, rays, result);
    return result;
  }
  if (widest >= InstructionSet::kAvx2 && __builtin_cpu_supports("avx2")) {
    castAvx2(tree, rays, result);
    return result;
  }
#endif
  castPlain(tree, rays, result);
  return result;
}

}  // namespace ramscout_sim
