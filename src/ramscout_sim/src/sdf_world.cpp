// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

#include <tinyxml2.h>

#include "ramscout_sim/model_files.hpp"

namespace ramscout_sim {
namespace {

using tinyxml2::XMLElement;

/// Elements that do not change what a lidar or a chassis meets.
const std::set<std::string> kHarmless = {"visual",
                                         "light",
                                         "physics",
                                         "scene",
                                         "gui",
                                         "gravity",
                                         "plugin",
                                         "audio",
                                         "wind",
                                         "atmosphere",
                                         "inertial",
                                         "self_collide",
                                         "kinematic",
                                         "magnetic_field",
                                         "surface",
                                         "max_contacts",
                                         "state",
                                         "spherical_coordinates",
                                         "laser_retro",
                                         "enable_wind",
                                         "allow_auto_disable",
                                         "sensor"};

[[noreturn]] void refuse(const std::string& element, const std::string& reason) {
  throw std::invalid_argument(element + ": " + reason);
}

class SdfReader {
public:
  explicit SdfReader(std::string path) : path_(std::move(path)) {}

  std::vector<Solid> read() {
    tinyxml2::XMLDocument document;
    if (document.LoadFile(path_.c_str()) != tinyxml2::XML_SUCCESS) {
      throw std::runtime_error(path_ + ": not XML: " + document.ErrorStr());
    }
    const XMLElement* root = document.FirstChildElement("sdf");
    if (!root) refuse(path_, "the root element must be <sdf>");
    for (const XMLElement* child = root->FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      const std::string name = child->Name();
      if (name == "world") {
        readWorld(*child);
      } else if (name == "model") {
        readModel(*child);
      } else if (kHarmless.count(name) == 0) {
        refuse(where(*child), "is not supported");
      }
    }
    if (solids_.empty()) refuse(path_, "has no collision shape that stands still");
    return solids_;
  }

private:
  std::string where(const XMLElement& element) const {
    const char* name = element.Attribute("name");
    return path_ + ": line " + std::to_string(element.GetLineNum()) + ": <" + element.Name() +
           (name ? std::string(" name='") + name + "'>" : ">");
  }

  void readWorld(const XMLElement& world) {
    for (const XMLElement* child = world.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      const std::string name = child->Name();
      if (name == "model") {
        readModel(*child);
      } else if (kHarmless.count(name) == 0) {
        refuse(where(*child), "is not supported");
      }
    }
  }

  void readModel(const XMLElement& model) {
    const XMLElement* fixed = model.FirstChildElement("static");
    bool is_static = false;
    if (!fixed || fixed->QueryBoolText(&is_static) != tinyxml2::XML_SUCCESS || !is_static) {
      refuse(where(model),
             "is not static; only <static>true</static> models can be part of a world");
    }
    const Eigen::Isometry3d world_from_model = readPose(model);
    for (const XMLElement* child = model.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      const std::string name = child->Name();
      if (name == "link") {
        readLink(*child, world_from_model);
      } else if (name != "static" && name != "pose" && kHarmless.count(name) == 0) {
        refuse(where(*child), "is not supported");
      }
    }
  }

  void readLink(const XMLElement& link, const Eigen::Isometry3d& world_from_model) {
    const Eigen::Isometry3d world_from_link = world_from_model * readPose(link);
    for (const XMLElement* child = link.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      const std::string name = child->Name();
      if (name == "collision") {
        readCollision(*child, world_from_link);
      } else if (name != "pose" && kHarmless.count(name) == 0) {
        refuse(where(*child), "is not supported");
      }
    }
  }

