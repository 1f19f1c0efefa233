// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "ram_parameters/parameter_file.hpp"
#include "ram_parameters/parameter_reader.hpp"

namespace ramscout_kinematics {

/// How a kind of drive turns the errors of its wheels into errors of a motion: all that changes
/// with the platform.
///
/// A model is one header, one source (in src/models/, where CMake finds it) and its test. The
/// source makes the model known by a DriveModelRegistration; nothing else names it. Its parameters
/// are the section of its name in config/kinematics.yaml.
class DriveModel {
public:
  virtual ~DriveModel() = default;

  /// Covariance of the error of a motion at constant twist, as an error of the increment itself.
  ///
  /// The error must grow with the distance travelled, not with its square: noise(a d) = a noise(d)
  /// for every a >= 0. Only then does it not matter into how many parts a motion is split.
  ///
  /// \param increment  forward, left [m], turned [rad]: the logarithm of the motion, in the base
  /// frame \return  order x, y, yaw [m^2, m rad, rad^2], symmetric and positive semi-definite
  virtual Eigen::Matrix3d noise(const Eigen::Vector3d& increment) const = 0;
};

/// A kind of drive, as it is chosen and documented.
struct DriveModelType {
  /// Makes the model from its own parameters, refusing unknown keys and values out of range
  /// (std::invalid_argument).
  std::shared_ptr<const DriveModel> (*read)(ram_parameters::ParameterReader& reader);
  /// Its parameters with their defaults.
  std::vector<ram_parameters::ParameterRow> (*rows)();
};

/// \tparam Model  made from `Parameters`, which have a table() and validate()
template <typename Model, typename Parameters>
DriveModelType driveModelType() {
  return {[](ram_parameters::ParameterReader& reader) -> std::shared_ptr<const DriveModel> {
            return std::make_shared<Model>(Parameters::table().readAll(reader));
          },
          [] { return Parameters::table().rows(); }};
}

/// Every model by name.
const std::map<std::string, DriveModelType>& driveModels();

/// The model of that name at its default parameters. \throws std::invalid_argument naming the
/// models there are
std::shared_ptr<const DriveModel> makeDriveModel(const std::string& name);

/// A constant of this type in a model's source file makes the model known.
class DriveModelRegistration {
public:
  DriveModelRegistration(const char* name, const DriveModelType& type);
};

}  // namespace ramscout_kinematics
