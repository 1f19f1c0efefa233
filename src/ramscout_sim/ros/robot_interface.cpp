// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/ros/robot_interface.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <nav_msgs/Odometry.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/LaserScan.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float32.h>
#include <std_msgs/String.h>

#include "ramscout_sim/ros/conversions.hpp"

namespace ramscout_sim_ros {
namespace {

std::string inNamespace(const std::string& name, const std::string& top) {
  return name.empty() ? top : top.empty() ? name : top + "/" + name;
}

}  // namespace

RobotInterface::RobotInterface(const std::string& name,
                               const ramscout_sim::FleetMember& member,
                               const ramscout_sim::TopicParameters& topics,
                               Access access)
    : prefix_(name.empty() ? "" : name + "/"),
      robot_(member.robot),
      parameters_(member.parameters),
      topics_(topics),
      has_tour_(member.tour.has_value()),
      access_(std::move(access)),
      node_(name),
      private_node_(inNamespace(name, "~")) {
  const auto queue = static_cast<std::uint32_t>(topics.queue_length);
  scan_ = node_.advertise<sensor_msgs::LaserScan>("scan", queue);
  odometry_ = node_.advertise<nav_msgs::Odometry>("odom", queue);
  joints_ = node_.advertise<sensor_msgs::JointState>("joint_states", queue);
  ground_truth_ = node_.advertise<nav_msgs::Odometry>("ground_truth", queue);
  faults_ = node_.advertise<std_msgs::String>("faults", queue);
  collision_ = node_.advertise<std_msgs::Bool>("collision", queue, true);
  if (has_tour_) {
    progress_ = node_.advertise<std_msgs::Float32>("tour_progress", queue, true);
  } else {
    command_ = node_.subscribe("cmd_vel", 10, &RobotInterface::onCommand, this,
                               ros::TransportHints().tcpNoDelay());
  }
  services_ = {private_node_.advertiseService("inject_fault", &RobotInterface::onInjectFault, this),
               private_node_.advertiseService("set_pose", &RobotInterface::onSetPose, this)};
}

void RobotInterface::publish(const ramscout_sim::Outputs& outputs,
                             tf2_ros::TransformBroadcaster& tf) {
  if (outputs.odometry) {
    nav_msgs::Odometry odometry = toMessage(*outputs.odometry, prefix_ + robot_.base_frame);
    odometry.header.frame_id = prefix_ + odometry.header.frame_id;
    tf.sendTransform(toTransform(odometry));
    odometry_.publish(odometry);
    joints_.publish(toJointState(*outputs.odometry, robot_));
  }
  if (outputs.ground_truth)
    ground_truth_.publish(toMessage(*outputs.ground_truth, prefix_ + robot_.base_frame));
  for (const ramscout_sim::Fault& fault : outputs.started_faults) {
    std_msgs::String message;
    message.data = ramscout_sim::toYaml(fault);
    faults_.publish(message);
    ROS_INFO_STREAM("Fault: " << message.data);
  }
  for (const ramscout_sim::RefusedFault& refused : outputs.refused_faults) {
    ROS_WARN_STREAM("Fault " << ramscout_sim::toYaml(refused.fault)
                             << " was not injected, impossible: " << refused.reason);
  }
  if (outputs.scan)
    scan_.publish(toMessage(*outputs.scan, parameters_.lidar, prefix_ + robot_.laser_frame));
}

void RobotInterface::publishState(const ramscout_sim::Simulation& simulation) {
  const int collision = simulation.inCollision() ? 1 : 0;
  if (collision != published_collision_) {
    std_msgs::Bool message;
    message.data = collision == 1;
    collision_.publish(message);
    published_collision_ = collision;
  }
  if (!has_tour_) return;
  const double progress = simulation.tourProgress();
  if (progress < published_progress_ + topics_.progress_step &&
      !(progress == 1.0 && published_progress_ < 1.0))
    return;
  std_msgs::Float32 message;
  message.data = static_cast<float>(progress);
  progress_.publish(message);
  if (progress == 1.0) ROS_INFO("The tour is finished");
  published_progress_ = progress;
}

void RobotInterface::forgetState() {
  published_progress_ = -1.0;
  published_collision_ = -1;
}

void RobotInterface::onCommand(const ros::MessageEvent<geometry_msgs::Twist const>& event) {
  const geometry_msgs::Twist& message = *event.getMessage();
  warnOfOtherCommander(event.getPublisherName());
  try {
    access_([&message](ramscout_sim::Simulation& simulation) {
      simulation.command({message.linear.x, message.linear.y, message.angular.z});
    });
    warnOfImpossible(message);
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(1.0, command_.getTopic() << ": " << error.what());
  }
}

/// The last command wins, whichever node published it.
void RobotInterface::warnOfOtherCommander(const std::string& commander) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (!commander_.empty() && commander != commander_ &&
      (now - commanded_at_).toSec() < topics_.rival_command_s) {
    ROS_WARN_STREAM_THROTTLE(5.0, command_.getTopic() << ": both " << commander_ << " and "
                                                      << commander << " command; the last wins");
  }
  commander_ = commander;
  commanded_at_ = now;
}

void RobotInterface::warnOfImpossible(const geometry_msgs::Twist& message) const {
  const bool omni = std::any_of(robot_.wheels.begin(), robot_.wheels.end(),
                                [](const ramscout_sim::Wheel& wheel) { return wheel.omni; });
  if ((message.linear.y != 0.0 && !omni) || message.linear.z != 0.0 || message.angular.x != 0.0 ||
      message.angular.y != 0.0) {
    ROS_WARN_STREAM_ONCE(command_.getTopic()
                         << " asks for a motion that these wheels cannot do; linear.x and "
                            "angular.z count, and linear.y with omni wheels");
  }
  const ramscout_sim::DriveParameters& limits = parameters_.drive;
  if (std::hypot(message.linear.x, omni ? message.linear.y : 0.0) > limits.max_speed_mps ||
      std::abs(message.angular.z) > limits.max_turn_speed_radps) {
    ROS_WARN_STREAM_THROTTLE(5.0, command_.getTopic()
                                      << ": " << message.linear.x << " m/s, " << message.angular.z
                                      << " rad/s are clamped to " << limits.max_speed_mps
                                      << " m/s, " << limits.max_turn_speed_radps << " rad/s");
  }
}

bool RobotInterface::onInjectFault(ramscout_sim::InjectFault::Request& request,
                                   ramscout_sim::InjectFault::Response& response) {
  try {
    ramscout_sim::Fault fault;
    fault.kind = ramscout_sim::parseFaultKind(request.kind);
    fault.duration_s = request.duration;
    fault.amount = request.amount;
    fault.angle_min_rad = request.angle_min;
    fault.angle_max_rad = request.angle_max;
    fault.pose = {request.pose.x, request.pose.y, request.pose.theta};
    fault.target = request.target;
    access_([&fault](ramscout_sim::Simulation& simulation) { simulation.inject(fault); });
    response.success = true;
  } catch (const std::exception& error) {
    response.message = error.what();
  }
  return true;
}

bool RobotInterface::onSetPose(ramscout_sim::SetPose::Request& request,
                               ramscout_sim::SetPose::Response& response) {
  ramscout_sim::InjectFault::Request kidnap;
  ramscout_sim::InjectFault::Response answer;
  kidnap.kind = "kidnap";
  kidnap.pose = request.pose;
  onInjectFault(kidnap, answer);
  response.success = answer.success;
  response.message = answer.message;
  return true;
}

}  // namespace ramscout_sim_ros
