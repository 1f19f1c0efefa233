# Sourced by fuzz.sh and sanitize.sh: sanitized_build TARGET... builds with clang and the sanitizers in build_fuzz/.
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
sanitized_build() {
  local flags="-O1 -g1 -fsanitize=fuzzer-no-link,address,undefined,float-cast-overflow -fno-sanitize=vptr -fno-sanitize-recover=all"
  mkdir -p build_fuzz/devel/lib/python3/dist-packages
  export CCACHE_BASEDIR=$workspace CCACHE_NOHASHDIR=1
  ln -sf /usr/share/catkin/cmake/toplevel.cmake src/CMakeLists.txt
  cmake -S src -B build_fuzz -DCATKIN_DEVEL_PREFIX="$workspace/build_fuzz/devel" -DCATKIN_ENABLE_TESTING=ON -DRAM_SLAM_FUZZ=ON \
    -DCMAKE_C_COMPILER=clang-14 -DCMAKE_CXX_COMPILER=clang++-14 -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DRAM_SLAM_LTO=OFF \
    -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS="$flags" >build_fuzz/cmake.log 2>&1
  make -C build_fuzz -j"$(nproc)" "$@" >build_fuzz/make.log 2>&1
}
