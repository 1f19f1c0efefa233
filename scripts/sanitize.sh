#!/usr/bin/env bash
# Runs unit tests with the sanitizers of addresses and undefined behaviour: those of all packages, or of the ones that are named:
#   scripts/sanitize.sh ramscout_sim ram_slam
# Shares the build in build_fuzz/ with fuzz.sh. The exit code is zero if every test passed and nothing was found.
set -eo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/sanitized_build.sh"
packages=("$@")
if [[ $# -eq 0 ]]; then packages=(ram_parameters ram_slam ramscout_bringup ramscout_feature_detector ramscout_kinematics ramscout_sim); fi
sanitized_build "${packages[@]/%/_test}"
mkdir -p results/sanitize
status=0
for package in "${packages[@]}"; do
  log=results/sanitize/$package.log
  # Assimp and Embree keep memory until the process ends, which is no loss.
  ASAN_OPTIONS=detect_leaks=0 "build_fuzz/devel/lib/$package/${package}_test" >"$log" 2>&1 || { status=1; echo "$package: failed, see $log"; }
  echo "$package: $(grep -oP '\[  PASSED  \] \K\d+ tests' "$log" || echo 'no tests') passed"
done
exit "$status"
