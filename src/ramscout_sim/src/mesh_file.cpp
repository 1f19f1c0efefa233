// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <limits>
#include <new>
#include <stdexcept>

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ramscout_sim/model_files.hpp"

namespace ramscout_sim {
namespace {

// 1 GiB: twenty million triangles of a binary STL file.
constexpr std::uintmax_t kLargestFile_bytes = 1ULL << 30;

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw std::runtime_error(path + ": " + reason);
}

std::string suffixOf(const std::string& path) {
  std::string suffix = std::filesystem::path(path).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return suffix;
}

const aiScene* import(Assimp::Importer& importer, const std::string& path) {
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_LINE | aiPrimitiveType_POINT);
  try {
    return importer.ReadFile(path, aiProcess_Triangulate | aiProcess_PreTransformVertices |
                                       aiProcess_JoinIdenticalVertices | aiProcess_SortByPType);
  } catch (const std::exception& failure) {
    refuse(path, failure.what());
  }
}

/// Assimp crashes on some damaged files (a DAE whose arrays have no count is one) and takes all
/// memory for others: a child process tries first, with room and time for what the size justifies.
[[maybe_unused]] void requireHarmless(const std::string& path, std::uintmax_t size_bytes) {
  const auto patience_s = static_cast<unsigned>(10 + size_bytes / 5'000'000);
  const rlim_t room_bytes = 4'000'000'000 + 64 * size_bytes;
  const pid_t child = fork();
  if (child < 0) refuse(path, "cannot be tried: there are too many processes");
  if (child == 0) {
    const rlimit no_core = {0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    const rlimit room = {room_bytes, room_bytes};
    setrlimit(RLIMIT_AS, &room);
    std::set_new_handler([] { _exit(1); });
    alarm(patience_s);
    try {
      Assimp::Importer importer;
      import(importer, path);
    } catch (...) {
      _exit(0);  // the parent will meet it, too, and report it
    }
    _exit(0);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    refuse(path, "not a mesh: its reader breaks down");
}

/// Assimp hands over a DAE file y up, whatever axis the file names.
Eigen::Vector3f toZUp(const aiVector3D& v, bool y_up) {
  return y_up ? Eigen::Vector3f(v.x, -v.z, v.y) : Eigen::Vector3f(v.x, v.y, v.z);
}

void append(const aiMesh& part, bool y_up, TriangleMesh& mesh) {
  const unsigned first = static_cast<unsigned>(mesh.vertices_m.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i)
    mesh.vertices_m.push_back(toZUp(part.mVertices[i], y_up));
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;  // lines and points
    const std::array<unsigned, 3> corners = {first + face.mIndices[0], first + face.mIndices[1],
                                             first + face.mIndices[2]};
    if (*std::max_element(corners.begin(), corners.end()) >= mesh.vertices_m.size()) continue;
    const Eigen::Vector3f& a = mesh.vertices_m[corners[0]];
    const Eigen::Vector3f normal =
        (mesh.vertices_m[corners[1]] - a).cross(mesh.vertices_m[corners[2]] - a);
    if (normal.squaredNorm() > 0.0F) mesh.triangles.push_back(corners);
  }
}

/// Leaves out vertices that no triangle uses.
TriangleMesh compacted(const TriangleMesh& mesh) {
  const unsigned unused = std::numeric_limits<unsigned>::max();
  std::vector<unsigned> renamed(mesh.vertices_m.size(), unused);
  TriangleMesh used;
  for (const auto& triangle : mesh.triangles) {
    std::array<unsigned, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) {
      unsigned& name = renamed[triangle[i]];
      if (name == unused) {
        name = static_cast<unsigned>(used.vertices_m.size());
        used.vertices_m.push_back(mesh.vertices_m[triangle[i]]);
      }
      corners[i] = name;
    }
    used.triangles.push_back(corners);
  }
  return used;
}

}  // namespace

TriangleMesh readMesh(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) refuse(path, "cannot be opened");
  if (size > kLargestFile_bytes) refuse(path, "is larger than 1 GiB");
#ifndef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION  // a thousand times as slow there
  requireHarmless(path, size);
#endif
  Assimp::Importer importer;
  const aiScene* scene = import(importer, path);
  if (!scene) refuse(path, std::string("not a mesh: ") + importer.GetErrorString());
  TriangleMesh all;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
    append(*scene->mMeshes[i], suffixOf(path) == ".dae", all);
  }
  TriangleMesh mesh = compacted(all);
  if (mesh.triangles.empty()) refuse(path, "has no triangles");
  for (const Eigen::Vector3f& vertex : mesh.vertices_m) {
    if (!(vertex.cwiseAbs().maxCoeff() <= static_cast<float>(kLargestModel_m))) {
      refuse(path, "has a vertex that is not finite or beyond 10 km; are the units metres?");
    }
  }
  return mesh;
}

bool isModelFile(const std::string& path) {
  const std::string suffix = suffixOf(path);
  for (const char* known : {".stl", ".dae", ".obj", ".urdf", ".sdf", ".world"}) {
    if (suffix == known) return true;
  }
  return false;
}

std::vector<Solid> readModel(const std::string& path) {
  if (!isModelFile(path)) {
    refuse(path, "the suffix is none of .stl, .dae, .obj, .urdf, .sdf, .world");
  }
  const std::string suffix = suffixOf(path);
  if (suffix == ".urdf") return readUrdfSolids(path);
  if (suffix == ".sdf" || suffix == ".world") return readSdfSolids(path);
  Solid solid;
  solid.shape = Shape::kMesh;
  solid.mesh = std::make_shared<TriangleMesh>(readMesh(path));
  return {solid};
}

std::string resolveUri(const std::string& uri, const std::string& referrer) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(referrer).parent_path();
  const auto after = [&uri](const std::string& scheme) { return uri.substr(scheme.size()); };
  std::vector<fs::path> candidates;
  if (uri.rfind("model://", 0) == 0) {
    candidates = {folder.parent_path() / after("model://"), folder / after("model://")};
    if (folder.parent_path().empty()) candidates.push_back(fs::path("..") / after("model://"));
  } else if (uri.rfind("file://", 0) == 0) {
    candidates = {folder / after("file://")};
  } else if (uri.find("://") == std::string::npos) {
    candidates = {folder / uri};
  }
  for (const fs::path& candidate : candidates) {
    std::error_code error;
    if (fs::is_regular_file(candidate, error)) return candidate.string();
  }
  refuse(referrer, "mesh '" + uri + "' is not found");
}

}  // namespace ramscout_sim
