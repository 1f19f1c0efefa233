// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/ros/lock_step.hpp"

#include <algorithm>
#include <chrono>

#include <boost/bind/bind.hpp>

namespace ramscout_sim_ros {
namespace {

using Clock = std::chrono::steady_clock;

Clock::time_point inSeconds(double duration_s) {
  return Clock::now() + std::chrono::milliseconds(static_cast<std::int64_t>(duration_s * 1e3));
}

}  // namespace

LockStep::LockStep(ros::NodeHandle& node,
                   const ramscout_sim::LockStepParameters& parameters,
                   int queue_length)
    : parameters_(parameters), latest_stamps_(parameters.topics.size()) {
  for (std::size_t i = 0; i < parameters_.topics.size(); ++i) {
    const boost::function<void(const HeaderOnly&)> callback = [this, i](const HeaderOnly& message) {
      onMessage(i, message);
    };
    subscribers_.push_back(node.subscribe<HeaderOnly>(
        parameters_.topics[i], static_cast<std::uint32_t>(queue_length),
        boost::function<void(const boost::shared_ptr<const HeaderOnly>&)>(
            [callback](const boost::shared_ptr<const HeaderOnly>& message) { callback(*message); }),
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
  }
}

void LockStep::onMessage(std::size_t topic, const HeaderOnly& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (message.header.stamp > now_) return;
  latest_stamps_[topic] = std::max(latest_stamps_[topic], message.header.stamp);
  answered_.notify_all();
}

void LockStep::reset() {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::fill(latest_stamps_.begin(), latest_stamps_.end(), ros::Time());
  now_ = ros::Time();
  ++resets_;
  answered_.notify_all();
}

void LockStep::setNow(const ros::Time& now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  now_ = now;
}

bool LockStep::allConnected(const ros::Publisher& scans) const {
  return scans.getNumSubscribers() > 0 && std::all_of(subscribers_.begin(), subscribers_.end(),
                                                      [](const ros::Subscriber& subscriber) {
                                                        return subscriber.getNumPublishers() > 0;
                                                      });
}

void LockStep::waitForStart(const ros::Publisher& scans) {
  if (subscribers_.empty()) return;
  const Clock::time_point deadline = inSeconds(parameters_.start_timeout_s);
  while (ros::ok() && !allConnected(scans)) {
    if (Clock::now() >= deadline) {
      ROS_WARN("Lock step: not every topic has a publisher yet; starting without");
      return;
    }
    ros::WallDuration(0.02).sleep();
  }
}

std::string LockStep::unanswered(const ros::Time& stamp) const {
  std::string names;
  for (std::size_t i = 0; i < latest_stamps_.size(); ++i) {
    if (latest_stamps_[i] < stamp) names += " " + parameters_.topics[i];
  }
  return names;
}

void LockStep::waitFor(const ros::Time& scan_stamp) {
  if (subscribers_.empty()) return;
  std::unique_lock<std::mutex> lock(mutex_);
  const bool answered_before = std::none_of(latest_stamps_.begin(), latest_stamps_.end(),
                                            [](const ros::Time& stamp) { return stamp.isZero(); });
  const double timeout_s = answered_before
                               ? parameters_.timeout_s
                               : std::min(parameters_.first_answer_s, parameters_.timeout_s);
  const Clock::time_point deadline = inSeconds(timeout_s);
  const int resets = resets_;
  while (ros::ok() && resets == resets_ && !unanswered(scan_stamp).empty()) {
    if (Clock::now() >= deadline) {
      ROS_WARN_STREAM("Lock step: no answer to the scan of "
                      << scan_stamp << " s within " << timeout_s << " s on"
                      << unanswered(scan_stamp) << "; the simulation continues without");
      return;
    }
    answered_.wait_for(lock, std::chrono::duration<double>(parameters_.poll_s));
  }
}

}  // namespace ramscout_sim_ros
