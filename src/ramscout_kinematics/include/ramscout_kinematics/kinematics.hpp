// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <shared_mutex>
#include <vector>

#include <Eigen/Core>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/motion/motion_model.hpp"
#include "ramscout_kinematics/kinematics_parameters.hpp"
#include "ramscout_kinematics/odometry_buffer.hpp"

namespace ramscout_kinematics {

/// A state with its covariance; both of the same n.
struct StateWithCovariance {
  Eigen::VectorXd state;
  Eigen::MatrixXd covariance;
};

/// The motion of the robot between any two stamps, from buffered odometry: where it went and how
/// certain that is.
///
/// The motion comes from odometry, its noise from the drive model, white per metre of wheel travel
/// and carried exactly along the path. So nothing depends on how an interval is split: f(a->c) =
/// f(b->c) o f(a->b) for states and covariances. Samples are drawn from N(motion, covariance), the
/// very distribution that predictWithCovariance() returns.
///
/// States: n = 3 is [x y yaw], n = 6 is [x y z roll pitch yaw] [m, rad] in any world frame. The
/// motion is planar: it turns with the state's yaw; z, roll and pitch pass through with their
/// variances.
///
/// Thread-safe: odometry may be added while other threads ask.
class Kinematics : public ram_slam::MotionModel {
public:
  /// \throws as KinematicsParameters::validate()
  explicit Kinematics(const KinematicsParameters& parameters);

  /// \throws as OdometryBuffer::add()
  Added add(const OdometrySample& sample);

  /// \throws std::invalid_argument if to < from or a stamp is not positive; OdometryUnavailable if
  /// the odometry does
  ///         not cover the interval. So do all below, which refuse a bad state with
  ///         std::invalid_argument, too.
  ram_slam::PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const override;

  std::vector<ram_slam::Pose2> sample(const std::vector<ram_slam::Pose2>& map_from_base,
                                      std::int64_t from_ns,
                                      std::int64_t to_ns,
                                      std::uint64_t seed) const override;

  /// The state moved without noise.
  Eigen::VectorXd predict(const Eigen::VectorXd& state,
                          std::int64_t from_ns,
                          std::int64_t to_ns) const;

  /// The state moved, with its covariance carried along to first order and the noise of the motion
  /// added. `covariance` must have passed checkedCovariance().
  StateWithCovariance predictWithCovariance(const StateWithCovariance& start,
                                            std::int64_t from_ns,
                                            std::int64_t to_ns) const;

  /// Each column of `states` (n x count) moved by a motion of its own; column i depends on nothing
  /// but its state, the motion, `seed` and i.
  Eigen::MatrixXd sample(const Eigen::MatrixXd& states,
                         std::int64_t from_ns,
                         std::int64_t to_ns,
                         std::uint64_t seed) const;

  /// Stamps of the oldest and newest odometry; zero if there is none.
  std::int64_t oldestNs() const;
  std::int64_t newestNs() const;

private:
  ram_slam::PoseWithCovariance2 motionAlong(const MotionSegment& segment) const;

  KinematicsParameters parameters_;
  mutable std::shared_mutex mutex_;
  OdometryBuffer buffer_;
};

/// Whether a state of that many numbers exists: 3 or 6.
bool isStateSize(std::size_t size);

/// The covariance made symmetric, with eigenvalues that are negative by rounding (up to 1e-6 of the
/// trace) lifted to 0. \throws std::invalid_argument if it is not finite, differs from its
/// transpose by more than 1e-4 of its largest
///         entry, or is not positive semi-definite
Eigen::MatrixXd checkedCovariance(const Eigen::MatrixXd& covariance);

}  // namespace ramscout_kinematics
