// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/ros/simulator_node.hpp"

#include <chrono>
#include <cmath>
#include <stdexcept>

#include <nav_msgs/Odometry.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/LaserScan.h>
#include <std_msgs/Float32.h>
#include <std_msgs/String.h>

#include "ramscout_sim/ros/conversions.hpp"

namespace ramscout_sim_ros {
namespace {

constexpr double kMaxRealTimeFactor = 1000.0;
constexpr double kMaxStep_s = 3600.0;
constexpr double kProgressStep = 1e-3;

bool isRate(double real_time_factor) {
  return real_time_factor >= 0.0 && real_time_factor <= kMaxRealTimeFactor;
}

ramscout_sim::RobotDescription loadRobot(const SimulatorParameters& parameters) {
  if (!parameters.robot.empty())
    return ramscout_sim::readRobot(parameters.robot, parameters.laser_frame);
  std::string urdf;
  if (!ros::param::get("robot_description", urdf)) {
    throw std::invalid_argument(
        "neither the parameter robot nor robot_description is set: which robot?");
  }
  return ramscout_sim::parseRobot(urdf, parameters.laser_frame);
}

}  // namespace

void SimulatorParameters::validate() const {
  if (!isRate(real_time_factor)) {
    throw std::invalid_argument("real_time_factor must be in [0, 1000], got " +
                                std::to_string(real_time_factor));
  }
  if (!(clock_rate_hz > 0.0 && clock_rate_hz <= simulation.physics_rate_hz)) {
    throw std::invalid_argument("clock_rate_hz must be in (0, physics_rate_hz], got " +
                                std::to_string(clock_rate_hz));
  }
  lock_step.validate();
}

SimulatorParameters readSimulatorParameters(ram_parameters::ParameterReader& reader) {
  SimulatorParameters p;
  reader.read("world", p.world);
  reader.read("tour", p.tour);
  reader.read("robot", p.robot);
  reader.read("faults", p.faults);
  reader.read("laser_frame", p.laser_frame);
  reader.read("real_time_factor", p.real_time_factor);
  reader.read("clock_rate_hz", p.clock_rate_hz);
  reader.read("lock_step_topics", p.lock_step.topics);
  reader.read("lock_step_timeout_s", p.lock_step.timeout_s);
  reader.read("lock_step_start_timeout_s", p.lock_step.start_timeout_s);
  p.simulation = ramscout_sim::readSimulationParameters(reader);
  reader.rejectUnknown();
  p.validate();
  return p;
}

SimulatorNode::SimulatorNode(ram_parameters::ParameterReader& reader)
    : parameters_(readSimulatorParameters(reader)),
      robot_(loadRobot(parameters_)),
      world_(parameters_.world.empty() ? ramscout_sim::World()
                                       : ramscout_sim::readWorld(parameters_.world)),
      tour_(parameters_.tour.empty()
                ? std::nullopt
                : std::optional<ramscout_sim::Tour>(ramscout_sim::readTour(parameters_.tour))),
      simulation_(makeSimulation()),
      real_time_factor_(parameters_.real_time_factor),
      lock_step_(node_, parameters_.lock_step) {
  advertise();
  restartPace();
  ROS_INFO_STREAM(
      "Simulating '" << robot_.name << "' among " << world_.solids.size() << " solids; "
                     << (tour_ ? "driving a tour of " + std::to_string(tour_->length_m()) + " m"
                               : "listening to " + command_.getTopic()));
  thread_ = std::thread([this] {
    try {
      run();
    } catch (const std::exception& error) {
      ROS_FATAL_STREAM(error.what());
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

ramscout_sim::Simulation SimulatorNode::makeSimulation() const {
  ramscout_sim::Simulation simulation(parameters_.simulation, robot_, world_, tour_);
  if (!parameters_.faults.empty()) {
    for (const ramscout_sim::Fault& fault : ramscout_sim::readFaults(parameters_.faults))
      simulation.inject(fault);
  }
  return simulation;
}

void SimulatorNode::advertise() {
  constexpr std::uint32_t kQueue = 100;
  clock_ = node_.advertise<rosgraph_msgs::Clock>("/clock", kQueue);
  scan_ = node_.advertise<sensor_msgs::LaserScan>("scan", kQueue);
  odometry_ = node_.advertise<nav_msgs::Odometry>("odom", kQueue);
  joints_ = node_.advertise<sensor_msgs::JointState>("joint_states", kQueue);
  ground_truth_ = node_.advertise<nav_msgs::Odometry>("ground_truth", kQueue);
  if (tour_) {
    progress_ = node_.advertise<std_msgs::Float32>("tour_progress", kQueue, true);
  } else {
    command_ = node_.subscribe("cmd_vel", 10, &SimulatorNode::onCommand, this,
                               ros::TransportHints().tcpNoDelay());
  }
  faults_ = node_.advertise<std_msgs::String>("faults", kQueue);
  services_ = {private_node_.advertiseService("inject_fault", &SimulatorNode::onInjectFault, this),
               private_node_.advertiseService("pause", &SimulatorNode::onPause, this),
               private_node_.advertiseService("reset", &SimulatorNode::onReset, this),
               private_node_.advertiseService("set_pose", &SimulatorNode::onSetPose, this),
               private_node_.advertiseService("set_rate", &SimulatorNode::onSetRate, this),
               private_node_.advertiseService("step", &SimulatorNode::onStep, this)};
}

/// Returns false when the node stops.
bool SimulatorNode::waitUntilRunning() {
  std::unique_lock<FairMutex> lock(mutex_);
  while (!stopping_ && ros::ok() && paused_ && simulation_.now_ns() >= step_until_ns_) {
    wake_.notify_all();
    wake_.wait_for(lock, std::chrono::milliseconds(50));
  }
  return !stopping_ && ros::ok();
}

void SimulatorNode::run() {
  lock_step_.waitForStart(scan_);
  {
    const std::lock_guard<FairMutex> lock(mutex_);
    restartPace();
  }
  while (waitUntilRunning()) {
    ramscout_sim::Outputs outputs;
    {
      const std::lock_guard<FairMutex> lock(mutex_);
      outputs = simulation_.step();
      lock_step_.setNow(toRosTime(simulation_.now_ns()));
      publishClock();
      publishProgress();
    }
    publish(outputs);
    keepPace();
  }
}

void SimulatorNode::publish(const ramscout_sim::Outputs& outputs) {
  if (outputs.odometry) {
    const nav_msgs::Odometry odometry = toMessage(*outputs.odometry, robot_.base_frame);
    tf_.sendTransform(toTransform(odometry));
    odometry_.publish(odometry);
    joints_.publish(toJointState(*outputs.odometry, robot_));
  }
  if (outputs.ground_truth)
    ground_truth_.publish(toMessage(*outputs.ground_truth, robot_.base_frame));
  for (const ramscout_sim::Fault& fault : outputs.started_faults) {
    std_msgs::String message;
    message.data = ramscout_sim::toString(fault.kind);
    faults_.publish(message);
    ROS_INFO_STREAM("Fault: " << message.data);
  }
  if (outputs.scan) {
    const sensor_msgs::LaserScan scan =
        toMessage(*outputs.scan, parameters_.simulation.lidar, robot_.laser_frame);
    scan_.publish(scan);
    lock_step_.waitFor(scan.header.stamp);
  }
}

void SimulatorNode::publishClock() {
  if (simulation_.now_ns() < next_clock_ns_) return;
  rosgraph_msgs::Clock message;
  message.clock = toRosTime(simulation_.now_ns());
  clock_.publish(message);
  next_clock_ns_ = simulation_.now_ns() + std::llround(1e9 / parameters_.clock_rate_hz);
}

void SimulatorNode::publishProgress() {
  if (!tour_) return;
  const double progress = simulation_.tourProgress();
  if (progress < published_progress_ + kProgressStep &&
      !(progress == 1.0 && published_progress_ < 1.0))
    return;
  std_msgs::Float32 message;
  message.data = static_cast<float>(progress);
  progress_.publish(message);
  if (progress == 1.0) ROS_INFO("The tour is finished");
  published_progress_ = progress;
}

void SimulatorNode::restartPace() {
  pace_wall_start_ = ros::SteadyTime::now();
  pace_start_ns_ = simulation_.now_ns();
}

/// Sleeps while the simulation is ahead of the wanted rate; a simulation that was late does not
/// hurry afterwards.
void SimulatorNode::keepPace() {
  constexpr double kLate_s = 0.1;
  double ahead_s = 0.0;
  {
    const std::lock_guard<FairMutex> lock(mutex_);
    if (real_time_factor_ == 0.0) return;
    const double simulated_s = static_cast<double>(simulation_.now_ns() - pace_start_ns_) * 1e-9;
    ahead_s = simulated_s / real_time_factor_ - (ros::SteadyTime::now() - pace_wall_start_).toSec();
    if (ahead_s < -kLate_s) restartPace();
  }
  if (ahead_s > 1e-3)
    std::this_thread::sleep_for(std::chrono::duration<double>(std::min(ahead_s, 0.1)));
}

void SimulatorNode::onCommand(const geometry_msgs::Twist& message) {
  if (message.linear.y != 0.0 || message.linear.z != 0.0 || message.angular.x != 0.0 ||
      message.angular.y != 0.0) {
    ROS_WARN_ONCE(
        "cmd_vel asks for a motion that two wheels cannot do; only linear.x and angular.z count");
  }
  try {
    const std::lock_guard<FairMutex> lock(mutex_);
    simulation_.command({message.linear.x, 0.0, message.angular.z});
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(1.0, "cmd_vel: " << error.what());
  }
}

bool SimulatorNode::onInjectFault(ramscout_sim::InjectFault::Request& request,
                                  ramscout_sim::InjectFault::Response& response) {
  try {
    ramscout_sim::Fault fault;
    fault.kind = ramscout_sim::parseFaultKind(request.kind);
    fault.duration_s = request.duration;
    fault.amount = request.amount;
    fault.angle_min_rad = request.angle_min;
    fault.angle_max_rad = request.angle_max;
    const std::lock_guard<FairMutex> lock(mutex_);
    simulation_.inject(fault);
    response.success = true;
  } catch (const std::exception& error) {
    response.message = error.what();
  }
  return true;
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
  simulation_ = makeSimulation();
  lock_step_.reset();
  next_clock_ns_ = 0;
  published_progress_ = -1.0;
  step_until_ns_ = 0;
  restartPace();
  return true;
}

bool SimulatorNode::onSetPose(ramscout_sim::SetPose::Request& request,
                              ramscout_sim::SetPose::Response& response) {
  try {
    const std::lock_guard<FairMutex> lock(mutex_);
    simulation_.setPose({request.pose.x, request.pose.y, request.pose.theta});
    response.success = true;
  } catch (const std::exception& error) {
    response.message = error.what();
  }
  return true;
}

bool SimulatorNode::onSetRate(ramscout_sim::SetRate::Request& request,
                              ramscout_sim::SetRate::Response& response) {
  response.success = isRate(request.real_time_factor);
  if (!response.success) {
    response.message =
        "real_time_factor must be in [0, 1000], got " + std::to_string(request.real_time_factor);
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
  response.now = toRosTime(simulation_.now_ns());
  if (!(request.duration > 0.0 && request.duration <= kMaxStep_s)) {
    response.message = "duration must be in (0, 3600] s, got " + std::to_string(request.duration);
    return true;
  }
  if (!paused_) {
    response.message = "the simulation is not paused";
    return true;
  }
  step_until_ns_ = simulation_.now_ns() + std::llround(request.duration * 1e9);
  restartPace();
  wake_.notify_all();
  while (!stopping_ && ros::ok() && paused_ && simulation_.now_ns() < step_until_ns_) {
    wake_.wait_for(lock, std::chrono::milliseconds(5));
  }
  response.now = toRosTime(simulation_.now_ns());
  response.success = step_until_ns_ > 0 && simulation_.now_ns() >= step_until_ns_;
  if (!response.success) response.message = "interrupted";
  return true;
}

}  // namespace ramscout_sim_ros
