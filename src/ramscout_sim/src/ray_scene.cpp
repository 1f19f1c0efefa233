// SPDX-License-Identifier: BSD-3-Clause
#include "ray_scene.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include "ramscout_sim/moving_solids.hpp"

namespace ramscout_sim {
namespace {

/// Everything up to z = 0, far around the solids.
Solid floorUnder(const World& world) {
  constexpr double kMargin_m = 100.0;
  constexpr double kThickness_m = 1.0;
  const Eigen::AlignedBox3d bounds = boundsOf(world);
  Solid floor;
  floor.size_m = bounds.sizes() + Eigen::Vector3d::Constant(2.0 * kMargin_m);
  floor.size_m.z() = kThickness_m;
  floor.world_from_solid.translate(
      Eigen::Vector3d(bounds.center().x(), bounds.center().y(), -0.5 * kThickness_m));
  return floor;
}

void boundCurved(const RTCBoundsFunctionArguments* arguments) {
  constexpr double kMargin_m = 1e-4;  // more than single precision rounds
  const auto* solids = static_cast<const Solid*>(arguments->geometryUserPtr);
  const Eigen::AlignedBox3d bounds = boundsOf(solids[arguments->primID]);
  const Eigen::Vector3f low = (bounds.min().array() - kMargin_m).cast<float>();
  const Eigen::Vector3f high = (bounds.max().array() + kMargin_m).cast<float>();
  RTCBounds& out = *arguments->bounds_o;
  out = {low.x(), low.y(), low.z(), 0.0F, high.x(), high.y(), high.z(), 0.0F};
}

void intersectCurved(const RTCIntersectFunctionNArguments* arguments) {
  const auto* solids = static_cast<const Solid*>(arguments->geometryUserPtr);
  const unsigned n = arguments->N;
  RTCRayN* rays = RTCRayHitN_RayN(arguments->rayhit, n);
  RTCHitN* hits = RTCRayHitN_HitN(arguments->rayhit, n);
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0) continue;
    const RTCRay from = rtcGetRayFromRayN(rays, n, i);
    const Ray ray = {{from.org_x, from.org_y, from.org_z}, {from.dir_x, from.dir_y, from.dir_z}};
    const std::optional<Hit> hit = intersect(ray, solids[arguments->primID]);
    if (!hit || !(hit->distance_m >= from.tnear && hit->distance_m < from.tfar)) continue;
    RTCRayN_tfar(rays, n, i) = hit->distance_m;
    RTCHitN_geomID(hits, n, i) = arguments->geomID;
    RTCHitN_primID(hits, n, i) = arguments->primID;
    RTCHitN_Ng_x(hits, n, i) = hit->normal.x();
    RTCHitN_Ng_y(hits, n, i) = hit->normal.y();
    RTCHitN_Ng_z(hits, n, i) = hit->normal.z();
  }
}

}  // namespace

RayScene::RayScene(const World& world, InstructionSet widest) {
  boxes_.push_back(floorUnder(world));
  for (const Solid& solid : world.solids) {
    if (!solid.seen) continue;
    if (solid.shape == Shape::kBox)
      boxes_.push_back(solid);
    else if (solid.shape == Shape::kMesh)
      meshes_.push_back(solid);
    else
      curved_.push_back(solid);
  }
  device_ = rtcNewDevice((std::string("threads=1,max_isa=") + nameOf(widest)).c_str());
  if (!device_)
    throw std::runtime_error("Embree could not be started, error " +
                             std::to_string(rtcGetDeviceError(nullptr)));
  takes_sixteen_ = rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0;
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, meshes_.empty() ? RTC_SCENE_FLAG_NONE : RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
  attachBoxes();
  attachCurved();
  for (std::size_t i = 0; i < meshes_.size(); ++i)
    attachMesh(meshes_[i], kFirstMesh + static_cast<unsigned>(i));
  rtcCommitScene(scene_);
  const RTCError error = rtcGetDeviceError(device_);
  if (error != RTC_ERROR_NONE)
    throw std::runtime_error("Embree could not build the scene, error " + std::to_string(error));
}

RayScene::~RayScene() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

/// Of the six faces of each box, two triangles each, counter-clockwise from outside.
void RayScene::attachBoxes() {
  // So that boxes end to end overlap, and no ray slips in between.
  constexpr double kOverlap_m = 4e-6;
  constexpr std::array<std::array<int, 4>, 6> kFaces = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  std::vector<Eigen::Vector3d> corners;
  std::vector<std::array<unsigned, 3>> triangles;
  for (const Solid& box : boxes_) {
    const auto first = static_cast<unsigned>(corners.size());
    const Eigen::Vector3d half = 0.5 * (box.size_m + Eigen::Vector3d::Constant(kOverlap_m));
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d sign((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0,
                                 (i & 4) != 0 ? 1.0 : -1.0);
      corners.push_back(box.world_from_solid * half.cwiseProduct(sign));
    }
    for (const auto& [a, b, c, d] : kFaces) {
      triangles.push_back({first + a, first + b, first + c});
      triangles.push_back({first + a, first + c, first + d});
    }
  }
  attachTriangles(corners, triangles, kBoxes);
}

void RayScene::attachCurved() {
  if (curved_.empty()) return;
  const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(curved_.size()));
  rtcSetGeometryUserData(geometry, const_cast<Solid*>(curved_.data()));
  rtcSetGeometryBoundsFunction(geometry, boundCurved, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersectCurved);
  attach(geometry, kCurved);
}

void RayScene::attachMesh(const Solid& mesh, unsigned number) {
  std::vector<Eigen::Vector3d> vertices;
  for (const Eigen::Vector3f& vertex : mesh.mesh->vertices_m)
    vertices.push_back(mesh.world_from_solid * vertex.cast<double>());
  attachTriangles(vertices, mesh.mesh->triangles, number);
}

void RayScene::attachTriangles(const std::vector<Eigen::Vector3d>& corners,
                               const std::vector<std::array<unsigned, 3>>& triangles,
                               unsigned number) {
  const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), corners.size()));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(unsigned), triangles.size()));
  if (!vertices || !indices)
    throw std::runtime_error("Embree has no memory for the world's triangles");
  for (const Eigen::Vector3d& corner : corners)
    vertices = std::copy_n(corner.cast<float>().eval().data(), 3, vertices);
  for (const auto& triangle : triangles) indices = std::copy_n(triangle.data(), 3, indices);
  attach(geometry, number);
}

void RayScene::attach(RTCGeometry geometry, unsigned number) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_, geometry, number);
  rtcReleaseGeometry(geometry);
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

}  // namespace ramscout_sim
