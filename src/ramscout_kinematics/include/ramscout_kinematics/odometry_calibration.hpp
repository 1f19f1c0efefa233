// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include <Eigen/Core>

#include "ram_slam/pose2.hpp"

namespace ramscout_kinematics {

struct OdometryCalibrationParameters {
  double wheel_separation_m = 0.36;
  /// Standard deviation of the relative errors before anything is known, and how it grows per root
  /// metre afterwards.
  double prior_sigma = 0.05;
  double drift_sigma_per_root_m = 1e-4;
  /// Errors are corrected once they exceed three standard deviations and this much was driven, up
  /// to this size.
  double min_distance_m = 30.0;
  double max_correction = 0.1;
  /// A relative error beyond this is a fault of the robot.
  double alert_error = 0.05;
  /// Over how many intervals the noise's scale is averaged.
  double noise_window = 200.0;
  /// An interval this unlikely is a slip of the wheels: the quantile of chi^2 with 3 degrees at 1 -
  /// 1e-6.
  double slip_limit = 30.7;
  /// Limit of the cumulative sum (CUSUM) of normalised errors beyond 1 + 0.5.
  double inconsistency_limit = 12.0;
  /// The odometry is stuck if it stood still while the robot moved further than this in three
  /// intervals in a row.
  double stuck_distance_m = 0.05;

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// Relative errors of a differential drive's geometry: the true left wheel travels (1 + left) times
/// what odometry says.
struct WheelErrors {
  double left = 0.0;
  double right = 0.0;
  double separation = 0.0;
};

/// What an interval says about the health of the odometry.
struct OdometryHealth {
  double normalised_error =
      0.0;  ///< squared Mahalanobis distance of odometry and observation, 3 degrees of freedom
  bool slipped = false;       ///< this interval does not fit, though those before did
  bool stuck = false;         ///< the robot moves, the odometry does not
  bool inconsistent = false;  ///< errors larger than the noise model says, for a while
  bool biased = false;        ///< an error of the geometry beyond the alert limit, for certain
};

/// Learns systematic errors of the odometry and the true size of its noise from what an independent
/// observer (scan matching, not a filter that has used the odometry) says about the same motions,
/// and tells when something is broken.
///
/// A Kalman filter on the three errors: logarithm(observed) - logarithm(odometry) = A errors +
/// noise, with the travels l and r of the wheels A = [[l/2, r/2, 0], [0, 0, 0], [-l/b, r/b,
/// -turn]]. The observations must be of the raw odometry; corrected odometry fed back would be
/// corrected twice.
class OdometryCalibration {
public:
  /// \throws as OdometryCalibrationParameters::validate()
  explicit OdometryCalibration(const OdometryCalibrationParameters& parameters);

  /// Takes one interval of some decimetres: the motion that odometry tells with its noise
  /// (Kinematics::motion()), and the one observed with its own. \throws std::invalid_argument if a
  /// value is not finite or the covariances' sum is not positive definite
  OdometryHealth update(const ram_slam::PoseWithCovariance2& odometry,
                        const ram_slam::PoseWithCovariance2& observed);

  WheelErrors errors() const { return {errors_(0), errors_(1), errors_(2)}; }
  /// Covariance of left, right, separation.
  const Eigen::Matrix3d& covariance() const { return covariance_; }
  /// By how much the variance of the noise model is to be multiplied.
  double noiseScale() const { return noise_scale_; }

  /// The errors, if they are certain enough to be corrected.
  std::optional<WheelErrors> correction() const;

private:
  Eigen::Matrix3d sensitivity(const Eigen::Vector3d& increment) const;
  /// Maximum likelihood of the scale, each axis weighed by how much of its error is the odometry's.
  void learnNoiseScale(const Eigen::Vector3d& innovation,
                       const Eigen::Vector3d& explained_variance,
                       const Eigen::Vector3d& odometry_variance);
  /// Covariance of the errors before an interval of that length.
  Eigen::Matrix3d priorAfter(double distance_m) const;
  void learnErrors(const Eigen::Matrix3d& a,
                   const Eigen::Matrix3d& prior,
                   const Eigen::Vector3d& innovation,
                   const Eigen::Matrix3d& noise);
  bool isInconsistent(double normalised_error);
  bool isStuck(const Eigen::Vector3d& odometry, const Eigen::Vector3d& observed);

  OdometryCalibrationParameters parameters_;
  Eigen::Vector3d errors_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_;
  double distance_m_ = 0.0;
  double noise_scale_ = 1.0;
  double scale_sum_ = 10.0;  // as if ten axes had said 1
  double scale_weight_ = 10.0;
  double cumulative_sum_ = 0.0;
  bool inconsistent_ = false;
  int intervals_stuck_ = 0;
};

/// The increment (forward, left [m], turned [rad]) with the wheels' errors taken out.
Eigen::Vector3d corrected(const Eigen::Vector3d& increment,
                          const WheelErrors& errors,
                          double wheel_separation_m);

}  // namespace ramscout_kinematics
