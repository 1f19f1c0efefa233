// SPDX-License-Identifier: BSD-3-Clause
// Sends all static transforms again every second, so that a recorded bag knows them from any second
// on.
#include <map>
#include <string>

#include <ram_parameters/ros/run_node.hpp>
#include <tf2_msgs/TFMessage.h>

namespace {

class StaticTransformRepeater {
public:
  explicit StaticTransformRepeater(ram_parameters::ParameterReader& reader) {
    double period_s = 1.0;
    reader.read("period_s", period_s);
    reader.rejectUnknown();
    if (!(period_s > 0.0))
      throw std::invalid_argument("period_s must be > 0, got " + std::to_string(period_s));
    publisher_ = node_.advertise<tf2_msgs::TFMessage>("/tf_static", 10, true);
    subscriber_ = node_.subscribe("/tf_static", 100, &StaticTransformRepeater::onTransforms, this);
    timer_ = node_.createTimer(ros::Duration(period_s), &StaticTransformRepeater::onTimer, this);
  }

private:
  void onTransforms(const tf2_msgs::TFMessage& message) {
    for (const auto& transform : message.transforms)
      transforms_[transform.child_frame_id] = transform;
  }

  void onTimer(const ros::TimerEvent& /*event*/) {
    if (transforms_.empty()) return;
    tf2_msgs::TFMessage message;
    for (const auto& [child, transform] : transforms_) message.transforms.push_back(transform);
    publisher_.publish(message);
  }

  ros::NodeHandle node_;
  std::map<std::string, geometry_msgs::TransformStamped> transforms_;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
  ros::Timer timer_;
};

}  // namespace

int main(int argc, char** argv) {
  return ram_parameters_ros::runNode<StaticTransformRepeater>(
      argc, argv, "repeat_static_transforms", "sends all static transforms again every period_s");
}
