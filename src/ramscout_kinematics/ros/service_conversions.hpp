// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nav_msgs/Odometry.h>

#include "ramscout_kinematics/kinematics.hpp"

namespace ramscout_kinematics_ros {

/// A request that is wrong in itself, with its status in SampleStates.srv.
class InvalidRequest : public std::invalid_argument {
public:
  InvalidRequest(std::uint8_t the_status, const std::string& message)
      : std::invalid_argument(message), status(the_status) {}
  const std::uint8_t status;
};

/// \throws InvalidRequest unless it has 3 or 6 finite numbers
Eigen::VectorXd toState(const std::vector<float>& values);
/// \throws InvalidRequest unless it is n x n and passes ramscout_kinematics::checkedCovariance()
Eigen::MatrixXd toCovariance(const std::vector<float>& values, Eigen::Index size);
/// One state per column. \throws InvalidRequest unless 1 <= count <= most and there are 3 or 6
/// finite numbers each
Eigen::MatrixXd toStates(const std::vector<double>& values,
                         std::uint32_t count,
                         std::uint32_t most);

/// Rounded once, row-major.
std::vector<float> toFloats(const Eigen::MatrixXd& values);

/// \throws std::invalid_argument if the pose or twist is not finite or not in the plane
ramscout_kinematics::OdometrySample toOdometrySample(const nav_msgs::Odometry& message);

/// The status of SampleStates.srv for a reason of the odometry buffer.
std::uint8_t toStatus(ramscout_kinematics::Unavailable reason);

}  // namespace ramscout_kinematics_ros
