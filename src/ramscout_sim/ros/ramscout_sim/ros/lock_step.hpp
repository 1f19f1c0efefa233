// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include <ros/ros.h>

#include "ramscout_sim/ros/header_only.hpp"
#include "ramscout_sim/simulator_node_parameters.hpp"

namespace ramscout_sim_ros {

/// Lets the simulation wait until those who work on its scans are done with the last one: a scan is
/// answered when every topic has brought a message with the scan's stamp or a later one.
class LockStep {
public:
  LockStep(ros::NodeHandle& node,
           const ramscout_sim::LockStepParameters& parameters,
           int queue_length);

  /// Blocks until everybody is connected, shutdown, or the time-out. \param scans  the topic the
  /// others listen to
  void waitForStart(const ros::Publisher& scans);

  /// Blocks until the scan with this stamp is answered, shutdown, or the time-out (warns then).
  /// Callbacks must be served by another thread.
  void waitFor(const ros::Time& scan_stamp);

  /// Sets the simulated time before anything of that time goes out: messages of a later stamp are
  /// left over from before a reset and no answers.
  void setNow(const ros::Time& now);

  /// Forgets the answers so far and ends a wait: after a reset stamps start again.
  void reset();

private:
  void onMessage(std::size_t topic, const HeaderOnly& message);
  bool allConnected(const ros::Publisher& scans) const;
  std::string unanswered(const ros::Time& stamp) const;

  ramscout_sim::LockStepParameters parameters_;
  std::vector<ros::Subscriber> subscribers_;
  std::mutex mutex_;
  std::condition_variable answered_;
  std::vector<ros::Time> latest_stamps_;
  ros::Time now_;
  int resets_ = 0;
};

}  // namespace ramscout_sim_ros
