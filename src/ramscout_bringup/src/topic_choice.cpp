// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/topic_choice.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

namespace ramscout_bringup {
namespace {

const std::set<std::string> kScanTypes{"sensor_msgs/LaserScan", "sensor_msgs/MultiEchoLaserScan"};
const std::set<std::string> kOdometryTypes{"nav_msgs/Odometry"};

std::string lastPart(const std::string& name) {
  return name.substr(name.rfind('/') + 1);
}

std::string listed(const std::vector<RecordedTopic>& topics) {
  std::string list;
  for (const RecordedTopic& topic : topics)
    list += (list.empty() ? "" : ", ") + topic.name + " (" + topic.type + ")";
  return list.empty() ? "none" : list;
}

std::vector<RecordedTopic> ofTypes(const std::vector<RecordedTopic>& topics,
                                   const std::set<std::string>& types) {
  std::vector<RecordedTopic> found;
  std::copy_if(topics.begin(), topics.end(), std::back_inserter(found),
               [&](const RecordedTopic& topic) { return types.count(topic.type) > 0; });
  return found;
}

/// \return the topic that was wished for \throws std::runtime_error if it is not of these types
std::string wished(const std::vector<RecordedTopic>& topics,
                   const std::set<std::string>& types,
                   const std::string& wish) {
  const auto found = std::find_if(topics.begin(), topics.end(), [&](const RecordedTopic& topic) {
    return isSameTopic(topic.name, wish);
  });
  const std::string candidates =
      "; topics of type " + *types.begin() + ": " + listed(ofTypes(topics, types));
  if (found == topics.end())
    throw std::runtime_error("the recording has no topic " + wish + candidates);
  if (types.count(found->type) == 0)
    throw std::runtime_error(wish + " carries " + found->type + candidates);
  return found->name;
}

/// The one that is called `name`, else the only one whose last part is `name`, else the only one.
std::string preferred(const std::vector<RecordedTopic>& candidates, const std::string& name) {
  std::vector<std::string> with_last_part;
  for (const RecordedTopic& topic : candidates) {
    if (withoutSlash(topic.name) == name) return topic.name;
    if (lastPart(topic.name) == name) with_last_part.push_back(topic.name);
  }
  if (with_last_part.size() == 1) return with_last_part.front();
  return candidates.size() == 1 ? candidates.front().name : "";
}

}  // namespace

std::string withoutSlash(const std::string& name) {
  return !name.empty() && name.front() == '/' ? name.substr(1) : name;
}

bool isSameTopic(const std::string& a, const std::string& b) {
  return withoutSlash(a) == withoutSlash(b);
}

std::string chooseScanTopic(const std::vector<RecordedTopic>& topics, const std::string& wish) {
  if (!wish.empty()) return wished(topics, kScanTypes, wish);
  const std::vector<RecordedTopic> candidates = ofTypes(topics, kScanTypes);
  if (candidates.empty()) {
    throw std::runtime_error("the recording has no scans (sensor_msgs/LaserScan); its topics: " +
                             listed(topics));
  }
  const std::string scan = preferred(candidates, "scan");
  if (scan.empty()) {
    throw std::runtime_error("the recording has several topics of scans: " + listed(candidates) +
                             "; name one with --scan-topic");
  }
  return scan;
}

std::string chooseOdometryTopic(const std::vector<RecordedTopic>& topics,
                                const std::string& wish,
                                bool tf_has_odometry) {
  if (!wish.empty()) return wished(topics, kOdometryTypes, wish);
  std::vector<RecordedTopic> candidates = ofTypes(topics, kOdometryTypes);
  const auto is_truth = [](const RecordedTopic& topic) {
    return topic.name.find("ground_truth") != std::string::npos;
  };
  candidates.erase(std::remove_if(candidates.begin(), candidates.end(), is_truth),
                   candidates.end());
  const std::string odometry = preferred(candidates, "odom");
  if (odometry.empty() && !candidates.empty() && !tf_has_odometry) {
    throw std::runtime_error("the recording has several topics of odometry: " + listed(candidates) +
                             "; name one with --odom-topic");
  }
  return odometry;
}

std::string otherTopics(const std::vector<RecordedTopic>& topics,
                        const std::string& scan,
                        const std::string& odometry) {
  std::vector<RecordedTopic> others;
  for (const RecordedTopic& topic : topics) {
    const bool is_candidate = kScanTypes.count(topic.type) + kOdometryTypes.count(topic.type) > 0;
    if (is_candidate && topic.name != scan && topic.name != odometry) others.push_back(topic);
  }
  return others.empty() ? "" : listed(others);
}

}  // namespace ramscout_bringup
