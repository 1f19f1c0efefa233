// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/parameter_files.hpp"

#include <utility>

namespace ramscout_bringup {
namespace {

YAML::Node overridden(const YAML::Node& below, const YAML::Node& above) {
  if (!above.IsDefined() || above.IsNull()) return below;
  if (!below.IsDefined() || !below.IsMap() || !above.IsMap()) return above;
  YAML::Node merged = YAML::Clone(below);
  for (const auto& entry : above) {
    const std::string key = entry.first.Scalar();
    merged[key] = overridden(below[key], entry.second);
  }
  return merged;
}

}  // namespace

ParameterFiles::ParameterFiles(std::string folder,
                               const std::string& robot,
                               const std::string& lidar)
    : folder_(std::move(folder)) {
  if (!robot.empty()) urdf_ = addPreset("robots", robot) + ".urdf";
  if (!lidar.empty()) addPreset("lidars", lidar);
}

std::string ParameterFiles::addPreset(const std::string& kind, const std::string& name) {
  const bool is_path = name.find('/') != std::string::npos;
  const std::string stem = is_path ? name : folder_ + "/" + kind + "/" + name;
  const std::string path = stem + ".yaml";
  Preset preset{path, ram_parameters::readYamlFile(path)};
  ram_parameters::ParameterReader reader(preset.sections, path);
  for (const char* node :
       {"edge_detector", "fast_slam", "feature_detector", "kinematics", "landmark_smoother",
        "laser_odometry", "map_smoother", "occupancy_mapper", "simulator", "world_map"})
    reader.section(node);
  reader.rejectUnknown();
  presets_.push_back(std::move(preset));
  return stem;
}

ram_parameters::ParameterReader ParameterFiles::reader(const std::string& name,
                                                       const std::string& node) const {
  YAML::Node values = ram_parameters::readYamlFile(path(name));
  std::string source = path(name);
  for (const Preset& preset : presets_) {
    const YAML::Node section = preset.sections.IsMap() ? preset.sections[node] : YAML::Node();
    if (!section.IsDefined() || section.IsNull()) continue;
    values.reset(overridden(values, section));
    source += ", " + preset.path;
  }
  return {values, source};
}

}  // namespace ramscout_bringup
