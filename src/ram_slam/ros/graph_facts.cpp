// SPDX-License-Identifier: BSD-3-Clause
#include "graph_facts.hpp"

#include <algorithm>
#include <cerrno>
#include <map>
#include <memory>
#include <string>

#include <netdb.h>
#include <poll.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <ros/time.h>
#include <sys/socket.h>
#include <unistd.h>

namespace ram_slam_ros {
namespace {

constexpr int kConnectMs = 200;  // a node of another computer answers in milliseconds

using PublishersByTopic = std::map<std::string, std::vector<std::string>>;

PublishersByTopic publishersByTopic() {
  XmlRpc::XmlRpcValue request;
  XmlRpc::XmlRpcValue response;
  XmlRpc::XmlRpcValue state;
  request[0] = ros::this_node::getName();
  PublishersByTopic result;
  if (!ros::master::execute("getSystemState", request, response, state, false)) return result;
  XmlRpc::XmlRpcValue& topics = state[0];
  for (int i = 0; i < topics.size(); ++i) {
    std::vector<std::string>& publishers = result[static_cast<std::string&>(topics[i][0])];
    for (int j = 0; j < topics[i][1].size(); ++j)
      publishers.push_back(static_cast<std::string&>(topics[i][1][j]));
  }
  return result;
}

/// Whether the process of a node is there: one that is stopped accepts connections, too.
bool acceptsConnections(const std::string& node) {
  XmlRpc::XmlRpcValue request;
  XmlRpc::XmlRpcValue response;
  XmlRpc::XmlRpcValue uri;
  request[0] = ros::this_node::getName();
  request[1] = node;
  std::string host;
  std::uint32_t port = 0;
  if (!ros::master::execute("lookupNode", request, response, uri, false) ||
      !ros::network::splitURI(static_cast<std::string&>(uri), host, port))
    return true;  // not known
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) return false;
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> address(found, &freeaddrinfo);
  const int socket = ::socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK, 0);
  if (socket < 0) return true;
  pollfd connection{socket, POLLOUT, 0};
  int error = 0;
  if (connect(socket, found->ai_addr, found->ai_addrlen) != 0) {
    socklen_t size = sizeof(error);
    if (errno != EINPROGRESS) {
      error = errno;
    } else if (poll(&connection, 1, kConnectMs) == 1) {
      getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size);
    }
  }
  close(socket);
  return error == 0;
}

bool isOwn(const std::vector<std::string>& publishers) {
  const std::string& own = ros::this_node::getName();
  return std::find(publishers.begin(), publishers.end(), own) != publishers.end();
}

std::vector<std::string> framesAbove(const tf2_ros::Buffer& buffer, std::string frame) {
  constexpr std::size_t kDeepest = 20;  // a loop in tf must not end here
  std::vector<std::string> above;
  std::string parent;
  while (above.size() < kDeepest && buffer._getParent(frame, ros::Time(0), parent)) {
    above.push_back(parent);
    frame = parent;
  }
  return above;
}

std::vector<std::string> framesBelow(const tf2_ros::Buffer& buffer, const std::string& parent) {
  std::vector<std::string> frames;
  buffer._getFrameStrings(frames);
  const auto isBelow = [&](const std::string& frame) {
    std::string its;
    return buffer._getParent(frame, ros::Time(0), its) && its == parent;
  };
  frames.erase(std::remove_if(frames.begin(), frames.end(),
                              [&](const std::string& frame) { return !isBelow(frame); }),
               frames.end());
  return frames;
}

}  // namespace

void lookAtMaster(std::vector<ram_slam::InputFacts>& inputs) {
  const PublishersByTopic publishers = publishersByTopic();
  ros::master::V_TopicInfo topics;
  if (publishers.empty() || !ros::master::getTopics(topics)) return;
  for (ram_slam::InputFacts& input : inputs) {
    input.publishers.clear();
    input.dead.clear();
    input.elsewhere.clear();
    const auto own = publishers.find(input.topic);
    if (own != publishers.end()) input.publishers = own->second;
    for (const std::string& publisher : input.publishers) {
      if (!acceptsConnections(publisher)) input.dead.push_back(publisher);
    }
    for (const ros::master::TopicInfo& topic : topics) {
      const auto others = publishers.find(topic.name);
      if (topic.name == input.topic) {
        input.published_type = topic.datatype;
      } else if (topic.datatype == input.type && others != publishers.end() &&
                 !isOwn(others->second)) {
        input.elsewhere.push_back(topic.name + " of " + others->second.front());
      }
    }
  }
}

void lookAtTf(const tf2_ros::Buffer& buffer, ram_slam::TransformFacts& transform) {
  try {
    const ros::Time stamp =
        buffer.lookupTransform(transform.parent, transform.child, ros::Time(0)).header.stamp;
    if (!stamp.isZero()) transform.stamp_age_s = (ros::Time::now() - stamp).toSec();
  } catch (const tf2::TransformException&) {
    transform.missing_s = 1.0;
    transform.above = framesAbove(buffer, transform.child);
    transform.below = framesBelow(buffer, transform.parent);
    transform.parent_exists = buffer._frameExists(transform.parent);
  }
}

}  // namespace ram_slam_ros
