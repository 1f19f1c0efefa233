// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "precision.hpp"

namespace ramscout_sim {
namespace {

/// How many rays a packet of Embree's holds.
template <typename Packet>
constexpr int kWidthOf = std::extent_v<decltype(decltype(Packet::ray)::org_x)>;

void intersect(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit16* rays) {
  rtcIntersect16(valid, scene, context, rays);
}
void intersect(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit8* rays) {
  rtcIntersect8(valid, scene, context, rays);
}

/// A packet with a tiny negative component misses what it should hit.
void copyDirections(const float* from, int count, float* to) {
  std::transform(from, from + count, to, nonzero);
}

template <typename Packet>
void load(const Rays& rays, Eigen::Index first, int count, Packet& packet) {
  const auto& [origins_m, directions] = rays;
  std::copy_n(origins_m.col(0).data() + first, count, packet.ray.org_x);
  std::copy_n(origins_m.col(1).data() + first, count, packet.ray.org_y);
  std::copy_n(origins_m.col(2).data() + first, count, packet.ray.org_z);
  copyDirections(directions.col(0).data() + first, count, packet.ray.dir_x);
  copyDirections(directions.col(1).data() + first, count, packet.ray.dir_y);
  copyDirections(directions.col(2).data() + first, count, packet.ray.dir_z);
}

/// To the plane of the triangle that was hit.
template <typename Packet>
float planeDistance(const Packet& packet, std::size_t i, const Solid& solid) {
  const auto& [a, b, c] = solid.mesh->triangles[packet.hit.primID[i]];
  const auto vertex = [&solid](unsigned index) -> Eigen::Vector3d {
    return solid.world_from_solid * solid.mesh->vertices_m[index].cast<double>();
  };
  const Eigen::Vector3d corner = vertex(a);
  const Eigen::Vector3d normal = (vertex(b) - corner).cross(vertex(c) - corner);
  const auto& ray = packet.ray;
  const Eigen::Vector3d origin(ray.org_x[i], ray.org_y[i], ray.org_z[i]);
  const Eigen::Vector3d direction(ray.dir_x[i], ray.dir_y[i], ray.dir_z[i]);
  const double distance_m = normal.dot(corner - origin) / normal.dot(direction);
  // Grazing rays are millimetres off; those that lie in the plane itself end anywhere.
  constexpr double kBelievable_m = 0.1;
  const float found_m = ray.tfar[i];
  return std::abs(distance_m - found_m) < kBelievable_m ? static_cast<float>(distance_m) : found_m;
}

/// How far grazing rays go is computed again.
template <typename Packet>
void refine(const std::vector<Solid>& meshes, int count, Packet& packet) {
  constexpr std::size_t packet_size = kWidthOf<Packet>;
  const auto& [ray, hit] = packet;
  std::array<int, packet_size> grazing{};
  for (std::size_t i = 0; i < packet_size; ++i) {
    const float across =
        hit.Ng_x[i] * ray.dir_x[i] + hit.Ng_y[i] * ray.dir_y[i] + hit.Ng_z[i] * ray.dir_z[i];
    const float square =
        hit.Ng_x[i] * hit.Ng_x[i] + hit.Ng_y[i] * hit.Ng_y[i] + hit.Ng_z[i] * hit.Ng_z[i];
    grazing[i] = across * across < kGrazing * kGrazing * square ? 1 : 0;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    if (grazing[i] != 0 && hit.geomID[i] != RTC_INVALID_GEOMETRY_ID)
      packet.ray.tfar[i] = planeDistance(packet, i, meshes[hit.geomID[i]]);
  }
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

MeshScene::MeshScene(std::vector<Solid> meshes, InstructionSet widest)
    : meshes_(std::move(meshes)),
      device_(rtcNewDevice((std::string("threads=1,max_isa=") + nameOf(widest)).c_str())) {
  if (!device_)
    throw std::runtime_error("Embree could not be started, error " +
                             std::to_string(rtcGetDeviceError(nullptr)));
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
  for (std::size_t i = 0; i < meshes_.size(); ++i) attach(static_cast<unsigned>(i));
  rtcCommitScene(scene_);
  const RTCError error = rtcGetDeviceError(device_);
  if (error != RTC_ERROR_NONE)
    throw std::runtime_error("Embree could not build the scene, error " + std::to_string(error));
}

MeshScene::~MeshScene() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

void MeshScene::attach(unsigned number) {
  const Solid& solid = meshes_[number];
  const auto& [corners_m, triangles] = *solid.mesh;
  const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), corners_m.size()));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(unsigned), triangles.size()));
  if (!vertices || !indices)
    throw std::runtime_error("Embree has no memory for the world's triangles");
  for (const Eigen::Vector3f& corner : corners_m) {
    const Eigen::Vector3f vertex = (solid.world_from_solid * corner.cast<double>()).cast<float>();
    vertices = std::copy_n(vertex.data(), 3, vertices);
  }
  for (const auto& triangle : triangles) indices = std::copy_n(triangle.data(), 3, indices);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_, geometry, number);
  rtcReleaseGeometry(geometry);
}

