// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/ros/parameter_server.hpp"

#include <stdexcept>
#include <string>

#include <ros/ros.h>

namespace ram_parameters_ros {
namespace {

YAML::Node toYaml(XmlRpc::XmlRpcValue& value) {
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return YAML::Node(static_cast<bool>(value));
    case XmlRpc::XmlRpcValue::TypeInt:
      return YAML::Node(static_cast<int>(value));
    case XmlRpc::XmlRpcValue::TypeDouble:
      return YAML::Node(static_cast<double>(value));
    case XmlRpc::XmlRpcValue::TypeString: {
      YAML::Node node(static_cast<std::string>(value));
      node.SetTag("!");  // as a quoted scalar: never a number
      return node;
    }
    case XmlRpc::XmlRpcValue::TypeArray: {
      YAML::Node node(YAML::NodeType::Sequence);
      for (int i = 0; i < value.size(); ++i) node.push_back(toYaml(value[i]));
      return node;
    }
    case XmlRpc::XmlRpcValue::TypeStruct: {
      YAML::Node node(YAML::NodeType::Map);
      for (auto& [key, element] : value) node[key] = toYaml(element);
      return node;
    }
    default:
      throw std::invalid_argument("a parameter has a type that is not supported");
  }
}

}  // namespace

ram_parameters::ParameterReader privateParameters() {
  const std::string name = ros::this_node::getName();
  XmlRpc::XmlRpcValue values;
  if (!ros::NodeHandle("~").getParam("", values)) {
    ROS_WARN_STREAM("no parameters in " << name << ": all are at their defaults");
    return ram_parameters::ParameterReader(YAML::Node(), name);
  }
  return ram_parameters::ParameterReader(toYaml(values), name);
}

}  // namespace ram_parameters_ros
