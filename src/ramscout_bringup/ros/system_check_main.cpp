// SPDX-License-Identifier: BSD-3-Clause
// Walks the way from the clock to the map on the running graph: what each node reports about itself
// on /diagnostics, and which nodes the master knows that report nothing.
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <map>
#include <set>
#include <string>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include "ramscout_bringup/chain_check.hpp"

namespace {

using ram_slam::Link;

constexpr double kListen_s = 2.5;  // each node reports once per second

std::map<std::string, ramscout_bringup::NodeReport> listen(const std::string& robot) {
  std::map<std::string, ramscout_bringup::NodeReport> reports;
  ros::NodeHandle node;
  const boost::function<void(const diagnostic_msgs::DiagnosticArray&)> callback =
      [&](const diagnostic_msgs::DiagnosticArray& message) {
        for (const diagnostic_msgs::DiagnosticStatus& status : message.status) {
          std::vector<std::pair<std::string, std::string>> values;
          for (const diagnostic_msgs::KeyValue& value : status.values)
            values.emplace_back(value.key, value.value);
          ramscout_bringup::NodeReport report;
          if (status.name.compare(0, robot.size(), robot) == 0 &&
              toNodeReport(status.name, status.level, status.message, values, report))
            reports[status.name] = report;
        }
      };
  const ros::Subscriber subscriber =
      node.subscribe<diagnostic_msgs::DiagnosticArray>("/diagnostics", 100, callback);
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kListen_s);
  while (ros::ok() && ros::WallTime::now() < end)
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  return reports;
}

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// The links of the nodes that the master knows, by what they publish and offer.
std::map<std::string, Link> knownNodes() {
  XmlRpc::XmlRpcValue request;
  XmlRpc::XmlRpcValue response;
  XmlRpc::XmlRpcValue state;
  request[0] = ros::this_node::getName();
  std::map<std::string, Link> nodes;
  ros::master::V_TopicInfo topics;
  if (!ros::master::execute("getSystemState", request, response, state, false) ||
      !ros::master::getTopics(topics))
    return nodes;
  std::map<std::string, std::string> types;
  for (const ros::master::TopicInfo& topic : topics) types[topic.name] = topic.datatype;
  const auto add = [&](XmlRpc::XmlRpcValue& row, Link link) {
    for (int i = 0; i < row[1].size(); ++i) nodes[static_cast<std::string&>(row[1][i])] = link;
  };
  for (int i = 0; i < state[0].size(); ++i) {
    const std::string& topic = state[0][i][0];
    if (endsWith(topic, "laser_odom")) add(state[0][i], Link::kOdometry);
    if (types[topic] == "ram_slam_msgs/FeatureList") add(state[0][i], Link::kFeatures);
    if (types[topic] == "ram_slam_msgs/Tracking") add(state[0][i], Link::kPose);
  }
  for (int i = 0; i < state[2].size(); ++i) {
    const std::string& service = state[2][i][0];
    if (endsWith(service, "/predict_with_covariance")) add(state[2][i], Link::kKinematics);
    if (endsWith(service, "/get_drawn_map")) add(state[2][i], Link::kMap);
  }
  return nodes;
}

int check() {
  if (!ros::master::check()) {
    std::cout << "BROKEN  no ROS master answers at " << ros::master::getURI()
              << "; start roscore, or set ROS_MASTER_URI" << std::endl;
    return EXIT_FAILURE;
  }
  ros::start();
  const std::string space = ros::this_node::getNamespace();
  const std::string robot = space == "/" ? space : space + "/";
  std::vector<ramscout_bringup::NodeReport> reports;
  std::set<std::string> speaking;
  for (const auto& [name, report] : listen(robot)) {
    reports.push_back(report);
    speaking.insert(report.node);
  }
  std::vector<ramscout_bringup::SilentNode> silent;
  for (const auto& [node, link] : knownNodes()) {
    if (speaking.count(node) == 0 && node.compare(0, robot.size(), robot) == 0)
      silent.push_back({node, link});
  }
  const ramscout_bringup::LinkState* broken = nullptr;
  const auto states = checkChain(reports, silent);
  for (const ramscout_bringup::LinkState& state : states) {
    std::cout << (state.is_ok ? "ok      " : "BROKEN  ") << std::left << std::setw(12)
              << toText(state.link) << state.text << "\n";
    if (!state.is_ok && broken == nullptr) broken = &state;
  }
  if (broken == nullptr) {
    std::cout << "Scans become a map." << std::endl;
    return EXIT_SUCCESS;
  }
  std::cout << "The first broken link is " << toText(broken->link) << ": " << broken->text
            << std::endl;
  return EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "system_check", ros::init_options::AnonymousName);  // takes remappings out
  if (argc > 1) {
    std::cout << "system_check: names the first broken link between the sensors and the map of the "
                 "running nodes, and what to do. Of one of several robots: __ns:=NAMESPACE. Exit "
                 "code 1 if a link is broken.\n";
    return std::string(argv[1]) == "--help" ? EXIT_SUCCESS : EXIT_FAILURE;
  }
  return check();
}
