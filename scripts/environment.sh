# Sourced by the other scripts: a known environment, whatever the caller's shell has set up.
workspace=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$workspace" || exit 1
# Debian's python3 must come first: ROS lives in its packages.
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
unset CMAKE_PREFIX_PATH ROS_PACKAGE_PATH PYTHONPATH LD_LIBRARY_PATH PKG_CONFIG_PATH ROS_MASTER_URI ROS_IP
export ROS_HOSTNAME=localhost
export ROS_HOME=$workspace/build/ros_home ROS_LOG_DIR=$workspace/build/ros_log