void MeshScene::cast(const Rays& rays, float farthest_m, std::vector<float>& distances_m) const {
  const auto limit_m = [&](std::size_t i) { return std::min(farthest_m, distances_m[i]); };
  eachPacket(rays, limit_m, [&](Eigen::Index first, auto filled, const auto& packet) {
    for (int i = 0; i < filled; ++i) {
      float& distance_m = distances_m[static_cast<std::size_t>(first + i)];
      const bool hit = packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
      distance_m = hit ? packet.ray.tfar[i] : distance_m;
    }
  });
}

void MeshScene::trace(const Rays& rays, float farthest_m, std::vector<Hit>& hits) const {
  const auto limit_m = [&](std::size_t i) { return std::min(farthest_m, hits[i].distance_m); };
  eachPacket(rays, limit_m, [&](Eigen::Index first, int filled, const auto& packet) {
    for (int i = 0; i < filled; ++i) {
      const unsigned mesh = packet.hit.geomID[i];
      if (mesh == RTC_INVALID_GEOMETRY_ID) continue;
      const Eigen::Vector3f normal(packet.hit.Ng_x[i], packet.hit.Ng_y[i], packet.hit.Ng_z[i]);
      hits[static_cast<std::size_t>(first + i)] = {
          packet.ray.tfar[i], normal.normalized(),
          static_cast<std::uint32_t>(meshes_[mesh].material), true};
    }
  });
}

/// Calls `use(index of the first ray, count, result)` for every packet.
template <typename Distance, typename Use>
void MeshScene::eachPacket(const Rays& rays, const Distance& limit_m, const Use& use) const {
  if (rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0)
    eachPacketOf<RTCRayHit16>(rays, limit_m, use);
  else
    eachPacketOf<RTCRayHit8>(rays, limit_m, use);
}

/// Sixteen rays for AVX-512; with narrower registers packets of eight are faster.
template <typename Packet, typename Distance, typename Use>
void MeshScene::eachPacketOf(const Rays& rays, const Distance& limit_m, const Use& use) const {
  constexpr int width = kWidthOf<Packet>;
  const Eigen::Index count = rays.origins_m.rows();
  RTCIntersectContext context = {};
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  Packet packet = {};
  std::fill_n(packet.ray.mask, width, ~0U);
  const auto castPacket = [&](Eigen::Index first, auto filled) {
    alignas(64) std::array<int, width> valid = {};
    std::fill_n(valid.begin(), int{filled}, -1);
    load(rays, first, filled, packet);
    std::fill_n(packet.ray.tnear, width, 0.0F);
    for (int i = 0; i < filled; ++i)
      packet.ray.tfar[i] = limit_m(static_cast<std::size_t>(first + i));
    std::fill_n(packet.hit.geomID, width, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(packet.hit.instID[0], width, RTC_INVALID_GEOMETRY_ID);
    intersect(valid.data(), scene_, &context, &packet);
    refine(meshes_, filled, packet);
    use(first, filled, packet);
  };
  Eigen::Index first = 0;
  for (; first + width <= count; first += width)
    castPacket(first, std::integral_constant<int, width>());  // of a size known beforehand
  if (first < count) castPacket(first, static_cast<int>(count - first));
}

}  // namespace ramscout_sim
