// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

namespace ram_slam {

/// Who publishes which transforms: each frame must have one parent, from one publisher. Two
/// estimators, or two sources of odometry, would move the robot to and fro and ruin every map.
class AuthorityGuard {
public:
  /// A publisher sent the transform parent -> child. \param now_s  wall time
  void add(const std::string& parent,
           const std::string& child,
           const std::string& publisher,
           double now_s);

  /// Of a frame that recently had two publishers or two parents: who they are and what to do.
  /// Empty if there is none.
  std::string conflict(double now_s) const;

private:
  static constexpr double kRecent_s = 3.0;  ///< a node that was started again has a new name

  /// By child; by "parent -> child from publisher", when it was sent last.
  std::map<std::string, std::map<std::string, double>> sent_s_;
};

}  // namespace ram_slam
