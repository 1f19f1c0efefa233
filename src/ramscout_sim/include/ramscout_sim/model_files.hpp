// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// Models reach no farther from their origin than 10 km: more is a sign of another unit than
/// metres.
constexpr double kLargestModel_m = 1e4;

/// The triangles of an STL, DAE or OBJ file, in metres, z up.
///
/// A DAE file states its unit and its up axis itself; STL and OBJ are taken as metres with z up.
/// Lines, points and triangles without area are dropped. \throws std::runtime_error naming the file
/// if it cannot be read, has no triangles, or reaches beyond 10 km (are the units metres?)
TriangleMesh readMesh(const std::string& path);

/// The collision shapes of all links of a URDF, every joint at zero.
/// \throws std::runtime_error or std::invalid_argument naming file, element and reason
std::vector<Solid> readUrdfSolids(const std::string& path);

/// The collision shapes of the static models of an SDF file (1.4 to 1.9): box, cylinder, sphere,
/// mesh, with the poses of model, link and collision. A horizontal plane at z = 0 is the floor,
/// which every world has. Light, physics, plugins and visuals are passed over; whatever else would
/// change the shape of the world (models that move, joints, <include>, height maps, poses relative
/// to other frames) is refused. \throws std::runtime_error or std::invalid_argument naming file,
/// element and reason
std::vector<Solid> readSdfSolids(const std::string& path);

/// Solids of any of these formats, by the suffix. \throws as above, and for any other suffix
std::vector<Solid> readModel(const std::string& path);

/// Whether the suffix is one that readModel knows.
bool isModelFile(const std::string& path);

/// The file that a model's URI means: a path, relative to the folder of `referrer`, or file://path;
/// model://name/rest is looked for beside the folder of `referrer` and in that folder.
/// \throws std::runtime_error if there is none
std::string resolveUri(const std::string& uri, const std::string& referrer);

}  // namespace ramscout_sim
