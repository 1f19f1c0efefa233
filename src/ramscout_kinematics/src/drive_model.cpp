// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/drive_model.hpp"

#include <stdexcept>

namespace ramscout_kinematics {
namespace {

/// Inside a function, so that it exists before the first registration wants it.
std::map<std::string, DriveModelType>& registry() {
  static std::map<std::string, DriveModelType> models;
  return models;
}

}  // namespace

const std::map<std::string, DriveModelType>& driveModels() {
  return registry();
}

std::shared_ptr<const DriveModel> makeDriveModel(const std::string& name) {
  const auto found = registry().find(name);
  if (found == registry().end()) {
    std::string known;
    for (const auto& entry : registry()) known += (known.empty() ? "" : ", ") + entry.first;
    throw std::invalid_argument("model must be one of " + known + ", got '" + name + "'");
  }
  ram_parameters::ParameterReader defaults{YAML::Node(), name};
  return found->second.read(defaults);
}

DriveModelRegistration::DriveModelRegistration(const char* name, const DriveModelType& type) {
  registry().emplace(name, type);
}

}  // namespace ramscout_kinematics
