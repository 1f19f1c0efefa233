// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <string>

#include <Eigen/Core>

#include "ram_parameters/parameter_reader.hpp"

namespace ramscout_kinematics {

/// How a kind of drive turns the errors of its wheels into errors of a motion: all that changes
/// with the platform.
///
/// A model is one header, one source (in src/models/, where CMake finds it), its test and its block
/// in config/kinematics.yaml. The source makes the model known by a DriveModelRegistration; nothing
/// else names it.
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

/// Reads a model's own parameters, refusing unknown keys and values out of range
/// (std::invalid_argument).
using ReadDriveModel =
    std::shared_ptr<const DriveModel> (*)(ram_parameters::ParameterReader& reader);

/// Every model by name.
const std::map<std::string, ReadDriveModel>& driveModels();

/// The model of that name at its default parameters. \throws std::invalid_argument naming the
/// models there are
std::shared_ptr<const DriveModel> makeDriveModel(const std::string& name);

/// A constant of this type in a model's source file makes the model known.
class DriveModelRegistration {
public:
  DriveModelRegistration(const char* name, ReadDriveModel read);
};

}  // namespace ramscout_kinematics
