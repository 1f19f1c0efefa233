// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/ray_caster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include <embree3/rtcore.h>

#include "ramscout_sim/moving_solids.hpp"

#include "triangles.hpp"

namespace ramscout_sim {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

const char* nameOf(InstructionSet set) {
  switch (set) {
    case InstructionSet::kSse42:
      return "sse4.2";
    case InstructionSet::kAvx:
      return "avx";
    case InstructionSet::kAvx2:
      return "avx2";
    case InstructionSet::kAvx512:
      return "avx512";
  }
  throw std::logic_error("unknown instruction set");
}

}  // namespace

class RayCaster::Implementation {
public:
  Implementation(const World& world, InstructionSet widest) {
    device_ = rtcNewDevice((std::string("threads=1,max_isa=") + nameOf(widest)).c_str());
    if (!device_)
      throw std::runtime_error("Embree could not be started, error " +
                               std::to_string(rtcGetDeviceError(nullptr)));
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    for (auto& [kind, surfaces] : trianglesOf(world)) {
      attach(surfaces);
      kinds_.push_back(kind);
      surfaces_.push_back(std::move(surfaces));
    }
    rtcCommitScene(scene_);
    const RTCError error = rtcGetDeviceError(device_);
    if (error != RTC_ERROR_NONE)
      throw std::runtime_error("Embree could not build the scene, error " + std::to_string(error));
  }
  ~Implementation() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  std::vector<float> cast(const Rays& rays) const {
    std::vector<float> distances_m(rays.size());
    eachPacket(rays, [&](Eigen::Index first, int filled, const RTCRayHit16& packet) {
      std::copy_n(packet.ray.tfar, filled, distances_m.begin() + first);
    });
    return distances_m;
  }

  std::vector<Hit> trace(const Rays& rays) const {
    std::vector<Hit> hits(rays.size());
    eachPacket(rays, [&](Eigen::Index first, int filled, const RTCRayHit16& packet) {
      for (int i = 0; i < filled; ++i) {
        if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
        const SurfaceKind& kind = kinds_[packet.hit.geomID[i]];
        const Eigen::Vector3f normal(packet.hit.Ng_x[i], packet.hit.Ng_y[i], packet.hit.Ng_z[i]);
        hits[static_cast<std::size_t>(first + i)] = {packet.ray.tfar[i], normal.normalized(),
                                                     kind.material, kind.two_sided};
      }
    });
    return hits;
  }

private:
  static constexpr int kPacket = 16;

  /// Calls `use(index of the first ray, count, result)` for every sixteen rays.
  template <typename Use>
  void eachPacket(const Rays& rays, const Use& use) const {
    const Eigen::Index count = rays.origins_m.rows();
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    RTCRayHit16 packet = {};
    std::fill_n(packet.ray.mask, kPacket, ~0U);
    for (Eigen::Index first = 0; first < count; first += kPacket) {
      const int filled = static_cast<int>(std::min<Eigen::Index>(kPacket, count - first));
      alignas(64) std::array<int, kPacket> valid = {};
      std::fill_n(valid.begin(), filled, -1);
      fill(rays, first, filled, packet);
      rtcIntersect16(valid.data(), scene_, &context, &packet);
      refine(filled, packet);
      use(first, filled, packet);
    }
  }

  /// Single precision places a surface to a micrometre, which a grazing ray sees as millimetres,
  /// and curved solids are polygons here: how far such rays go is computed again.
  void refine(int count, RTCRayHit16& packet) const {
    constexpr float kGrazing = 0.02F;  // cosine of the incidence
    const auto& [ray, hit] = packet;
    std::array<int, kPacket> inexact;
    for (std::size_t i = 0; i < kPacket; ++i) {
      const float across =
          hit.Ng_x[i] * ray.dir_x[i] + hit.Ng_y[i] * ray.dir_y[i] + hit.Ng_z[i] * ray.dir_z[i];
      const float square =
          hit.Ng_x[i] * hit.Ng_x[i] + hit.Ng_y[i] * hit.Ng_y[i] + hit.Ng_z[i] * hit.Ng_z[i];
      inexact[i] = across * across < kGrazing * kGrazing * square ? 1 : 0;
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const unsigned geometry = hit.geomID[i];
      if (geometry == RTC_INVALID_GEOMETRY_ID) continue;
      if (kinds_[geometry].curved) {
        const Triangles& surface = surfaces_[geometry];
        const Solid& solid = surface.solids[surface.solid_by_triangle[hit.primID[i]]];
        packet.ray.tfar[i] = curvedDistance(packet, i, solid);
      } else if (inexact[i] != 0) {
        packet.ray.tfar[i] = planeDistance(packet, i, surfaces_[geometry]);
      }
    }
  }

