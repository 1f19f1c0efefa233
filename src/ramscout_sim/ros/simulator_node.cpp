// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/ros/simulator_node.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include <rosgraph_msgs/Clock.h>

#include "ramscout_sim/ros/conversions.hpp"
#include "ramscout_sim/ros/load_members.hpp"

namespace ramscout_sim_ros {
SimulatorNode::SimulatorNode(ram_parameters::ParameterReader& reader)
    : parameters_(ramscout_sim::readSimulatorNodeParameters(reader)),
      world_(parameters_.world.empty() ? ramscout_sim::World()
                                       : ramscout_sim::readWorld(parameters_.world)),
      members_(loadMembers(parameters_, world_)),
      fleet_(members_, world_),
      real_time_factor_(parameters_.real_time_factor),
      lock_step_(node_, parameters_.lock_step, parameters_.topics.queue_length) {
  advertise();
  restartPace();
  for (std::size_t i = 0; i < members_.size(); ++i) {
    ROS_INFO_STREAM("Simulating '"
                    << members_[i].robot.name << "' among " << world_.solids.size() << " solids; "
                    << (members_[i].tour ? "driving a tour of " +
                                               std::to_string(members_[i].tour->length_m()) + " m"
                                         : "listening to " + robots_[i]->commandTopic()));
  }
  thread_ = std::thread([this] {
    try {
      run();
    } catch (const std::exception& error) {
      ROS_FATAL_STREAM(error.what() << "; the last good state is the last that was published");
      ros::requestShutdown();
    }
  });
}

SimulatorNode::~SimulatorNode() {
  {
    const std::lock_guard<FairMutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void SimulatorNode::advertise() {
  clock_ = node_.advertise<rosgraph_msgs::Clock>(
      "/clock", static_cast<std::uint32_t>(parameters_.topics.queue_length));
  for (std::size_t i = 0; i < members_.size(); ++i) {
    robots_.push_back(std::make_unique<RobotInterface>(
        parameters_.robots[i].name, members_[i], parameters_.topics,
        [this, i](const std::function<void(ramscout_sim::Simulation&)>& use) {
          const std::lock_guard<FairMutex> lock(mutex_);
          use(fleet_[i]);
        }));
  }
  services_ = {private_node_.advertiseService("pause", &SimulatorNode::onPause, this),
               private_node_.advertiseService("reset", &SimulatorNode::onReset, this),
               private_node_.advertiseService("set_rate", &SimulatorNode::onSetRate, this),
               private_node_.advertiseService("step", &SimulatorNode::onStep, this)};
}

/// Returns false when the node stops.
bool SimulatorNode::waitUntilRunning() {
  std::unique_lock<FairMutex> lock(mutex_);
  while (!stopping_ && ros::ok() && paused_ && fleet_.now_ns() >= step_until_ns_) {
    wake_.notify_all();
    wake_.wait_for(lock, std::chrono::milliseconds(50));
  }
  return !stopping_ && ros::ok();
}

void SimulatorNode::run() {
  lock_step_.waitForStart(robots_.front()->scans());
  {
    const std::lock_guard<FairMutex> lock(mutex_);
    restartPace();
  }
  while (waitUntilRunning()) {
    std::vector<ramscout_sim::Outputs> outputs;
    ros::Time now;
    {
      const std::lock_guard<FairMutex> lock(mutex_);
      outputs = fleet_.step();
      now = toRosTime(fleet_.now_ns());
      lock_step_.setNow(now);
      publishClock();
      for (std::size_t i = 0; i < robots_.size(); ++i) robots_[i]->publishState(fleet_[i]);
    }
    publish(outputs, now);
    keepPace();
  }
}

/// Then waits for the answers to the scans.
void SimulatorNode::publish(const std::vector<ramscout_sim::Outputs>& outputs,
                            const ros::Time& now) {
  for (std::size_t i = 0; i < robots_.size(); ++i) robots_[i]->publish(outputs[i], tf_);
  for (const ramscout_sim::Outputs& output : outputs) {
    if (!output.scan) continue;
    const ros::Time stamp = toRosTime(output.scan->stamp_ns);
    lock_step_.setNow(std::max(stamp, now));  // the clock of a lidar may be ahead
    lock_step_.waitFor(stamp);
  }
}

void SimulatorNode::publishClock() {
  if (fleet_.now_ns() < next_clock_ns_) return;
  rosgraph_msgs::Clock message;
  message.clock = toRosTime(fleet_.now_ns());
  clock_.publish(message);
  next_clock_ns_ = fleet_.now_ns() + std::llround(1e9 / parameters_.clock_rate_hz);
}

void SimulatorNode::restartPace() {
  pace_wall_start_ = ros::SteadyTime::now();
  pace_start_ns_ = fleet_.now_ns();
}

/// Sleeps while the simulation is ahead of the wanted rate; a simulation that was late does not
/// hurry afterwards.
void SimulatorNode::keepPace() {
  double ahead_s = 0.0;
  {
    const std::lock_guard<FairMutex> lock(mutex_);
    if (real_time_factor_ == 0.0) return;
    const double simulated_s = static_cast<double>(fleet_.now_ns() - pace_start_ns_) * 1e-9;
    ahead_s = simulated_s / real_time_factor_ - (ros::SteadyTime::now() - pace_wall_start_).toSec();
    if (ahead_s < -parameters_.late_s) restartPace();
  }
  if (ahead_s > 1e-3)
    std::this_thread::sleep_for(
        std::chrono::duration<double>(std::min(ahead_s, parameters_.late_s)));
}

bool SimulatorNode::onPause(std_srvs::SetBool::Request& request,
                            std_srvs::SetBool::Response& response) {
  const std::lock_guard<FairMutex> lock(mutex_);
  paused_ = request.data;
  step_until_ns_ = 0;
  restartPace();
  wake_.notify_all();
  response.success = true;
  return true;
}

bool SimulatorNode::onReset(std_srvs::Empty::Request&, std_srvs::Empty::Response&) {
  const std::lock_guard<FairMutex> lock(mutex_);
  fleet_ = ramscout_sim::Fleet(members_, world_);
  lock_step_.reset();
  next_clock_ns_ = 0;
  for (const auto& robot : robots_) robot->forgetState();
  step_until_ns_ = 0;
  restartPace();
  return true;
}

bool SimulatorNode::onSetRate(ramscout_sim::SetRate::Request& request,
                              ramscout_sim::SetRate::Response& response) {
  try {
    ramscout_sim::SimulatorNodeParameters wanted = parameters_;
    wanted.real_time_factor = request.real_time_factor;
    wanted.validate();
    response.success = true;
  } catch (const std::invalid_argument& error) {
    response.message = error.what();
    return true;
  }
  const std::lock_guard<FairMutex> lock(mutex_);
  real_time_factor_ = request.real_time_factor;
  restartPace();
  return true;
}

bool SimulatorNode::onStep(ramscout_sim::Step::Request& request,
                           ramscout_sim::Step::Response& response) {
  std::unique_lock<FairMutex> lock(mutex_);
  response.now = toRosTime(fleet_.now_ns());
  if (!(request.duration > 0.0 && request.duration <= parameters_.max_step_s)) {
    response.message = "duration must be in (0, " + std::to_string(parameters_.max_step_s) +
                       "] s, got " + std::to_string(request.duration);
    return true;
  }
  if (!paused_) {
    response.message = "the simulation is not paused";
    return true;
  }
  step_until_ns_ = fleet_.now_ns() + std::llround(request.duration * 1e9);
  restartPace();
  wake_.notify_all();
  while (!stopping_ && ros::ok() && paused_ && fleet_.now_ns() < step_until_ns_) {
    wake_.wait_for(lock, std::chrono::milliseconds(5));
  }
  response.now = toRosTime(fleet_.now_ns());
  response.success = step_until_ns_ > 0 && fleet_.now_ns() >= step_until_ns_;
  if (!response.success) response.message = "interrupted";
  return true;
}

}  // namespace ramscout_sim_ros
