// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// The path of a particle back to the start. Particles with a common ancestor share the path up to
/// it, so that the paths of all M particles over T updates take O(T + M log M) on average once the
/// filter resamples.
class Path {
public:
  /// A pose of the same stamp as the last one replaces it.
  void append(const StampedPose2& pose);
  /// Moves the last pose to new_from_old * pose.
  void moveLast(const Pose2& new_from_old);
  bool empty() const { return last_ == nullptr; }
  /// Oldest pose first.
  std::vector<StampedPose2> poses() const;

private:
  struct Node {
    StampedPose2 pose;
    std::shared_ptr<Node> parent;
    Node(const StampedPose2& last, std::shared_ptr<Node> before)
        : pose(last), parent(std::move(before)) {}
    Node(const Node&) = delete;
    Node& operator=(const Node&) = delete;
    ~Node();
  };
  std::shared_ptr<Node> last_;
};

}  // namespace ram_slam
