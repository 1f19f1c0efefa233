// SPDX-License-Identifier: BSD-3-Clause
//
// Damages files of every kind that the simulator reads, again and again, and reads them: each must
// be read or refused. Whatever else happens (a signal, another exception) ends the program. The
// same number of runs does the same.
//
//     fuzz_loaders [RUNS [FIRST_SEED]]
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <unistd.h>

#include "ramscout_sim/faults.hpp"
#include "ramscout_sim/random.hpp"
#include "ramscout_sim/robot_description.hpp"
#include "ramscout_sim/tour.hpp"
#include "ramscout_sim/world.hpp"

namespace {

using ramscout_sim::Random;
using ramscout_sim::Stream;

std::string textOf(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

struct Kind {
  std::string file_name;
  std::string sound;
  std::function<void(const std::string&)> read;
  int accepted = 0;
  int refused = 0;
};

/// Some bytes replaced, a piece left out or doubled, the end cut off.
std::string damaged(std::string text, Random& random) {
  const auto position = [&] { return text.empty() ? 0 : random.bits() % text.size(); };
  const int bytes = static_cast<int>(random.uniform(0.0, 6.0));
  for (int i = 0; i < bytes && !text.empty(); ++i)
    text[position()] = static_cast<char>(random.bits() % 256);
  const double piece = random.uniform();
  const std::size_t length = 1 + random.bits() % 40;
  if (piece < 0.2) text.erase(position(), length);
  if (piece >= 0.2 && piece < 0.4) text.insert(position(), text.substr(position(), length));
  if (piece >= 0.9) text.resize(position());
  return text;
}

std::vector<Kind> makeKinds() {
  const auto world = [](const std::string& path) { ramscout_sim::readWorld(path); };
  const std::string config = CONFIG_FOLDER;
  const std::string yaml =
      "start: [1, 2, 0]\nmaterials: [{name: pane, surface: glass, return_angle_rad: 0.1}]\n"
      "walls: [{from: [0, 0], to: [5, 0], thickness_m: 0.1, height_m: 2.5, material: pane}]\n"
      "boxes: [{center: [1, 2, 0.5], size: [0.4, 0.4, 1.0], yaw_rad: 0.3, pitch_rad: 0.1}]\n"
      "cylinders: [{center: [3, 1], radius_m: 0.2, height_m: 2.5, bottom_m: 0}]\n"
      "people: [{name: anna, waypoints: [[1, 6], [18, 6]], speed_mps: 1.2, loop: true}]\n"
      "doors: [{name: front, hinge: [5, 5], width_m: 0.9, schedule: [[10, 1], [25, 0]]}]\n";
  const std::string sdf =
      "<sdf version='1.6'><world name='w'><model name='m'><static>true</static>"
      "<pose>1 2 0 0 0 1</pose><link name='l'><collision name='c'><geometry><box><size>1 2 1</size>"
      "</box></geometry></collision><collision name='d'><geometry><cylinder><radius>1</radius>"
      "<length>2</length></cylinder></geometry></collision></link></model></world></sdf>";
  const std::string stl =
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
      "endfacet\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 2\nvertex 0 1 "
      "0\nendloop\n"
      "endfacet\nendsolid s\n";
  const std::string dae =
      "<?xml version='1.0'?><COLLADA version='1.4.1'><asset><unit "
      "meter='1'/><up_axis>Z_UP</up_axis>"
      "</asset><library_geometries><geometry id='g'><mesh><source id='p'><float_array id='a' "
      "count='9'>1 0 0 1 3 0 1 0 2</float_array><technique_common><accessor source='#a' count='3' "
      "stride='3'><param name='X' type='float'/><param name='Y' type='float'/><param name='Z' "
      "type='float'/></accessor></technique_common></source><vertices id='v'><input "
      "semantic='POSITION' source='#p'/></vertices><triangles count='1'><input semantic='VERTEX' "
      "source='#v' offset='0'/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>"
      "<library_visual_scenes><visual_scene id='s'><node id='n'><instance_geometry "
      "url='#g'/></node>"
      "</visual_scene></library_visual_scenes><scene><instance_visual_scene url='#s'/></scene>"
      "</COLLADA>";
  return {
      {"w.yaml", yaml, world},
      {"w.sdf", sdf, world},
      {"w.stl", stl, world},
      {"w.obj", "v 0 0 0\nv 1 0 0\nv 1 0 2\nv 0 0 2\nf 1 2 3 4\n", world},
      {"w.dae", dae, world},
      {"w.urdf", textOf(config + "/robots/ramscout.urdf"), world},
      {"robot.urdf", textOf(config + "/robots/ramscout.urdf"),
       [](const std::string& path) { ramscout_sim::readRobot(path); }},
      {"map.yaml", "image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0.1]\nnegate: 0\n", world},
      {"m.pgm", "P5\n# comment\n8 3\n255\n" + std::string(12, '\xfe') + std::string(12, '\0'),
       [](const std::string& path) {
         const std::string yaml_path = path + ".yaml";
         std::ofstream(yaml_path) << "image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n";
         ramscout_sim::readWorld(yaml_path);
       }},
      {"faults.yaml",
       "faults:\n  - {kind: kidnap, start_s: 3, pose: [1, 2, 3]}\n  - {kind: door, target: a, "
       "amount: "
       "1}\n",
       [](const std::string& path) { ramscout_sim::readFaults(path); }},
      {"tour.yaml", "speed_mps: 0.8\nwaypoints: [[1, 2], [3, 4], [5, 6]]\n",
       [](const std::string& path) { ramscout_sim::readTour(path); }},
  };
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::atoi(argv[1]) : 2000;
  const int first = argc > 2 ? std::atoi(argv[2]) : 0;
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("fuzz_loaders_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  std::vector<Kind> kinds = makeKinds();
  std::ofstream(folder / "m.pgm", std::ios::binary) << kinds[8].sound;
  for (Kind& kind : kinds) {
    const std::string path = (folder / kind.file_name).string();
    for (int run = 0; run < runs; ++run) {
      Random random(static_cast<std::uint64_t>(first + run), Stream::kBuilding);
      std::ofstream(path, std::ios::binary) << damaged(kind.sound, random);
      try {
        kind.read(path);
        ++kind.accepted;
      } catch (const std::runtime_error&) {
        ++kind.refused;
      } catch (const std::invalid_argument&) {
        ++kind.refused;
      }
    }
    std::ofstream(path, std::ios::binary) << kind.sound;
    std::cout << kind.file_name << ": " << kind.accepted << " read, " << kind.refused
              << " refused\n";
  }
  std::filesystem::remove_all(folder);
  return EXIT_SUCCESS;
}
