#!/usr/bin/env bash
# Checks that need no build: the boundary between cores and ROS, the independence of the simulator, catkin's manifests.
set -eo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
fail() { echo "check_source: $1" >&2; exit 1; }

ros_includes=$(grep -rnE '#include [<"](ros/|rosbag/|tf2|pluginlib/|[a-z_]+_msgs/|std_srvs/)' \
  src/*/include src/*/src --include='*.hpp' --include='*.cpp' || true)
[[ -z $ros_includes ]] || fail "a core includes ROS:
$ros_includes"

slam_in_simulator=$(grep -rnE '(ram_slam|ramscout_kinematics|ramscout_feature_detector)(/|::|</)' \
  src/ramscout_sim --include='*.hpp' --include='*.cpp' --include='CMakeLists.txt' --include='package.xml' || true)
[[ -z $slam_in_simulator ]] || fail "the simulator uses SLAM code:
$slam_in_simulator"

PATH=/usr/bin:$PATH catkin_lint --offline -W2 --strict src 2>/dev/null || fail "catkin_lint found something (above)"
