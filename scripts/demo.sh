#!/usr/bin/env bash
# Drives a simulated robot through an office with the whole ROS stack running, and leaves map, trajectory, picture, bag
# and summary in results/demo. SEED=n chooses the noise, RVIZ=1 shows it live, OUTPUT=folder puts the results elsewhere.
set -eo pipefail
scripts=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
"$scripts/build.sh"
source "$scripts/environment.sh"
source devel/setup.bash

output=${OUTPUT:-results/demo}
mkdir -p "$output"
output=$(cd "$output" && pwd)
rm -f "$output"/{map.pgm,map.yaml,map.png,*.tum,landmarks.yaml,summary.json,report.html,run.bag,run.bag.active}

port=$(/usr/bin/python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
export ROS_MASTER_URI=http://localhost:$port
mkdir -p "$ROS_LOG_DIR"
rviz=false
if [[ ${RVIZ:-0} == 1 ]]; then rviz=true; fi

roslaunch -p "$port" ramscout_bringup demo.launch seed:="${SEED:-1}" rviz:=$rviz bag:="$output/run.bag" \
  >"$ROS_LOG_DIR/demo.log" 2>&1 &
launch=$!
stop() { kill -TERM "$launch" 2>/dev/null || true; wait "$launch" 2>/dev/null || true; }
trap stop EXIT

status=0
rosrun ramscout_bringup record_results _output:="$output" || status=$?
trap - EXIT
stop
echo "The results are in $output; roslaunch's own log is $ROS_LOG_DIR/demo.log"
exit "$status"
