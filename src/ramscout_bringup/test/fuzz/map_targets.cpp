// SPDX-License-Identifier: BSD-3-Clause
// Maps, checkpoints and pose graphs.
#include <fstream>
#include <sstream>

#include <ram_slam/occupancy/map_file.hpp>
#include <ram_slam/pose_graph/g2o.hpp>
#include <ram_slam/tracking/checkpoint.hpp>
#include <ram_slam/world_map/map_folder.hpp>
#include <ram_slam/world_map/world_map_file.hpp>
#include <ramscout_sim/map_image.hpp>
#include <world_map/example_world.hpp>

#include "fuzz_target.hpp"

namespace ramscout_bringup_ros {
namespace {

/// Of a world map's file: name, version, length and checksum.
constexpr std::size_t kHeaderBytes = 28;

/// The bytes with the length and the checksum (FNV-1a) that belong to them: what a checksum refuses
/// shows nothing about what is behind it.
std::string withHeader(const std::string& content) {
  std::uint64_t checksum = 14695981039346656037U;
  for (const char byte : content)
    checksum = (checksum ^ static_cast<unsigned char>(byte)) * 1099511628211U;
  const std::uint64_t size = content.size();
  std::string bytes = ram_slam::toBytes(ram_slam::WorldMap()).substr(0, 12);
  bytes.append(reinterpret_cast<const char*>(&size), sizeof(size));
  bytes.append(reinterpret_cast<const char*>(&checksum), sizeof(checksum));
  return bytes + content;
}

std::string checkpointSeed() {
  ram_slam::Checkpoint checkpoint;
  checkpoint.map.stamp_ns = 40;
  checkpoint.map.landmarks.resize(2);
  checkpoint.map.landmarks[1].id = 1;
  checkpoint.map.landmarks[1].type = "corner";
  checkpoint.path = {{10, {0.0, 0.0, 0.0}}, {40, {1.5, 0.2, 0.3}}};
  return toBytes(checkpoint);
}

std::string graphSeed() {
  ram_slam::PoseGraph graph;
  graph.map_from_node = {{0.1, -1.0 / 3.0, 0.2}, {1e-7, 123.0, -3.0}};
  graph.edges.resize(1);
  graph.edges[0].to = 1;
  std::ostringstream out;
  writeG2o(graph, out);
  return out.str();
}

void readMaps(const std::string& yaml_path) {
  ram_slam::loadMap(yaml_path);
  ramscout_sim::readMap(yaml_path);
}

/// An image, by a description that fits the one of the seed.
void readImage(const std::string&) {
  const std::string yaml = fuzzPath("image.yaml");
  std::ofstream(yaml) << "image: map.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\n"
                         "occupied_thresh: 0.65\nfree_thresh: 0.196\n";
  readMaps(yaml);
}

ram_slam::MapFile mapSeed() {
  return toMapFile(ram_slam::occupancyAt({}, 0, "map").grid, "sound.pgm");
}

void readDescription(const std::string& path) {
  std::ofstream(fuzzPath("sound.pgm"), std::ios::binary) << mapSeed().pgm;
  readMaps(path);
}

/// What was read can be saved and loaded again.
void readWorldContent(const std::string& bytes) {
  const ram_slam::WorldMap map = ram_slam::worldMapFromBytes(withHeader(bytes));
  try {
    ram_slam::worldMapFromBytes(toBytes(map));
  } catch (const std::exception& error) {
    throw std::logic_error(std::string("a map that is saved cannot be loaded: ") + error.what());
  }
}

}  // namespace

std::vector<FuzzTarget> mapTargets() {
  using namespace ram_slam;
  const std::string world = toBytes(exampleWorld());
  return {
      fileTarget("map.pgm", {mapSeed().pgm}, readImage),
      fileTarget("map.yaml", {mapSeed().yaml}, readDescription),
      fileTarget("map.world", {world}, [](const std::string& path) { loadWorldMap(path); }),
      {"world_content", {world.substr(kHeaderBytes)}, readWorldContent, false},
      {"checkpoint",
       {checkpointSeed().substr(kHeaderBytes)},
       [](const std::string& bytes) { checkpointFromBytes(withHeader(bytes)); },
       false},
      {"graph.g2o",
       {graphSeed()},
       [](const std::string& bytes) {
         std::istringstream in(bytes);
         readG2o(in);
       },
       false},
  };
}

}  // namespace ramscout_bringup_ros
