#!/usr/bin/env bash
# grade.sh [SEED...]: grades all scenarios of config/scenarios; the reports go to results/grade. The exit code is zero only
# if every limit is kept.
set -eo pipefail
scripts=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
"$scripts/build.sh"
source "$scripts/environment.sh"
source devel/setup.bash
[[ $# -gt 0 ]] || set -- 1
status=0
for scenario in config/scenarios/*.yaml; do
  rosrun ramscout_bringup grade "$scenario" "$@" --output results/grade || status=1
done
exit "$status"
