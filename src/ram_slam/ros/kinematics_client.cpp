// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics_client.hpp"

#include <stdexcept>

#include <ram_slam_msgs/PredictStateWithCovariance.h>
#include <ram_slam_msgs/SampleStates.h>

#include "ram_slam/ros/conversions.hpp"

namespace ram_slam_ros {
namespace {

using ram_slam::Pose2;
using ram_slam::PoseWithCovariance2;

constexpr std::size_t kStateSize = 3;

}  // namespace

template <typename Service>
void KinematicsClient::call(ros::ServiceClient& client, const char* name, Service& service) const {
  if (!client.isValid()) client = node_.serviceClient<Service>(name, true);
  if (client.call(service)) return;
  // Either a refusal or a broken connection; renewing it costs a millisecond. Without the master it
  // could not be renewed, and is kept.
  if (!client.isValid() || ros::master::check()) client.shutdown();
  throw std::out_of_range("service " + node_.resolveName(name) +
                          " is not there or does not cover the interval");
}

PoseWithCovariance2 KinematicsClient::motion(std::int64_t from_ns, std::int64_t to_ns) const {
  ram_slam_msgs::PredictStateWithCovariance service;
  service.request.state.assign(kStateSize, 0.0F);
  service.request.cov.assign(kStateSize * kStateSize, 0.0F);
  service.request.from = toTime(from_ns);
  service.request.to = toTime(to_ns);
  call(predict_, "kinematics/predict_with_covariance", service);
  const auto& state = service.response.state;
  const auto& covariance = service.response.cov;
  if (state.size() != kStateSize || covariance.size() != kStateSize * kStateSize) {
    throw std::out_of_range("kinematics answered with a state of " + std::to_string(state.size()) +
                            " values");
  }
  PoseWithCovariance2 motion;
  motion.pose = {state[0], state[1], state[2]};
  for (std::size_t i = 0; i < covariance.size(); ++i) {
    motion.covariance(static_cast<int>(i / kStateSize), static_cast<int>(i % kStateSize)) =
        covariance[i];
  }
  return motion;
}

std::vector<Pose2> KinematicsClient::sample(const std::vector<Pose2>& map_from_base,
                                            std::int64_t from_ns,
                                            std::int64_t to_ns,
                                            std::uint64_t seed) const {
  ram_slam_msgs::SampleStates service;
  service.request.count = static_cast<std::uint32_t>(map_from_base.size());
  for (const Pose2& pose : map_from_base) {
    service.request.states.insert(service.request.states.end(), {pose.x_m, pose.y_m, pose.yaw_rad});
  }
  service.request.from = toTime(from_ns);
  service.request.to = toTime(to_ns);
  service.request.seed = seed;
  call(sample_, "kinematics/sample_states", service);
  if (service.response.status != ram_slam_msgs::SampleStates::Response::SUCCESS) {
    throw std::out_of_range(service.response.message);
  }
  const auto& states = service.response.states;
  if (states.size() != kStateSize * map_from_base.size()) {
    throw std::out_of_range("kinematics answered with " + std::to_string(states.size()) +
                            " values");
  }
  std::vector<Pose2> samples;
  for (std::size_t i = 0; i < states.size(); i += kStateSize) {
    samples.push_back({states[i], states[i + 1], states[i + 2]});
  }
  return samples;
}

}  // namespace ram_slam_ros
