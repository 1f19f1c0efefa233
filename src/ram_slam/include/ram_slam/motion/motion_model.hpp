// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// What an estimator asks of the kinematics block: how the robot moved between two stamps, and how
/// certain that is. In process it is the kinematics library; in a ROS graph a client of the
/// kinematics services.
class MotionModel {
public:
  virtual ~MotionModel() = default;

  /// The base at `to_ns` seen from the base at `from_ns`, with the covariance of the motion's
  /// noise: the answer of PredictStateWithCovariance for the zero state with zero covariance.
  /// \throws std::invalid_argument if to < from or a stamp is not positive
  /// \throws std::out_of_range if the odometry does not cover the interval; the message names what
  /// is buffered
  virtual PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const = 0;

  /// Each pose moved by the odometry without noise: the answers of PredictState. \throws as
  /// motion()
  virtual std::vector<Pose2> predictEach(const std::vector<Pose2>& map_from_base,
                                         std::int64_t from_ns,
                                         std::int64_t to_ns) const;

  /// Each pose moved by a motion of its own, sampled from the model: here from the normal
  /// distribution that motion() returns. The same seed gives the same poses. \throws as motion()
  virtual std::vector<Pose2> sample(const std::vector<Pose2>& map_from_base,
                                    std::int64_t from_ns,
                                    std::int64_t to_ns,
                                    std::uint64_t seed) const;
};

}  // namespace ram_slam
