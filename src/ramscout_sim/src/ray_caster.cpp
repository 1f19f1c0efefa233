// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/ray_caster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "ramscout_sim/moving_solids.hpp"

#include "ray_scene.hpp"

namespace ramscout_sim {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Packets of sixteen rays for AVX-512; with narrower registers those of eight are faster.
struct Sixteen {
  static constexpr int kWidth = 16;
  using Packet = RTCRayHit16;
  static constexpr auto kIntersect = rtcIntersect16;
};
struct Eight {
  static constexpr int kWidth = 8;
  using Packet = RTCRayHit8;
  static constexpr auto kIntersect = rtcIntersect8;
};

}  // namespace

class RayCaster::Implementation {
public:
  Implementation(const World& world, InstructionSet widest) : scene_(world, widest) {}

  std::vector<float> cast(const Rays& rays) const {
    std::vector<float> distances_m(rays.size());
    eachPacket(rays, [&](Eigen::Index first, auto filled, const auto& packet) {
      std::copy_n(packet.ray.tfar, int{filled}, distances_m.begin() + first);
    });
    return distances_m;
  }

  std::vector<Hit> trace(const Rays& rays) const {
    std::vector<Hit> hits(rays.size());
    eachPacket(rays, [&](Eigen::Index first, int filled, const auto& packet) {
      for (int i = 0; i < filled; ++i) {
        const unsigned geometry = packet.hit.geomID[i];
        if (geometry == RTC_INVALID_GEOMETRY_ID) continue;
        const Eigen::Vector3f normal(packet.hit.Ng_x[i], packet.hit.Ng_y[i], packet.hit.Ng_z[i]);
        hits[static_cast<std::size_t>(first + i)] = {
            packet.ray.tfar[i], normal.normalized(),
            static_cast<std::uint32_t>(scene_.solidOf(geometry, packet.hit.primID[i]).material),
            RayScene::isMesh(geometry)};
      }
    });
    return hits;
  }

private:
  template <typename Use>
  void eachPacket(const Rays& rays, const Use& use) const {
    if (scene_.takesSixteen())
      eachPacketOf<Sixteen>(rays, use);
    else
      eachPacketOf<Eight>(rays, use);
  }

  /// Calls `use(index of the first ray, count, result)` for every packet.
  template <typename Width, typename Use>
  void eachPacketOf(const Rays& rays, const Use& use) const {
    constexpr int kPacket = Width::kWidth;
    const Eigen::Index count = rays.origins_m.rows();
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    typename Width::Packet packet = {};
    std::fill_n(packet.ray.mask, kPacket, ~0U);
    const auto castPacket = [&](Eigen::Index first, auto filled) {
      alignas(64) std::array<int, kPacket> valid = {};
      std::fill_n(valid.begin(), int{filled}, -1);
      fill<kPacket>(rays, first, filled, packet);
      Width::kIntersect(valid.data(), scene_.tree(), &context, &packet);
      refine<kPacket>(filled, packet);
      use(first, filled, packet);
    };
    Eigen::Index first = 0;
    for (; first + kPacket <= count; first += kPacket)
      castPacket(first, std::integral_constant<int, kPacket>());  // of a size known beforehand
    if (first < count) castPacket(first, static_cast<int>(count - first));
  }

  /// Single precision places a surface to a micrometre, which a grazing ray sees as millimetres:
  /// how far such rays go is computed again, as it is for those that hit a box from inside.
  template <int kPacket, typename Packet>
  void refine(int count, Packet& packet) const {
    constexpr float kGrazing = 0.02F;  // cosine of the incidence
    const auto& [ray, hit] = packet;
    std::array<int, kPacket> inexact;
    for (std::size_t i = 0; i < kPacket; ++i) {
      const float across =
          hit.Ng_x[i] * ray.dir_x[i] + hit.Ng_y[i] * ray.dir_y[i] + hit.Ng_z[i] * ray.dir_z[i];
      const float square =
          hit.Ng_x[i] * hit.Ng_x[i] + hit.Ng_y[i] * hit.Ng_y[i] + hit.Ng_z[i] * hit.Ng_z[i];
      const bool grazing = across * across < kGrazing * kGrazing * square;
      const bool from_inside = across > 0.0F;
      inexact[i] = (grazing | from_inside) ? 1 : 0;
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      if (inexact[i] == 0) continue;
      const unsigned geometry = hit.geomID[i];
      if (RayScene::isBox(geometry)) {
        refineBox(packet, i);
      } else if (RayScene::isMesh(geometry)) {
        packet.ray.tfar[i] = planeDistance(packet, i, scene_.solidOf(geometry, hit.primID[i]));
      }
    }
  }