  void readCollision(const XMLElement& collision, const Eigen::Isometry3d& world_from_link) {
    const Eigen::Isometry3d world_from_solid = world_from_link * readPose(collision);
    const XMLElement* geometry = collision.FirstChildElement("geometry");
    const XMLElement* shape = geometry ? geometry->FirstChildElement() : nullptr;
    if (!shape) refuse(where(collision), "has no geometry");
    const std::string name = shape->Name();
    if (name == "plane") {
      requireFloor(*shape, world_from_solid);
      return;
    }
    Solid solid;
    solid.world_from_solid = world_from_solid;
    if (name == "box") {
      const std::vector<double> size = numbers(*shape, "size", 3);
      solid.size_m = {size[0], size[1], size[2]};
    } else if (name == "cylinder") {
      const double radius_m = numbers(*shape, "radius", 1)[0];
      solid.shape = Shape::kCylinder;
      solid.size_m = {2.0 * radius_m, 2.0 * radius_m, numbers(*shape, "length", 1)[0]};
    } else if (name == "sphere") {
      solid.shape = Shape::kSphere;
      solid.size_m.setConstant(2.0 * numbers(*shape, "radius", 1)[0]);
    } else if (name == "mesh") {
      readMeshInto(*shape, solid);
    } else {
      refuse(where(*shape), "is not supported; box, cylinder, sphere, mesh and plane are");
    }
    if (!(solid.size_m.minCoeff() > 0.0)) refuse(where(*shape), "sizes must be above 0");
    solids_.push_back(solid);
  }

  void readMeshInto(const XMLElement& element, Solid& solid) {
    if (element.FirstChildElement("submesh")) refuse(where(element), "<submesh> is not supported");
    const XMLElement* uri = element.FirstChildElement("uri");
    if (!uri || !uri->GetText()) refuse(where(element), "has no <uri>");
    TriangleMesh mesh = readMesh(resolveUri(uri->GetText(), path_));
    if (element.FirstChildElement("scale")) {
      const std::vector<double> scale = numbers(element, "scale", 3);
      for (Eigen::Vector3f& vertex : mesh.vertices_m) {
        vertex = vertex.cwiseProduct(Eigen::Vector3d(scale[0], scale[1], scale[2]).cast<float>());
      }
    }
    solid.shape = Shape::kMesh;
    solid.mesh = std::make_shared<TriangleMesh>(std::move(mesh));
  }

  void requireFloor(const XMLElement& plane, const Eigen::Isometry3d& world_from_plane) const {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    if (plane.FirstChildElement("normal")) {
      const std::vector<double> n = numbers(plane, "normal", 3);
      normal = {n[0], n[1], n[2]};
    }
    normal = world_from_plane.linear() * normal;
    if (!(normal.z() > (1.0 - 1e-9) * normal.norm() && normal.norm() > 0.0) ||
        std::abs(world_from_plane.translation().z()) > 1e-6) {
      refuse(where(plane), "is not the floor z = 0; other planes are not supported");
    }
  }

  Eigen::Isometry3d readPose(const XMLElement& parent) const {
    const XMLElement* pose = parent.FirstChildElement("pose");
    if (!pose) return Eigen::Isometry3d::Identity();
    for (const char* attribute : {"relative_to", "frame"}) {
      const char* frame = pose->Attribute(attribute);
      if (frame && *frame) refuse(where(*pose), "poses relative to other frames are not supported");
    }
    const char* degrees = pose->Attribute("degrees");
    if (degrees && std::string(degrees) != "false")
      refuse(where(*pose), "degrees are not supported");
    const std::vector<double> v = numbers(parent, "pose", 6);
    return Eigen::Translation3d(v[0], v[1], v[2]) *
           Eigen::AngleAxisd(v[5], Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(v[4], Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(v[3], Eigen::Vector3d::UnitX());
  }

  std::vector<double> numbers(const XMLElement& parent, const char* name, std::size_t count) const {
    const XMLElement* element = parent.FirstChildElement(name);
    if (!element) refuse(where(parent), std::string("has no <") + name + ">");
    std::istringstream text(element->GetText() ? element->GetText() : "");
    text.imbue(std::locale::classic());
    std::vector<double> values;
    double value = 0.0;
    while (text >> value) values.push_back(value);
    if (values.size() != count || !text.eof()) {
      refuse(where(*element), "must hold " + std::to_string(count) + " numbers");
    }
    for (const double v : values) {
      if (!(std::abs(v) <= kLargestModel_m)) refuse(where(*element), "is beyond 10 km");
    }
    return values;
  }

  std::string path_;
  std::vector<Solid> solids_;
};

}  // namespace

std::vector<Solid> readSdfSolids(const std::string& path) {
  return SdfReader(path).read();
}

}  // namespace ramscout_sim
