#!/usr/bin/env bash
# Fuzzes every target for SECONDS (60 by default), or those that are named behind it:
#   scripts/fuzz.sh 600 drive.bag map.world
# Builds with clang and the sanitizers of addresses and undefined behaviour in build_fuzz/. What was found stays as a file in
# results/fuzz/findings/, what reached new code in results/fuzz/corpus/. The exit code is zero if nothing was found.
set -eo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/sanitized_build.sh"
seconds=${1:-60}
shift || true
sanitized_build ramscout_bringup_fuzzer
mkdir -p results/fuzz/findings
fuzzer=build_fuzz/devel/lib/ramscout_bringup/ramscout_bringup_fuzzer
FUZZ_LIST=results/fuzz/seeds "$fuzzer"
if [[ $# -eq 0 ]]; then mapfile -t targets < <(ls results/fuzz/seeds); else targets=("$@"); fi
status=0
for target in "${targets[@]}"; do
  mkdir -p "results/fuzz/corpus/$target"
  log=results/fuzz/$target.log
  # Assimp keeps some memory of each mesh that it refuses.
  FUZZ_TARGET=$target ASAN_OPTIONS=detect_leaks=0 "$fuzzer" -max_total_time="$seconds" -timeout=5 -rss_limit_mb=2048 \
    -max_len=8192 -print_final_stats=1 -artifact_prefix="results/fuzz/findings/$target." \
    "results/fuzz/corpus/$target" "results/fuzz/seeds/$target" >"$log" 2>&1 || { status=1; echo "$target: a finding, see $log"; }
  echo "$target: $(grep -oP 'stat::number_of_executed_units: *\K\d+' "$log" || echo no) executions"
done
exit "$status"
