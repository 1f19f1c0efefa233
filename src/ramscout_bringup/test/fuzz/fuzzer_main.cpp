// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer with the target that the environment variable FUZZ_TARGET names. With FUZZ_LIST=FOLDER
// it writes the sound inputs of each target into a folder of its name there instead, and ends.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include "fuzz_target.hpp"

using namespace ramscout_bringup_ros;

namespace {

void writeSeeds(const std::filesystem::path& folder) {
  for (const FuzzTarget& target : fuzzTargets()) {
    std::filesystem::create_directories(folder / target.name);
    for (std::size_t i = 0; i < target.seeds.size(); ++i) {
      const auto path = folder / target.name / ("seed_" + std::to_string(i));
      std::ofstream(path, std::ios::binary) << target.seeds[i];
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  if (const char* folder = std::getenv("FUZZ_LIST")) {
    writeSeeds(folder);
    std::exit(0);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FuzzTarget& target = []() -> const FuzzTarget& {
    const char* name = std::getenv("FUZZ_TARGET");
    return fuzzTarget(name ? name : "");
  }();
  try {
    tryBytes(target, std::string(reinterpret_cast<const char*>(data), size));
  } catch (const std::exception& finding) {
    std::cerr << finding.what() << std::endl;
    std::abort();
  }
  return 0;
}
