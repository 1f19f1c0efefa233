// SPDX-License-Identifier: BSD-3-Clause
#include "service_conversions.hpp"

#include <ram_slam_msgs/SampleStates.h>

#include "ram_slam/ros/conversions.hpp"

namespace ramscout_kinematics_ros {
namespace {

using Status = ram_slam_msgs::SampleStates::Response;

void checkFinite(const Eigen::MatrixXd& states) {
  if (!states.allFinite()) throw InvalidRequest(Status::INVALID_STATE, "state is not finite");
}

}  // namespace

Eigen::VectorXd toState(const std::vector<float>& values) {
  if (!ramscout_kinematics::isStateSize(values.size())) {
    throw InvalidRequest(Status::INVALID_STATE,
                         "a state has 3 or 6 numbers, got " + std::to_string(values.size()));
  }
  const Eigen::VectorXd state =
      Eigen::Map<const Eigen::VectorXf>(values.data(), static_cast<Eigen::Index>(values.size()))
          .cast<double>();
  checkFinite(state);
  return state;
}

Eigen::MatrixXd toCovariance(const std::vector<float>& values, Eigen::Index size) {
  if (values.size() != static_cast<std::size_t>(size * size)) {
    throw InvalidRequest(Status::INVALID_COVARIANCE, "the covariance of a state of " +
                                                         std::to_string(size) + " numbers has " +
                                                         std::to_string(size * size) + ", got " +
                                                         std::to_string(values.size()));
  }
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::MatrixXd covariance =
      Eigen::Map<const RowMajor>(values.data(), size, size).cast<double>();
  try {
    return ramscout_kinematics::checkedCovariance(covariance);
  } catch (const std::invalid_argument& error) {
    throw InvalidRequest(Status::INVALID_COVARIANCE, error.what());
  }
}

Eigen::MatrixXd toStates(const std::vector<double>& values,
                         std::uint32_t count,
                         std::uint32_t most) {
  if (count == 0 || count > most) {
    throw InvalidRequest(Status::INVALID_STATE, "count must be 1.." + std::to_string(most) +
                                                    ", got " + std::to_string(count));
  }
  if (values.size() % count != 0 || !ramscout_kinematics::isStateSize(values.size() / count)) {
    throw InvalidRequest(Status::INVALID_STATE, "a state has 3 or 6 numbers, got " +
                                                    std::to_string(values.size()) + " for " +
                                                    std::to_string(count) + " states");
  }
  const Eigen::MatrixXd states = Eigen::Map<const Eigen::MatrixXd>(
      values.data(), static_cast<Eigen::Index>(values.size() / count),
      static_cast<Eigen::Index>(count));
  checkFinite(states);
  return states;
}

std::vector<float> toFloats(const Eigen::MatrixXd& values) {
  std::vector<float> floats;
  floats.reserve(static_cast<std::size_t>(values.size()));
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    for (Eigen::Index column = 0; column < values.cols(); ++column) {
      floats.push_back(static_cast<float>(values(row, column)));
    }
  }
  return floats;
}

ramscout_kinematics::OdometrySample toOdometrySample(const nav_msgs::Odometry& message) {
  ramscout_kinematics::OdometrySample sample;
  sample.stamp_ns = ram_slam_ros::toNanoseconds(message.header.stamp);
  sample.odom_from_base = ram_slam_ros::toPose2(message.pose.pose);
  const geometry_msgs::Twist& twist = message.twist.twist;
  sample.twist = {twist.linear.x, twist.linear.y, twist.angular.z};
  return sample;
}

std::uint8_t toStatus(ramscout_kinematics::Unavailable reason) {
  switch (reason) {
    case ramscout_kinematics::Unavailable::kNoOdometry:
      return Status::NO_ODOMETRY;
    case ramscout_kinematics::Unavailable::kBeforeFirst:
    case ramscout_kinematics::Unavailable::kTooOld:
      return Status::TOO_OLD;
    case ramscout_kinematics::Unavailable::kNotYetAvailable:
      return Status::NOT_YET_AVAILABLE;
    case ramscout_kinematics::Unavailable::kGap:
      return Status::GAP;
  }
  throw std::logic_error("a reason without a status");
}

}  // namespace ramscout_kinematics_ros
