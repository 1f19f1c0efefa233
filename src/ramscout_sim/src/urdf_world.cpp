// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <stdexcept>

#include <urdf_parser/urdf_parser.h>

#include "ramscout_sim/model_files.hpp"

#include "parser_log.hpp"
#include "xml_text.hpp"

namespace ramscout_sim {
namespace {

[[noreturn]] void refuse(const std::string& element, const std::string& reason) {
  throw std::invalid_argument(element + ": " + reason);
}

Eigen::Isometry3d toIsometry(const urdf::Pose& pose, const std::string& element) {
  const urdf::Rotation& r = pose.rotation;
  const Eigen::Vector3d p(pose.position.x, pose.position.y, pose.position.z);
  const Eigen::Quaterniond q(r.w, r.x, r.y, r.z);
  if (!(p.cwiseAbs().maxCoeff() <= kLargestModel_m) || !q.coeffs().allFinite() || q.norm() < 0.5) {
    refuse(element, "origin must be finite and within 10 km");
  }
  return Eigen::Translation3d(p) * q.normalized();
}

Solid readShape(const urdf::Geometry& geometry,
                const std::string& element,
                const std::string& path) {
  Solid solid;
  if (geometry.type == urdf::Geometry::BOX) {
    const urdf::Vector3& size = static_cast<const urdf::Box&>(geometry).dim;
    solid.size_m = {size.x, size.y, size.z};
  } else if (geometry.type == urdf::Geometry::CYLINDER) {
    const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
    solid.shape = Shape::kCylinder;
    solid.size_m = {2.0 * cylinder.radius, 2.0 * cylinder.radius, cylinder.length};
  } else if (geometry.type == urdf::Geometry::SPHERE) {
    solid.shape = Shape::kSphere;
    solid.size_m.setConstant(2.0 * static_cast<const urdf::Sphere&>(geometry).radius);
  } else {
    const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
    TriangleMesh triangles = readMesh(resolveUri(mesh.filename, path));
    const Eigen::Vector3f scale =
        Eigen::Vector3d(mesh.scale.x, mesh.scale.y, mesh.scale.z).cast<float>();
    if (!(scale.cwiseAbs().minCoeff() > 0.0F && scale.cwiseAbs().maxCoeff() <= 1e4F)) {
      refuse(element, "a mesh's scale must not be 0");
    }
    for (Eigen::Vector3f& vertex : triangles.vertices_m) vertex = vertex.cwiseProduct(scale);
    solid.shape = Shape::kMesh;
    solid.mesh = std::make_shared<TriangleMesh>(std::move(triangles));
  }
  if (!(solid.size_m.minCoeff() > 0.0 && solid.size_m.maxCoeff() <= kLargestModel_m)) {
    refuse(element, "sizes must be above 0 and at most 10 km");
  }
  return solid;
}

void addLink(const urdf::Link& link,
             const Eigen::Isometry3d& world_from_link,
             const std::string& path,
             std::vector<Solid>& solids) {
  const std::string element = path + ": link '" + link.name + "'";
  for (const auto& collision : link.collision_array) {
    if (!collision->geometry) refuse(element, "a collision has no geometry");
    Solid solid = readShape(*collision->geometry, element, path);
    solid.world_from_solid = world_from_link * toIsometry(collision->origin, element);
    solids.push_back(solid);
  }
  for (const auto& child : link.child_links) {
    const Eigen::Isometry3d link_from_child =
        toIsometry(child->parent_joint->parent_to_joint_origin_transform,
                   path + ": joint '" + child->parent_joint->name + "'");
    addLink(*child, world_from_link * link_from_child, path, solids);
  }
}

}  // namespace

std::vector<Solid> readUrdfSolids(const std::string& path) {
  const std::string text = readXml(path);
  const ParserLog log;
  std::shared_ptr<urdf::ModelInterface> model;
  try {
    requireShallowXml(text);
    model = urdf::parseURDF(text);
  } catch (const std::exception& error) {
    refuse(path, error.what());
  }
  if (!model || !model->getRoot()) refuse(path, "not a URDF: " + log.errors());
  std::vector<Solid> solids;
  addLink(*model->getRoot(), Eigen::Isometry3d::Identity(), path, solids);
  if (solids.empty()) refuse(path, "no link has a collision element");
  return solids;
}

}  // namespace ramscout_sim
