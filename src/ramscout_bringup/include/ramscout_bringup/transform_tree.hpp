// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace ramscout_bringup {

/// The transforms of a whole recording. Unlike tf2::BufferCore, whose queries step through the
/// history of a frame, it answers for any instant in logarithmic time.
class TransformTree {
public:
  /// A transform that was published. Frames lose a leading slash; one that is not finite, whose
  /// frames are equal or empty, or whose child has another parent already, is ignored and counted.
  void add(const std::string& parent,
           const std::string& child,
           std::int64_t stamp_ns,
           const Eigen::Isometry3d& parent_from_child,
           bool is_static);
  /// Call once after the last add().
  void finish();

  bool has(const std::string& frame) const;
  /// Whether a chain of transforms, in whichever direction, connects the frames.
  bool connects(const std::string& target, const std::string& source) const;
  /// Whether no transform of that chain ever changes.
  bool isConstant(const std::string& target, const std::string& source) const;
  /// Stamps at which a transform of the chain that changes was published, in rising order.
  std::vector<std::int64_t> stamps(const std::string& target, const std::string& source) const;
  /// Interpolated (slerp) where a transform changes. \return nothing if the frames are not
  /// connected, or a transform that changes is not known at the instant
  std::optional<Eigen::Isometry3d> lookup(const std::string& target,
                                          const std::string& source,
                                          std::int64_t stamp_ns) const;

  /// The parent of a frame; empty if it has none.
  std::string parent(const std::string& frame) const;
  /// The farthest ancestor to which a frame is fixed; the frame itself if it has none.
  std::string fixedAncestor(const std::string& frame) const;

  /// All frames, separated by commas; "none" if there is none.
  std::string frames() const;
  std::size_t ignoredCount() const { return ignored_count_; }

private:
  struct Sample {
    std::int64_t stamp_ns;
    Eigen::Quaterniond rotation;
    Eigen::Vector3d translation_m;
  };
  struct Edge {
    std::string parent;
    std::vector<Sample> samples;  ///< one if constant
    bool is_static = false;
  };
  /// Edges from a frame up to its root, by their children.
  std::vector<const Edge*> chain(std::string frame) const;
  /// The chains of two frames without their common part. \return nothing if they do not meet
  std::optional<std::pair<std::vector<const Edge*>, std::vector<const Edge*>>> path(
      const std::string& target, const std::string& source) const;
  /// The frame below the edges, seen from the one above them.
  static std::optional<Eigen::Isometry3d> ancestorFrom(const std::vector<const Edge*>& edges,
                                                       std::int64_t stamp_ns);
  static std::optional<Eigen::Isometry3d> at(const Edge& edge, std::int64_t stamp_ns);

  std::map<std::string, Edge> edges_;  ///< by child
  std::size_t ignored_count_ = 0;
};

}  // namespace ramscout_bringup
