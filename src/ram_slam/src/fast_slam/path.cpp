// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/path.hpp"

#include <algorithm>

namespace ram_slam {

// A loop, because the recursion of the default would exhaust the stack on a long path.
Path::Node::~Node() {
  std::shared_ptr<Node> node = std::move(parent);
  while (node != nullptr && node.use_count() == 1) {
    std::shared_ptr<Node> before = std::move(node->parent);
    node = std::move(before);
  }
}

void Path::append(const StampedPose2& pose) {
  const bool again = last_ != nullptr && last_->pose.stamp_ns == pose.stamp_ns;
  last_ = std::make_shared<Node>(pose, again ? last_->parent : std::move(last_));
}

void Path::moveLast(const Pose2& new_from_old) {
  if (!empty()) append({last_->pose.stamp_ns, new_from_old * last_->pose.pose});
}

std::vector<StampedPose2> Path::poses() const {
  std::vector<StampedPose2> poses;
  for (const Node* node = last_.get(); node != nullptr; node = node->parent.get()) {
    poses.push_back(node->pose);
  }
  std::reverse(poses.begin(), poses.end());
  return poses;
}

}  // namespace ram_slam
