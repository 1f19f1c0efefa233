// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/odometry_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "check.hpp"

namespace ramscout_kinematics {
namespace {

using ram_slam::PoseWithCovariance2;

constexpr double kDimensions = 3.0;
/// Part of the normalised error per dimension beyond 1 that the cumulative sum forgives.
constexpr double kForgiven = 0.5;
constexpr double kCertainSigmas = 3.0;
constexpr double kLeastNoiseScale = 0.01;
constexpr int kStuckIntervals = 3;
constexpr double kStillM = 0.001;
constexpr double kStillRad = 0.001;
constexpr double kDifferenceStep = 1e-6;

/// Covariance of the logarithm of a pose: J covariance J^T, J by central differences.
Eigen::Matrix3d covarianceOfLogarithm(const PoseWithCovariance2& pose) {
  const Eigen::Vector3d mean(pose.pose.x_m, pose.pose.y_m, pose.pose.yaw_rad);
  Eigen::Matrix3d jacobian;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = kDifferenceStep * Eigen::Vector3d::Unit(i);
    const auto logarithmAt = [](const Eigen::Vector3d& at) {
      return ram_slam::logarithm({at.x(), at.y(), at.z()});
    };
    jacobian.col(i) =
        (logarithmAt(mean + step) - logarithmAt(mean - step)) / (2.0 * kDifferenceStep);
  }
  return jacobian * pose.covariance * jacobian.transpose();
}

}  // namespace

void OdometryCalibrationParameters::validate() const {
  check(wheel_separation_m > 0.0, "wheel_separation_m", wheel_separation_m, "> 0");
  check(prior_sigma > 0.0, "prior_sigma", prior_sigma, "> 0");
  check(drift_sigma_per_root_m >= 0.0, "drift_sigma_per_root_m", drift_sigma_per_root_m, ">= 0");
  check(min_distance_m >= 0.0, "min_distance_m", min_distance_m, ">= 0");
  check(max_correction > 0.0 && max_correction < 1.0, "max_correction", max_correction,
        "in (0, 1)");
  check(alert_error > 0.0, "alert_error", alert_error, "> 0");
  check(noise_window >= 1.0, "noise_window", noise_window, ">= 1");
  check(slip_limit > 0.0, "slip_limit", slip_limit, "> 0");
  check(inconsistency_limit > 0.0, "inconsistency_limit", inconsistency_limit, "> 0");
  check(stuck_distance_m > 0.0, "stuck_distance_m", stuck_distance_m, "> 0");
}

OdometryCalibration::OdometryCalibration(const OdometryCalibrationParameters& parameters)
    : parameters_(parameters),
      covariance_(parameters.prior_sigma * parameters.prior_sigma * Eigen::Matrix3d::Identity()) {
  parameters_.validate();
}

Eigen::Matrix3d OdometryCalibration::sensitivity(const Eigen::Vector3d& increment) const {
  const double separation_m = parameters_.wheel_separation_m;
  const double left_m = increment.x() - separation_m * increment.z() / 2.0;
  const double right_m = increment.x() + separation_m * increment.z() / 2.0;
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  a.row(0) << left_m / 2.0, right_m / 2.0, 0.0;
  a.row(2) << -left_m / separation_m, right_m / separation_m, -increment.z();
  return a;
}

Eigen::Matrix3d OdometryCalibration::priorAfter(double distance_m) const {
  // What was learnt may have changed since, but is never less known than at the start.
  const double most = parameters_.prior_sigma * parameters_.prior_sigma;
  const double growth = std::pow(parameters_.drift_sigma_per_root_m, 2) * distance_m;
  Eigen::Matrix3d prior = covariance_;
  for (int i = 0; i < 3; ++i)
    prior(i, i) = std::max(prior(i, i), std::min(most, prior(i, i) + growth));
  return prior;
}

bool OdometryCalibration::isStuck(const Eigen::Vector3d& odometry,
                                  const Eigen::Vector3d& observed) {
  const bool still = odometry.head<2>().norm() < kStillM && std::abs(odometry.z()) < kStillRad;
  const bool moved = observed.head<2>().norm() > parameters_.stuck_distance_m;
  intervals_stuck_ = still && moved ? intervals_stuck_ + 1 : 0;
  return intervals_stuck_ >= kStuckIntervals;
}

void OdometryCalibration::learnNoiseScale(const Eigen::Vector3d& innovation,
                                          const Eigen::Vector3d& explained_variance,
                                          const Eigen::Vector3d& odometry_variance) {
  const double kept = 1.0 - 1.0 / parameters_.noise_window;
  scale_sum_ *= kept;
  scale_weight_ *= kept;
  for (int i = 0; i < 3; ++i) {
    const double expected = noise_scale_ * odometry_variance(i) + explained_variance(i);
    const double squared =
        std::min(innovation(i) * innovation(i), parameters_.slip_limit * expected);
    const double information = std::pow(odometry_variance(i) / expected, 2);
    scale_weight_ += information;
    if (odometry_variance(i) > 0.0) {
      scale_sum_ += information * (squared - explained_variance(i)) / odometry_variance(i);
    }
  }
  noise_scale_ = std::max(kLeastNoiseScale, scale_sum_ / scale_weight_);
}

