#!/usr/bin/env bash
# Builds the workspace in Release; with --tests its test programs, too. Further arguments go to catkin_make.
set -eo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
tests=no
if [[ ${1:-} == --tests ]]; then tests=yes; shift; fi
# Without this folder the first configuration would cache a test environment without our Python messages.
mkdir -p devel/lib/python3/dist-packages
# Checkouts in different folders share one compiler cache.
export CCACHE_BASEDIR=$workspace CCACHE_NOHASHDIR=1
launcher=()
if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
catkin_make -j"$(nproc)" -DCMAKE_BUILD_TYPE=Release -DCMAKE_EXPORT_COMPILE_COMMANDS=ON "${launcher[@]}" "$@"
if [[ $tests == yes ]]; then catkin_make -j"$(nproc)" tests "$@"; fi
