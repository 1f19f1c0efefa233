// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/landmarks/landmark.hpp"

namespace ram_slam {

/// A normal distribution over the robot's pose and the positions of landmarks together: the state
/// of EKF-SLAM.
///
/// The covariance is that of the right-invariant error xi = (xi_yaw, xi_p, xi_1, ..., xi_n) with
/// truth = Exp(xi) * estimate: xi_yaw = d yaw, xi_i = d m_i - J m_i d yaw, J = [[0, -1], [1, 0]]
/// (Barrau and Bonnabel, arXiv:1510.06263; Zhang et al., IEEE RA-L 2(2), 2017). A motion carries it
/// along unchanged, and the Jacobian of a measurement depends on nothing but the yaw: the filter
/// gains no information about the global heading that no measurement holds, as the standard EKF
/// does. All covariances that go in and out are of x, y and yaw themselves, in the axes of the map.
class JointBelief {
public:
  explicit JointBelief(const PoseWithCovariance2& map_from_base = {}) { setPose(map_from_base); }

  /// Number of landmarks.
  std::size_t size() const { return points_m_.size(); }
  /// map_from_base
  const Pose2& pose() const { return pose_; }
  PoseWithCovariance2 poseWithCovariance() const;
  const Eigen::Vector2d& point_m(std::size_t i) const { return points_m_[i]; }
  Landmark landmark(std::size_t i) const;
  /// E[(m_i - mean)(m_j - mean)^T] [m^2]
  Eigen::Matrix2d crossCovariance(std::size_t i, std::size_t j) const;
  /// Of m_i - m_j where both are at the same place [m^2].
  Eigen::Matrix2d differenceCovariance(std::size_t i, std::size_t j) const;
  /// Of the landmark's position seen from the robot, but for the yaw's error, in the axes of the
  /// map [m^2].
  Eigen::Matrix2d covarianceFromPose(std::size_t i) const;
  /// The same belief about the pose and these landmarks, in this order, without the others.
  JointBelief part(const std::vector<std::size_t>& landmarks) const;

  /// The robot moves. \param motion  of the base, with the covariance of its noise
  void move(const PoseWithCovariance2& motion);

  /// A landmark seen from the pose, in the base frame.
  struct Sighting {
    std::size_t landmark = 0;
    PointMeasurement measured;
  };
  /// Measured position less the expected one, with its covariance; the Jacobians are not set.
  Innovation innovation(const Sighting& sighting) const;
  /// Takes in all sightings at once.
  void correct(const std::vector<Sighting>& sightings);

  /// A new landmark, seen from the pose.
  void add(const PointMeasurement& measured);
  /// New landmarks that are independent of all the others.
  /// \param covariance_m2  joint covariance of their coordinates, 2n x 2n
  void add(const std::vector<Eigen::Vector2d>& points_m, const Eigen::MatrixXd& covariance_m2);
  /// Leaves out these landmarks; the others keep their order. \param landmarks  ascending
  void remove(const std::vector<std::size_t>& landmarks);

  /// The robot is there; that is independent of the landmarks.
  void setPose(const PoseWithCovariance2& map_from_base);
  /// Moves the pose to new_from_old * pose, rigidly: its relation to the landmarks stays as certain
  /// as it was.
  void movePose(const Pose2& new_from_old);
  /// The same for each landmark. \param new_from_old  one per landmark
  void movePoints(const std::vector<Pose2>& new_from_old);

private:
  /// Row of the first coordinate of a landmark's error.
  static Eigen::Index row(std::size_t landmark) {
    return 3 + 2 * static_cast<Eigen::Index>(landmark);
  }
  static constexpr Eigen::Index kPositionRow = 1;  // behind the yaw

  auto covariance() { return storage_.topLeftCorner(dimension_, dimension_); }
  auto covariance() const { return storage_.topLeftCorner(dimension_, dimension_); }
  Eigen::Matrix2d block(Eigen::Index row, Eigen::Index column) const;
  /// Two columns of the whole matrix; only its lower half is stored.
  Eigen::MatrixX2d columns(Eigen::Index first) const;
  void resize(Eigen::Index dimension);
  /// J times the position that each row of the error belongs to; 0 for the yaw.
  Eigen::VectorXd turned() const;
  /// Turns the covariance of the error into that of the coordinates, or back (sign -1).
  void convert(double sign);
  /// d position in terms of the error of a position: xi + J position d yaw.
  Eigen::Matrix2d plain(Eigen::Index row_a,
                        const Eigen::Vector2d& a_m,
                        Eigen::Index row_b,
                        const Eigen::Vector2d& b_m) const;
  /// P H^T of the sightings, and the covariance of their innovations.
  struct Gain {
    Eigen::MatrixXd cross;       ///< P H^T
    Eigen::MatrixXd covariance;  ///< H P H^T + R
  };
  Gain gain(const std::vector<Sighting>& sightings) const;
  void retract(const Eigen::VectorXd& error);

  Pose2 pose_;
  std::vector<Eigen::Vector2d> points_m_;
  Eigen::Index dimension_ = 3;
  /// The lower half of the covariance, in a matrix that grows by more than it must.
  Eigen::MatrixXd storage_ = Eigen::MatrixXd::Zero(3, 3);
};

}  // namespace ram_slam
