#!/usr/bin/env bash
# Format, clang-tidy, catkin's manifests, boundaries, lengths, and what the documents name. Runs every check and fails if
# one found something. clang-tidy needs the compile commands of a build and is left out without them, and with --quick.
set -o pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
export PATH=/usr/bin:$PATH
status=0
run() {
  local name=$1 output
  shift
  output=$("$@" 2>&1) && return
  status=1
  echo "lint: $name"
  echo "$output"
}
check_format() { git ls-files -z '*.hpp' '*.cpp' | xargs -0 clang-format --dry-run --Werror; }

run "format (make format repairs it)" check_format
run "boundaries and lengths" scripts/check_structure.py
run "documents" scripts/check_docs.py
run "catkin's manifests" catkin_lint --offline -W2 --strict src
if [[ ${1:-} != --quick && -e build/compile_commands.json ]]; then run "clang-tidy" scripts/tidy.py; fi
if [[ $status -eq 0 ]]; then echo "lint: nothing found"; fi
exit $status
