// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/ray_caster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <embree3/rtcore.h>

namespace ramscout_sim {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kLargestSagitta_m = 2e-4;  // how far a polygon may be off the circle it stands for
constexpr double kFloorMargin_m = 100.0;

/// Triangles of all solids that answer light in the same way, world axes.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<unsigned, 3>> triangles;

  void addQuad(const std::array<Eigen::Vector3d, 4>& corners) {
    const unsigned first = static_cast<unsigned>(vertices.size());
    for (const Eigen::Vector3d& corner : corners) vertices.push_back(corner.cast<float>());
    triangles.push_back({first, first + 1, first + 2});
    triangles.push_back({first, first + 2, first + 3});
  }
};

void addBox(const Solid& box, Mesh& mesh) {
  const Eigen::Vector3d half = 0.5 * box.size_m;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Eigen::Vector3d normal = Eigen::Vector3d::Zero();
      Eigen::Vector3d u = Eigen::Vector3d::Zero();
      Eigen::Vector3d v = Eigen::Vector3d::Zero();
      normal[axis] = sign * half[axis];
      u[(axis + 1) % 3] = half[(axis + 1) % 3];
      v[(axis + 2) % 3] = half[(axis + 2) % 3];
      u *= sign;  // counter-clockwise from outside
      mesh.addQuad(
          {box.world_from_solid * (normal - u - v), box.world_from_solid * (normal + u - v),
           box.world_from_solid * (normal + u + v), box.world_from_solid * (normal - u + v)});
    }
  }
}

/// As a prism between the inscribed and the circumscribed one.
void addCylinder(const Solid& cylinder, Mesh& mesh) {
  const double radius_m = 0.5 * cylinder.size_m.x();
  const double half_height_m = 0.5 * cylinder.size_m.z();
  const double half_angle = std::acos(1.0 - std::min(0.5, 2.0 * kLargestSagitta_m / radius_m));
  const int sides = std::max(8, static_cast<int>(std::ceil(M_PI / half_angle)));
  const double corner_radius_m = 2.0 * radius_m / (1.0 + std::cos(M_PI / sides));
  const auto corner = [&](int side, double z) -> Eigen::Vector3d {
    const double angle = 2.0 * M_PI * side / sides;
    return cylinder.world_from_solid *
           Eigen::Vector3d(corner_radius_m * std::cos(angle), corner_radius_m * std::sin(angle), z);
  };
  const Eigen::Vector3d top = cylinder.world_from_solid * Eigen::Vector3d(0.0, 0.0, half_height_m);
  const Eigen::Vector3d bottom =
      cylinder.world_from_solid * Eigen::Vector3d(0.0, 0.0, -half_height_m);
  for (int side = 0; side < sides; ++side) {
    const Eigen::Vector3d low_a = corner(side, -half_height_m);
    const Eigen::Vector3d low_b = corner(side + 1, -half_height_m);
    const Eigen::Vector3d high_a = corner(side, half_height_m);
    const Eigen::Vector3d high_b = corner(side + 1, half_height_m);
    mesh.addQuad({low_a, low_b, high_b, high_a});
    mesh.addQuad({top, high_a, high_b, top});
    mesh.addQuad({bottom, low_b, low_a, bottom});
  }
}

void addSphere(const Solid& sphere, Mesh& mesh) {
  constexpr int kBands = 64;
  const double radius_m = 0.5 * sphere.size_m.x();
  const auto point = [&](int band, int slice) -> Eigen::Vector3d {
    const double polar = M_PI * band / kBands;
    const double azimuth = M_PI * slice / kBands;
    return sphere.world_from_solid *
           (radius_m * Eigen::Vector3d(std::sin(polar) * std::cos(azimuth),
                                       std::sin(polar) * std::sin(azimuth), std::cos(polar)));
  };
  for (int band = 0; band < kBands; ++band) {
    for (int slice = 0; slice < 2 * kBands; ++slice) {
      mesh.addQuad({point(band, slice), point(band + 1, slice), point(band + 1, slice + 1),
                    point(band, slice + 1)});
    }
  }
}

void addMesh(const Solid& solid, Mesh& mesh) {
  const unsigned first = static_cast<unsigned>(mesh.vertices.size());
  const Eigen::Isometry3f world_from_solid = solid.world_from_solid.cast<float>();
  for (const Eigen::Vector3f& vertex : solid.mesh->vertices_m)
    mesh.vertices.push_back(world_from_solid * vertex);
  for (const auto& [a, b, c] : solid.mesh->triangles)
    mesh.triangles.push_back({first + a, first + b, first + c});
}

void addSolid(const Solid& solid, Mesh& mesh) {
  switch (solid.shape) {
    case Shape::kBox:
      return addBox(solid, mesh);
    case Shape::kCylinder:
      return addCylinder(solid, mesh);
    case Shape::kSphere:
      return addSphere(solid, mesh);
    case Shape::kMesh:
      return addMesh(solid, mesh);
  }
}

/// What an Embree geometry stands for.
struct SurfaceKind {
  std::uint32_t material = 0;
  bool two_sided = false;
  bool operator<(const SurfaceKind& other) const {
    return std::tie(material, two_sided) < std::tie(other.material, other.two_sided);
  }
};

std::map<SurfaceKind, Mesh> toMeshes(const World& world) {
  std::map<SurfaceKind, Mesh> meshes;
  for (const Solid& solid : world.solids) {
    if (!solid.seen) continue;
    const SurfaceKind kind{static_cast<std::uint32_t>(solid.material), solid.shape == Shape::kMesh};
    addSolid(solid, meshes[kind]);
  }
  const Eigen::AlignedBox3d bounds = boundsOf(world);
  const Eigen::Vector3d low = bounds.min() - Eigen::Vector3d::Constant(kFloorMargin_m);
  const Eigen::Vector3d high = bounds.max() + Eigen::Vector3d::Constant(kFloorMargin_m);
  meshes[SurfaceKind()].addQuad(
      {Eigen::Vector3d(low.x(), low.y(), 0.0), Eigen::Vector3d(high.x(), low.y(), 0.0),
       Eigen::Vector3d(high.x(), high.y(), 0.0), Eigen::Vector3d(low.x(), high.y(), 0.0)});
  return meshes;
}

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
    for (const auto& [kind, mesh] : toMeshes(world)) {
      attach(mesh);
      kinds_.push_back(kind);
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
      use(first, filled, packet);
    }
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

  void attach(const Mesh& mesh) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), mesh.vertices.size()));
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), mesh.triangles.size()));
    if (!vertices || !indices)
      throw std::runtime_error("Embree has no memory for the world's triangles");
    for (const Eigen::Vector3f& vertex : mesh.vertices)
      vertices = std::copy_n(vertex.data(), 3, vertices);
    for (const auto& triangle : mesh.triangles) indices = std::copy_n(triangle.data(), 3, indices);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }

  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  std::vector<SurfaceKind> kinds_;  // by Embree's geometry number
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
