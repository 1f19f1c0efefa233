// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/motion/motion_model.hpp"

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {

std::vector<Pose2> MotionModel::predictEach(const std::vector<Pose2>& map_from_base,
                                            std::int64_t from_ns,
                                            std::int64_t to_ns) const {
  const Pose2 moved = motion(from_ns, to_ns).pose;
  std::vector<Pose2> poses;
  poses.reserve(map_from_base.size());
  for (const Pose2& pose : map_from_base) poses.push_back(pose * moved);
  return poses;
}

std::vector<Pose2> MotionModel::sample(const std::vector<Pose2>& map_from_base,
                                       std::int64_t from_ns,
                                       std::int64_t to_ns,
                                       std::uint64_t seed) const {
  const PoseWithCovariance2 mean = motion(from_ns, to_ns);
  std::vector<Pose2> poses;
  poses.reserve(map_from_base.size());
  for (std::size_t i = 0; i < map_from_base.size(); ++i) {
    const Eigen::Vector3d error = Random(seed, i).gaussian(mean.covariance);
    poses.push_back(map_from_base[i] * Pose2{mean.pose.x_m + error.x(), mean.pose.y_m + error.y(),
                                             mean.pose.yaw_rad + error.z()});
  }
  return poses;
}

}  // namespace ram_slam
