// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics_client.hpp"

#include <stdexcept>

#include <ram_slam_msgs/PredictState.h>
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
  const bool is_missing = !client.isValid();
  begin(node_.resolveName(name));
  const bool has_succeeded = client.call(service);
  end(has_succeeded, is_missing);
  if (has_succeeded) return;
  // Either a refusal or a broken connection; renewing it costs a millisecond. Without the master it
  // could not be renewed, and is kept.
  if (!client.isValid() || ros::master::check()) client.shutdown();
  throw std::out_of_range("service " + node_.resolveName(name) +
                          " is not there or does not cover the interval");
}

void KinematicsClient::begin(const std::string& service) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  calls_.service = service;
  calls_.began_s = ros::SteadyTime::now().toSec();
}

void KinematicsClient::end(bool has_succeeded, bool is_missing) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double now_s = ros::SteadyTime::now().toSec();
  calls_.began_s = 0.0;
  calls_.is_missing = is_missing;
  if (has_succeeded) {
    calls_.failing_since_s = 0.0;
    return;
  }
  if (calls_.failing_since_s == 0.0) calls_.failing_since_s = now_s;
  calls_.failed_s = now_s;
}

std::string KinematicsClient::problem() const {
  constexpr double kPatienceS = 1.0;
  const std::lock_guard<std::mutex> lock(mutex_);
  const double now_s = ros::SteadyTime::now().toSec();
  if (calls_.began_s > 0.0 && now_s - calls_.began_s > kPatienceS) {
    return "the service " + calls_.service +
           " does not answer: kinematics is stopped or hangs; start it again";
  }
  if (calls_.failing_since_s == 0.0 || now_s - calls_.failing_since_s < kPatienceS) return "";
  return calls_.is_missing
             ? "no node offers the service " + calls_.service +
                   "; start kinematics (features.launch)"
             : "the service " + calls_.service +
                   " knows no motion up to the features: it gets no odometry of that time; see "
                   "what kinematics reports";
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

std::vector<Pose2> KinematicsClient::predictEach(const std::vector<Pose2>& map_from_base,
                                                 std::int64_t from_ns,
                                                 std::int64_t to_ns) const {
  std::vector<Pose2> predicted;
  for (const Pose2& pose : map_from_base) {
    // A float has 24 bits: about the first pose, which any world frame may be, they are enough.
    const Pose2 about_first = map_from_base.front().inverse() * pose;
    ram_slam_msgs::PredictState service;
    service.request.state = {static_cast<float>(about_first.x_m),
                             static_cast<float>(about_first.y_m),
                             static_cast<float>(about_first.yaw_rad)};
    service.request.from = toTime(from_ns);
    service.request.to = toTime(to_ns);
    call(predict_state_, "kinematics/predict", service);
    const auto& state = service.response.state;
    if (state.size() != kStateSize) {
      throw std::out_of_range("kinematics answered with a state of " +
                              std::to_string(state.size()) + " values");
    }
    predicted.push_back(map_from_base.front() * Pose2{state[0], state[1], state[2]});
  }
  return predicted;
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
