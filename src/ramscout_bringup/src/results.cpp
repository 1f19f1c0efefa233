// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/results.hpp"

#include <yaml-cpp/yaml.h>

#include "ram_slam/io/atomic_file.hpp"
#include "ram_slam/occupancy/map_file.hpp"
#include "ram_slam/world_map/map_folder.hpp"
#include "ram_slam/world_map/world_map_file.hpp"
#include "ramscout_bringup/picture.hpp"
#include "ramscout_bringup/report.hpp"

namespace ramscout_bringup {

std::string toYaml(const std::vector<MapLandmark>& landmarks) {
  YAML::Emitter out;
  out << YAML::BeginMap << YAML::Key << "landmarks" << YAML::Value << YAML::BeginSeq;
  for (const MapLandmark& landmark : landmarks) {
    const Eigen::Matrix2d& c = landmark.covariance_m2;
    out << YAML::BeginMap;
    out << YAML::Key << "id" << YAML::Value << landmark.id;
    out << YAML::Key << "type" << YAML::Value << landmark.type;
    out << YAML::Key << "position_m" << YAML::Value << YAML::Flow << YAML::BeginSeq
        << landmark.position_m.x() << landmark.position_m.y() << YAML::EndSeq;
    out << YAML::Key << "covariance_m2" << YAML::Value << YAML::Flow << YAML::BeginSeq << c(0, 0)
        << c(0, 1) << c(1, 0) << c(1, 1) << YAML::EndSeq;
    out << YAML::Key << "existence_log_odds" << YAML::Value << landmark.existence_log_odds;
    out << YAML::Key << "classifier" << YAML::Value << YAML::DoubleQuoted << landmark.classifier;
    out << YAML::EndMap;
  }
  out << YAML::EndSeq << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

void writeResults(const Results& results, const std::string& folder) {
  const auto write = [&](const std::string& name, const std::string& content) {
    ram_slam::writeFileAtomically(folder + "/" + name, content);
  };
  ram_slam::saveMap(results.map, folder + "/map");
  write("map.png", drawPicture(results));
  write("trajectory.tum", toTum(results.trajectory));
  write("trajectory_online.tum", toTum(results.trajectory_online));
  if (!results.trajectory_filter.empty())
    write("trajectory_filter.tum", toTum(results.trajectory_filter));
  if (!results.ground_truth.empty()) write("ground_truth.tum", toTum(results.ground_truth));
  if (!results.pose_graph_g2o.empty()) write("pose_graph.g2o", results.pose_graph_g2o);
  if (!results.world.empty()) write(ram_slam::kWorldFileName, ram_slam::toBytes(results.world));
  write("landmarks.yaml", toYaml(results.landmarks));
  write("summary.json", results.summary.dump(2) + "\n");
  write("report.html", toHtml(results));
}

}  // namespace ramscout_bringup
