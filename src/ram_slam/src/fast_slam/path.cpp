// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/path.hpp"

#include <algorithm>
#include <utility>

#include "ram_slam/fast_slam/particle.hpp"
#include "ram_slam/geometry/trajectory.hpp"

namespace ram_slam {

const ram_parameters::ParameterTable<PathParameters>& PathParameters::table() {
  using P = PathParameters;
  static const auto table =
      ram_parameters::ParameterTable<P>()
          .include(&P::step,
                   motionGateTable("A pose of the path is kept before the robot is farther than "
                                   "this from the one before."),
                   "step_")
          .add("max_poses", &P::max_poses, "", ram_parameters::atLeast(100),
               "When there are more, the older ones are thinned out.");
  return table;
}

// A loop, because the recursion of the default would exhaust the stack on a long path.
Path::Node::~Node() {
  std::shared_ptr<Node> node = std::move(parent);
  while (node != nullptr && node.use_count() == 1) {
    std::shared_ptr<Node> before = std::move(node->parent);
    node = std::move(before);
  }
}

void Path::append(const StampedPose2& pose, const MotionGate& step) {
  const auto replaces = [&] {
    if (last_ == nullptr) return false;
    if (last_->pose.stamp_ns == pose.stamp_ns) return true;
    const Node* key = last_->parent.get();
    return key != nullptr && !step.isReachedBy(key->pose.pose.inverse() * pose.pose);
  };
  last_ = std::make_shared<Node>(pose, replaces() ? last_->parent : std::move(last_));
}

void Path::moveLast(const Pose2& new_from_old) {
  if (!empty()) append({last_->pose.stamp_ns, new_from_old * last_->pose.pose});
}

std::vector<StampedPose2> Path::poses() const {
  std::vector<StampedPose2> poses;
  poses.reserve(size());
  for (const Node* node = last_.get(); node != nullptr; node = node->parent.get()) {
    poses.push_back(node->pose);
  }
  std::reverse(poses.begin(), poses.end());
  return poses;
}

void limitPaths(std::vector<Particle>& particles, std::size_t best, std::size_t max_poses) {
  if (particles[best].path.size() <= max_poses) return;
  Path shorter;
  for (const StampedPose2& pose : withAtMost(particles[best].path.poses(), max_poses / 2))
    shorter.append(pose);
  for (Particle& particle : particles) {
    Path path = shorter;
    path.append(particle.path.last());  // of the same stamp as the best one's
    particle.path = std::move(path);
  }
}

}  // namespace ram_slam
