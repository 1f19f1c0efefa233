// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ram_parameters/parameter_reader.hpp"

namespace ramscout_bringup {

/// The robot of the simulation unless another one is asked for.
inline constexpr const char* kReferenceRobot = "ramscout";

/// The nodes' parameters as the launch files load them: first <node>.yaml, then the sections of a
/// robot's and a lidar's file, which override it.
class ParameterFiles {
public:
  /// \param folder  such as config/
  /// \param robot  a name in its folder robots, or a path without its ending; empty: none
  /// \param lidar  a name in its folder lidars, or a path without its ending; empty: none
  /// \throws std::runtime_error if a file of robot or lidar cannot be read
  /// \throws std::invalid_argument if it has a section that is of no node
  explicit ParameterFiles(std::string folder,
                          const std::string& robot = "",
                          const std::string& lidar = "");

  std::string path(const std::string& name) const { return folder_ + "/" + name + ".yaml"; }
  /// What <name>.yaml states, overridden by the sections of `node`.
  /// \throws std::runtime_error if the file cannot be read
  ram_parameters::ParameterReader reader(const std::string& name, const std::string& node) const;
  ram_parameters::ParameterReader reader(const std::string& name) const {
    return reader(name, name);
  }
  /// The robot's description, beside its file.
  const std::string& urdf() const { return urdf_; }

private:
  struct Preset {
    std::string path;
    YAML::Node sections;
  };
  /// \returns the file's path without its ending
  std::string addPreset(const std::string& kind, const std::string& name);

  std::string folder_;
  std::string urdf_;
  std::vector<Preset> presets_;  // the later ones override
};

}  // namespace ramscout_bringup
