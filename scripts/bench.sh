#!/usr/bin/env bash
# Prints what the kernels cost (Google Benchmark) and what the whole offline pipeline costs on the demo's bag.
# Ratios within one run are worth more than the times, which depend on the machine.
set -eo pipefail
scripts=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
"$scripts/build.sh"
source "$scripts/environment.sh"
make -C build -j"$(nproc)" feature_detector_benchmark >/dev/null
source devel/setup.bash
for benchmark in devel/lib/*/*_benchmark; do
  # services_benchmark needs a graph of its own: roslaunch ramscout_kinematics services.launch
  if [[ $(basename "$benchmark") == services_benchmark ]]; then continue; fi
  echo "== $(basename "$benchmark")"
  "$benchmark" --benchmark_min_time=0.2 2>/dev/null
done
bag=results/demo/run.bag
[[ -e $bag ]] || "$scripts/demo.sh"
echo "== run_bag on the demo's bag"
taskset -c 0 rosrun ramscout_bringup run_bag "$bag" --output results/bench >/dev/null
cat results/bench/timing.json
