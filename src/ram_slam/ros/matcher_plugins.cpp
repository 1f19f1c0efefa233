// SPDX-License-Identifier: BSD-3-Clause
#include "matcher_plugins.hpp"

#include <string>

#include <ros/console.h>

namespace ram_slam_ros {

MatcherPlugins::MatcherPlugins() : loader_("ram_slam", "ram_slam::FeatureMatcher") {
  for (const std::string& type : loader_.getDeclaredClasses()) {
    try {
      matchers_[type] = loader_.createSharedInstance(type);
      ROS_INFO_STREAM("Features of type '" << type << "' are compared by "
                                           << loader_.getClassType(type));
    } catch (const pluginlib::PluginlibException& error) {
      ROS_ERROR_STREAM("Features of type '" << type
                                            << "' are matched by geometry alone: " << error.what());
    }
  }
}

}  // namespace ram_slam_ros
