// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>
#include <string>

#include <ros/ros.h>

#include "ram_slam/motion/motion_model.hpp"

namespace ram_slam_ros {

/// The motion model behind the services `kinematics/predict`, `kinematics/predict_with_covariance`
/// and `kinematics/sample_states`, over connections that persist and are renewed after a failure.
class KinematicsClient : public ram_slam::MotionModel {
public:
  explicit KinematicsClient(const ros::NodeHandle& node) : node_(node) {}

  /// \throws std::out_of_range if the service is not there or refuses, which it does without a
  /// reason
  ram_slam::PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const override;
  /// One call for each pose. \throws as motion()
  std::vector<ram_slam::Pose2> predictEach(const std::vector<ram_slam::Pose2>& map_from_base,
                                           std::int64_t from_ns,
                                           std::int64_t to_ns) const override;
  /// \throws as motion(), with the service's reason
  std::vector<ram_slam::Pose2> sample(const std::vector<ram_slam::Pose2>& map_from_base,
                                      std::int64_t from_ns,
                                      std::int64_t to_ns,
                                      std::uint64_t seed) const override;

  /// Why there have been no answers for a second, and what to do; empty if there are some. Any
  /// thread may call.
  std::string problem() const;

private:
  /// What problem() needs to know of the calls.
  struct Calls {
    double began_s = 0.0;          ///< the one that goes on; 0: none does
    double failing_since_s = 0.0;  ///< 0: the newest one did not fail
    double failed_s = 0.0;         ///< the newest failure
    bool is_missing = false;       ///< no node offers the service
    std::string service;
  };
  void begin(const std::string& service) const;
  void end(bool has_succeeded, bool is_missing) const;

  template <typename Service>
  void call(ros::ServiceClient& client, const char* name, Service& service) const;

  mutable std::mutex mutex_;
  mutable Calls calls_;
  mutable ros::NodeHandle node_;
  mutable ros::ServiceClient predict_;
  mutable ros::ServiceClient predict_state_;
  mutable ros::ServiceClient sample_;
};

}  // namespace ram_slam_ros
