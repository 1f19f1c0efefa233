// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer: any bytes in a file called FUZZED_FILE are either read or refused with
// std::runtime_error or std::invalid_argument. seeds/ holds a sound file of each kind.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <unistd.h>

#include "ramscout_sim/faults.hpp"
#include "ramscout_sim/robot_description.hpp"
#include "ramscout_sim/tour.hpp"
#include "ramscout_sim/world.hpp"

namespace {

const std::string kFile = FUZZED_FILE;

/// In memory where there is such a place.
std::filesystem::path makeFolder() {
  const std::filesystem::path memory = "/dev/shm";
  const std::filesystem::path folder =
      (std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path()) /
      ("loader_fuzzer_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  if (kFile == "map.yaml") {
    std::ofstream(folder / "map.pgm", std::ios::binary)
        << "P5\n8 3\n255\n"
        << std::string(12, '\xfe') << std::string(12, '\0');
  }
  if (kFile == "map.pgm")
    std::ofstream(folder / "map.yaml") << "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n";
  return folder;
}

void read(const std::filesystem::path& folder) {
  const std::string path = folder / kFile;
  if (kFile == "robot.urdf")
    ramscout_sim::readRobot(path);
  else if (kFile == "faults.yaml")
    ramscout_sim::readFaults(path);
  else if (kFile == "tour.yaml")
    ramscout_sim::readTour(path);
  else if (kFile == "map.pgm")
    ramscout_sim::readWorld(folder / "map.yaml");
  else
    ramscout_sim::readWorld(path);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path folder = makeFolder();
  std::ofstream(folder / kFile, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    read(folder);
  } catch (const std::runtime_error&) {
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
