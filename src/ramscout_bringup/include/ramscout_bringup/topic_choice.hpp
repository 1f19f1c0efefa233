// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace ramscout_bringup {

/// A topic of a recording.
struct RecordedTopic {
  std::string name;
  std::string type;  ///< as ROS 1 writes it: `sensor_msgs/LaserScan`
  std::size_t message_count = 0;
};

/// A name without its leading slash, if it has one.
std::string withoutSlash(const std::string& name);

/// Whether two topic names are the same but for a leading slash.
bool isSameTopic(const std::string& a, const std::string& b);

/// The topic to read scans from (sensor_msgs/LaserScan or MultiEchoLaserScan): the wished one, else
/// `scan`, else the only one whose last part is `scan`, else the only one.
/// \param wish  empty: none \throws std::runtime_error listing the candidates if the wished one is
/// not there or of another type, or if the choice is not clear
std::string chooseScanTopic(const std::vector<RecordedTopic>& topics, const std::string& wish);

/// The topic to read odometry from (nav_msgs/Odometry), by the same rule with `odom`; ground truth
/// counts only if it is wished for.
/// \param tf_has_odometry  an unclear choice then is tf
/// \return empty: none, or tf \throws std::runtime_error as chooseScanTopic()
std::string chooseOdometryTopic(const std::vector<RecordedTopic>& topics,
                                const std::string& wish,
                                bool tf_has_odometry);

/// Topics of the types of scans and odometry that were not chosen, as `name (type)` separated by
/// commas; empty if there is none.
std::string otherTopics(const std::vector<RecordedTopic>& topics,
                        const std::string& scan,
                        const std::string& odometry);

}  // namespace ramscout_bringup