  template <typename Packet>
  void refineBox(Packet& packet, std::size_t i) const {
    auto& [ray, hit] = packet;
    const std::optional<Hit> exact =
        intersect(rayIn(ray, i), scene_.solidOf(hit.geomID[i], hit.primID[i]));
    if (!exact) return;  // along an edge
    ray.tfar[i] = exact->distance_m;
    hit.Ng_x[i] = exact->normal.x();
    hit.Ng_y[i] = exact->normal.y();
    hit.Ng_z[i] = exact->normal.z();
  }

  /// To the plane of the triangle that was hit.
  template <typename Packet>
  static float planeDistance(const Packet& packet, std::size_t i, const Solid& solid) {
    const auto& [a, b, c] = solid.mesh->triangles[packet.hit.primID[i]];
    const auto vertex = [&solid](unsigned index) -> Eigen::Vector3d {
      return solid.world_from_solid * solid.mesh->vertices_m[index].cast<double>();
    };
    const Eigen::Vector3d corner = vertex(a);
    const Eigen::Vector3d normal = (vertex(b) - corner).cross(vertex(c) - corner);
    const Ray ray = rayIn(packet.ray, i);
    const double distance_m =
        normal.dot(corner - ray.origin_m.cast<double>()) / normal.dot(ray.direction.cast<double>());
    constexpr double kBelievable_m = 0.1;  // or the ray lies in the plane
    const float found_m = packet.ray.tfar[i];
    return std::abs(distance_m - found_m) < kBelievable_m ? static_cast<float>(distance_m)
                                                          : found_m;
  }

  template <typename PacketRay>
  static Ray rayIn(const PacketRay& ray, std::size_t i) {
    return {{ray.org_x[i], ray.org_y[i], ray.org_z[i]}, {ray.dir_x[i], ray.dir_y[i], ray.dir_z[i]}};
  }

  /// Embree takes components below 1e-18 for positive when it inverts them, but not when it sorts
  /// rays by sign: a packet with a tiny negative one misses what it should hit.
  template <typename Count>
  static void copyDirections(const float* from, Count count, float* to) {
    static constexpr float kSmallest = 1e-12F;
    std::transform(from, from + int{count}, to,
                   [](float x) { return std::abs(x) < kSmallest ? kSmallest : x; });
  }

  template <int kPacket, typename Count, typename Packet>
  static void fill(const Rays& rays, Eigen::Index first, Count count, Packet& packet) {
    const auto& [origins_m, directions] = rays;
    std::copy_n(origins_m.col(0).data() + first, int{count}, packet.ray.org_x);
    std::copy_n(origins_m.col(1).data() + first, int{count}, packet.ray.org_y);
    std::copy_n(origins_m.col(2).data() + first, int{count}, packet.ray.org_z);
    copyDirections(directions.col(0).data() + first, count, packet.ray.dir_x);
    copyDirections(directions.col(1).data() + first, count, packet.ray.dir_y);
    copyDirections(directions.col(2).data() + first, count, packet.ray.dir_z);
    std::fill_n(packet.ray.tnear, kPacket, 0.0F);
    std::fill_n(packet.ray.tfar, kPacket, kInfinity);
    std::fill_n(packet.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(packet.hit.instID[0], kPacket, RTC_INVALID_GEOMETRY_ID);
  }

  RayScene scene_;
};

Rays::Rays(std::size_t count)
    : origins_m(static_cast<Eigen::Index>(count), 3),
      directions(static_cast<Eigen::Index>(count), 3) {}

Rays::Rays(const std::vector<Ray>& rays) : Rays(rays.size()) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    origins_m.row(static_cast<Eigen::Index>(i)) = rays[i].origin_m;
    directions.row(static_cast<Eigen::Index>(i)) = rays[i].direction;
  }
}

Ray Rays::operator[](std::size_t index) const {
  const auto row = static_cast<Eigen::Index>(index);
  return {origins_m.row(row), directions.row(row)};
}

InstructionSet parseInstructionSet(const std::string& name) {
  for (const InstructionSet set : {InstructionSet::kSse42, InstructionSet::kAvx,
                                   InstructionSet::kAvx2, InstructionSet::kAvx512}) {
    if (name == nameOf(set)) return set;
  }
  throw std::invalid_argument("instruction_set must be sse4.2, avx, avx2 or avx512, got '" + name +
                              "'");
}

RayCaster::RayCaster(const World& world, InstructionSet widest)
    : implementation_(std::make_unique<Implementation>(world, widest)),
      materials_(world.materials),
      has_clear_surfaces_(
          std::any_of(world.solids.begin(), world.solids.end(), [&world](const Solid& solid) {
            return solid.seen && world.materials[solid.material].surface != Surface::kOpaque;
          })) {}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;
std::vector<float> RayCaster::cast(const Rays& rays) const {
  return implementation_->cast(rays);
}
std::vector<Hit> RayCaster::trace(const Rays& rays) const {
  return implementation_->trace(rays);
}

}  // namespace ramscout_sim
