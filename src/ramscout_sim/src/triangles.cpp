// SPDX-License-Identifier: BSD-3-Clause
#include "triangles.hpp"

#include <algorithm>
#include <cmath>

namespace ramscout_sim {
namespace {

constexpr double kLargestSagitta_m = 2e-5;  // how far a polygon may be off the circle it stands for
constexpr double kFloorMargin_m = 100.0;

void addBox(const Solid& box, Triangles& mesh) {
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
void addCylinder(const Solid& cylinder, Triangles& mesh) {
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

void addSphere(const Solid& sphere, Triangles& mesh) {
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

void addMesh(const Solid& solid, Triangles& mesh) {
  const unsigned first = static_cast<unsigned>(mesh.vertices.size());
  for (const Eigen::Vector3f& vertex : solid.mesh->vertices_m)
    mesh.vertices.push_back(solid.world_from_solid * vertex.cast<double>());
  for (const auto& [a, b, c] : solid.mesh->triangles)
    mesh.triangles.push_back({first + a, first + b, first + c});
}

void addSolid(const Solid& solid, Triangles& mesh) {
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

}  // namespace

void Triangles::addQuad(const std::array<Eigen::Vector3d, 4>& corners) {
  const unsigned first = static_cast<unsigned>(vertices.size());
  vertices.insert(vertices.end(), corners.begin(), corners.end());
  triangles.push_back({first, first + 1, first + 2});
  triangles.push_back({first, first + 2, first + 3});
}

std::map<SurfaceKind, Triangles> trianglesOf(const World& world) {
  std::map<SurfaceKind, Triangles> meshes;
  for (const Solid& solid : world.solids) {
    if (!solid.seen) continue;
    const bool curved = solid.shape == Shape::kCylinder || solid.shape == Shape::kSphere;
    Triangles& surfaces =
        meshes[{static_cast<std::uint32_t>(solid.material), solid.shape == Shape::kMesh, curved}];
    addSolid(solid, surfaces);
    if (!curved) continue;
    surfaces.solid_by_triangle.resize(surfaces.triangles.size(), surfaces.solids.size());
    surfaces.solids.push_back(solid);
  }
  const Eigen::AlignedBox3d bounds = boundsOf(world);
  const Eigen::Vector3d low = bounds.min() - Eigen::Vector3d::Constant(kFloorMargin_m);
  const Eigen::Vector3d high = bounds.max() + Eigen::Vector3d::Constant(kFloorMargin_m);
  meshes[SurfaceKind()].addQuad(
      {Eigen::Vector3d(low.x(), low.y(), 0.0), Eigen::Vector3d(high.x(), low.y(), 0.0),
       Eigen::Vector3d(high.x(), high.y(), 0.0), Eigen::Vector3d(low.x(), high.y(), 0.0)});
  return meshes;
}

}  // namespace ramscout_sim
