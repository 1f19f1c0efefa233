// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/ros/graph_reporter.hpp"

#include <algorithm>
#include <chrono>
#include <string>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/master.h>

namespace ram_parameters_ros {
namespace {

constexpr double kPeriodS = 1.0;
constexpr double kLogPeriodS = 30.0;
constexpr int kChecksPerPeriod = 20;  // whether to stop

bool isPublished(const std::string& topic) {
  ros::master::V_TopicInfo topics;
  if (!ros::master::check() || !ros::master::getTopics(topics)) return false;
  return std::any_of(topics.begin(), topics.end(),
                     [&](const ros::master::TopicInfo& other) { return other.name == topic; });
}

ram_parameters::GraphSight look() {
  ram_parameters::GraphSight sight;
  XmlRpc::XmlRpcValue request;
  request[0] = request[1] = ros::this_node::getName();
  XmlRpc::XmlRpcValue response;
  XmlRpc::XmlRpcValue payload;
  sight.is_registered = ros::master::execute("lookupNode", request, response, payload, false);
  sight.master_answers = sight.is_registered || ros::master::check();
  sight.waits_for_clock = ros::Time::isSimTime() && ros::Time::now().isZero();
  if (sight.waits_for_clock) sight.has_clock_source = isPublished("/clock");
  return sight;
}

}  // namespace

GraphReporter::GraphReporter() {
  publisher_ = node_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1);
  thread_ = std::thread([this] { run(); });
}

GraphReporter::~GraphReporter() {
  stop_ = true;
  thread_.join();
}

void GraphReporter::run() {
  while (true) {
    for (int i = 0; i < kChecksPerPeriod; ++i) {
      std::this_thread::sleep_for(std::chrono::duration<double>(kPeriodS / kChecksPerPeriod));
      if (stop_ || !ros::ok()) return;
    }
    watch_.see(look(), kPeriodS);
    if (ros::ok()) report();
  }
}

void GraphReporter::report() {
  const std::string& problem = watch_.problem();
  if (watch_.mustEnd()) {
    ROS_FATAL_STREAM(problem);
    has_ended_ = true;
    ros::requestShutdown();
  } else if (!problem.empty()) {
    if (watch_.isLasting()) ROS_ERROR_STREAM_THROTTLE(kLogPeriodS, problem);
    publish(true, problem);
  } else if (was_wrong_) {
    ROS_INFO("Master and clock are there again");
    publish(false, "master and clock are there");
  }
  was_wrong_ = !problem.empty();
}

void GraphReporter::publish(bool is_error, const std::string& text) {
  diagnostic_msgs::DiagnosticArray message;
  message.header.stamp = ros::Time::now();
  message.status.resize(1);
  message.status[0].name = ros::this_node::getName() + ": graph";
  message.status[0].hardware_id = "none";
  message.status[0].level =
      is_error ? diagnostic_msgs::DiagnosticStatus::ERROR : diagnostic_msgs::DiagnosticStatus::OK;
  message.status[0].message = text;
  message.status[0].values.resize(is_error ? 2 : 1);
  message.status[0].values[0].key = "link";
  message.status[0].values[0].value = "clock";
  if (is_error) {
    message.status[0].values[1].key = "cause: clock: graph";
    message.status[0].values[1].value = text;
  }
  publisher_.publish(message);
}

}  // namespace ram_parameters_ros