  /// To the true shape; to the polygon if that is missed.
  static float curvedDistance(const RTCRayHit16& packet, std::size_t i, const Solid& solid) {
    const RTCRay16& ray = packet.ray;
    const std::optional<Hit> hit = intersect(
        Ray{{ray.org_x[i], ray.org_y[i], ray.org_z[i]}, {ray.dir_x[i], ray.dir_y[i], ray.dir_z[i]}},
        solid);
    return hit ? hit->distance_m : ray.tfar[i];
  }

  /// To the plane of the triangle that was hit.
  static float planeDistance(const RTCRayHit16& packet, std::size_t i, const Triangles& surface) {
    const auto& [ray, hit] = packet;
    const auto& [a, b, c] = surface.triangles[hit.primID[i]];
    const Eigen::Vector3d& corner = surface.vertices[a];
    const Eigen::Vector3d normal =
        (surface.vertices[b] - corner).cross(surface.vertices[c] - corner);
    const Eigen::Vector3d origin(ray.org_x[i], ray.org_y[i], ray.org_z[i]);
    const Eigen::Vector3d direction(ray.dir_x[i], ray.dir_y[i], ray.dir_z[i]);
    const double distance_m = normal.dot(corner - origin) / normal.dot(direction);
    constexpr double kBelievable_m = 0.1;  // or the ray lies in the plane
    return std::abs(distance_m - ray.tfar[i]) < kBelievable_m ? static_cast<float>(distance_m)
                                                              : ray.tfar[i];
  }

  /// Embree takes components below 1e-18 for positive when it inverts them, but not when it sorts
  /// rays by sign: a packet with a tiny negative one misses what it should hit.
  static void copyDirections(const float* from, int count, float* to) {
    constexpr float kSmallest = 1e-12F;
    std::transform(from, from + count, to,
                   [](float x) { return std::abs(x) < kSmallest ? kSmallest : x; });
  }

  static void fill(const Rays& rays, Eigen::Index first, int count, RTCRayHit16& packet) {
    const auto& [origins_m, directions] = rays;
    std::copy_n(origins_m.col(0).data() + first, count, packet.ray.org_x);
    std::copy_n(origins_m.col(1).data() + first, count, packet.ray.org_y);
    std::copy_n(origins_m.col(2).data() + first, count, packet.ray.org_z);
    copyDirections(directions.col(0).data() + first, count, packet.ray.dir_x);
    copyDirections(directions.col(1).data() + first, count, packet.ray.dir_y);
    copyDirections(directions.col(2).data() + first, count, packet.ray.dir_z);
    std::fill_n(packet.ray.tnear, kPacket, 0.0F);
    std::fill_n(packet.ray.tfar, kPacket, kInfinity);
    std::fill_n(packet.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(packet.hit.instID[0], kPacket, RTC_INVALID_GEOMETRY_ID);
  }

  void attach(const Triangles& mesh) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), mesh.vertices.size()));
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), mesh.triangles.size()));
    if (!vertices || !indices)
      throw std::runtime_error("Embree has no memory for the world's triangles");
    for (const Eigen::Vector3d& vertex : mesh.vertices)
      vertices = std::copy_n(vertex.cast<float>().eval().data(), 3, vertices);
    for (const auto& triangle : mesh.triangles) indices = std::copy_n(triangle.data(), 3, indices);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }

  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  // By Embree's geometry number.
  std::vector<SurfaceKind> kinds_;
  std::vector<Triangles> surfaces_;
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
