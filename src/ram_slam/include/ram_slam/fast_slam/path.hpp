// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// Which poses the filters keep of the way that was driven.
struct PathParameters {
  MotionGate step{0.05, 0.05};
  int max_poses = 20000;

  static const ram_parameters::ParameterTable<PathParameters>& table();
};

/// The path of a particle back to the start. Particles with a common ancestor share the path up to
/// it, so that the paths of all M particles over T updates take O(T + M log M) on average once the
/// filter resamples.
///
/// It consists of key poses and the newest pose. Between a key pose and the next one the robot was
/// nearer to the first than a step: at rest a path does not grow.
class Path {
public:
  /// A pose of the same stamp as the last one replaces it, and so does one that is within a step of
  /// the key pose before.
  /// \param step  one that every motion reaches keeps all poses
  void append(const StampedPose2& pose, const MotionGate& step = {});
  /// Moves the last pose to new_from_old * pose.
  void moveLast(const Pose2& new_from_old);
  bool empty() const { return last_ == nullptr; }
  std::size_t size() const { return last_ == nullptr ? 0 : last_->size; }
  /// \pre not empty
  const StampedPose2& last() const { return last_->pose; }
  /// Oldest pose first.
  std::vector<StampedPose2> poses() const;

private:
  struct Node {
    StampedPose2 pose;
    std::shared_ptr<Node> parent;
    std::size_t size;  ///< of the path up to here
    Node(const StampedPose2& last, std::shared_ptr<Node> before)
        : pose(last), parent(std::move(before)), size(parent == nullptr ? 1 : parent->size + 1) {}
    Node(const Node&) = delete;
    Node& operator=(const Node&) = delete;
    ~Node();
  };
  std::shared_ptr<Node> last_;
};

}  // namespace ram_slam