OdometryHealth OdometryCalibration::update(const PoseWithCovariance2& odometry,
                                           const PoseWithCovariance2& observed) {
  const Eigen::Vector3d increment = ram_slam::logarithm(odometry.pose);
  const Eigen::Vector3d observed_increment = ram_slam::logarithm(observed.pose);
  const Eigen::Matrix3d odometry_noise = covarianceOfLogarithm(odometry);
  const Eigen::Matrix3d observation_noise = covarianceOfLogarithm(observed);
  const Eigen::Matrix3d a = sensitivity(increment);
  const double distance_m = increment.head<2>().norm();
  const Eigen::Matrix3d p = priorAfter(distance_m);
  Eigen::Vector3d innovation = observed_increment - increment - a * errors_;
  innovation.z() = ram_slam::wrapAngle(innovation.z());
  const Eigen::Matrix3d explained = a * p * a.transpose() + observation_noise;
  const Eigen::LLT<Eigen::Matrix3d> expected(explained + odometry_noise);
  const Eigen::LLT<Eigen::Matrix3d> expected_at_scale(explained + noise_scale_ * odometry_noise);
  if (!innovation.allFinite() || !expected.matrixLLT().allFinite() ||
      expected.info() != Eigen::Success || expected_at_scale.info() != Eigen::Success) {
    throw std::invalid_argument("motion is not finite or its covariance not positive definite");
  }
  OdometryHealth health;
  health.normalised_error = innovation.dot(expected.solve(innovation));
  health.slipped = innovation.dot(expected_at_scale.solve(innovation)) > parameters_.slip_limit;
  health.stuck = isStuck(increment, observed_increment);

  learnNoiseScale(innovation, explained.diagonal(), odometry_noise.diagonal());
  health.inconsistent = isInconsistent(health.normalised_error);

  distance_m_ += distance_m;
  if (!health.slipped && intervals_stuck_ == 0) {
    learnErrors(a, p, innovation, noise_scale_ * odometry_noise + observation_noise);
  }
  const Eigen::Vector3d certain =
      errors_.cwiseAbs() - kCertainSigmas * covariance_.diagonal().cwiseSqrt();
  health.biased = certain.maxCoeff() > parameters_.alert_error;
  return health;
}

bool OdometryCalibration::isInconsistent(double normalised_error) {
  cumulative_sum_ = std::clamp(cumulative_sum_ + normalised_error / kDimensions - 1.0 - kForgiven,
                               0.0, 2.0 * parameters_.inconsistency_limit);
  if (cumulative_sum_ > parameters_.inconsistency_limit) inconsistent_ = true;
  if (cumulative_sum_ < parameters_.inconsistency_limit / 2.0) inconsistent_ = false;
  return inconsistent_;
}

void OdometryCalibration::learnErrors(const Eigen::Matrix3d& a,
                                      const Eigen::Matrix3d& prior,
                                      const Eigen::Vector3d& innovation,
                                      const Eigen::Matrix3d& noise) {
  const Eigen::Matrix3d expected = a * prior * a.transpose() + noise;
  const Eigen::Matrix3d gain = expected.llt().solve(a * prior).transpose();
  errors_ += gain * innovation;
  const Eigen::Matrix3d kept = Eigen::Matrix3d::Identity() - gain * a;
  covariance_ = kept * prior * kept.transpose() + gain * noise * gain.transpose();
}

std::optional<WheelErrors> OdometryCalibration::correction() const {
  if (distance_m_ < parameters_.min_distance_m) return std::nullopt;
  Eigen::Vector3d certain = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    if (std::abs(errors_(i)) > kCertainSigmas * std::sqrt(covariance_(i, i))) {
      certain(i) = std::clamp(errors_(i), -parameters_.max_correction, parameters_.max_correction);
    }
  }
  if (certain.isZero()) return std::nullopt;
  return WheelErrors{certain(0), certain(1), certain(2)};
}

Eigen::Vector3d corrected(const Eigen::Vector3d& increment,
                          const WheelErrors& errors,
                          double wheel_separation_m) {
  const double left_m =
      (1.0 + errors.left) * (increment.x() - wheel_separation_m * increment.z() / 2.0);
  const double right_m =
      (1.0 + errors.right) * (increment.x() + wheel_separation_m * increment.z() / 2.0);
  return {(left_m + right_m) / 2.0, increment.y(),
          (right_m - left_m) / (wheel_separation_m * (1.0 + errors.separation))};
}

}  // namespace ramscout_kinematics
