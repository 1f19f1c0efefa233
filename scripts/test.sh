#!/usr/bin/env bash
# Builds everything and runs every unit test and rostest. Ends with the line `N passed, N failed`;
# the exit code is zero only if something was run and nothing failed.
set -eo pipefail
scripts=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
"$scripts/build.sh" --tests
source "$scripts/environment.sh"
source devel/setup.bash

status=0
"$scripts/lint.sh" || status=$?

rm -rf build/test_results build/Testing
cd build
ctest --output-on-failure --no-tests=error --timeout 600 "$@" || status=$?
cd ..
# ctest counts programs; the total counts the tests inside them. A program that crashed leaves no result file of its own
# or one that reports it, and then ctest's status is not zero either.
exec /usr/bin/python3 "$scripts/count_tests.py" build/test_results "$status"
