// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/kinematics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <sstream>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "ram_slam/geometry/random.hpp"

namespace ramscout_kinematics {
namespace {

using ram_slam::Pose2;
using ram_slam::PoseWithCovariance2;

/// Longest turn over which the noise is integrated by one set of Gauss-Legendre points; keeps the
/// error below 1e-10.
constexpr double kQuadratureStepRad = 0.1;
/// Relative to the largest entry: matrices that went through a few operations in single precision
/// (1e-7 each) are symmetric to far better than this.
constexpr double kSymmetryTolerance = 1e-4;
/// Relative to the trace: what rounding an entry to single precision moves eigenvalues by,
/// times 10.
constexpr double kEigenvalueTolerance = 1e-6;

/// Gauss-Legendre quadrature on [0, 1], exact up to degree 5.
struct QuadraturePoint {
  double position;
  double weight;
};
const std::array<QuadraturePoint, 3> kQuadrature = {
    {{0.5 - std::sqrt(0.15), 5.0 / 18.0}, {0.5, 8.0 / 18.0}, {0.5 + std::sqrt(0.15), 5.0 / 18.0}}};

/// What an error of the motion at `start_from_here`, in the axes of `here`, is at the end of the
/// path: G = [[cos, -sin, -(y_end - y)], [sin, cos, x_end - x], [0, 0, 1]].
Eigen::Matrix3d errorAtEnd(const Pose2& start_from_here, const Pose2& start_from_end) {
  Eigen::Matrix3d g = start_from_here.axesRotation();
  g(0, 2) = start_from_here.y_m - start_from_end.y_m;
  g(1, 2) = start_from_end.x_m - start_from_here.x_m;
  return g;
}

/// Q = integral of G noise G^T along the path of constant twist.
Eigen::Matrix3d carryAlong(const Eigen::Vector3d& increment, const Eigen::Matrix3d& noise) {
  const Pose2 start_from_end = ram_slam::exponential(increment);
  const int steps =
      std::max(1, static_cast<int>(std::ceil(std::abs(increment.z()) / kQuadratureStepRad)));
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int step = 0; step < steps; ++step) {
    for (const QuadraturePoint& point : kQuadrature) {
      const Pose2 start_from_here =
          ram_slam::exponential((step + point.position) / steps * increment);
      const Eigen::Matrix3d g = errorAtEnd(start_from_here, start_from_end);
      covariance += point.weight / steps * (g * noise * g.transpose());
    }
  }
  return covariance;
}

/// F with L = F sqrt(D): a covariance's factor, so that F times standard normal numbers has that
/// covariance.
Eigen::Matrix3d factor(const Eigen::Matrix3d& covariance) {
  const auto ldlt = covariance.ldlt();
  const Eigen::Matrix3d lower = ldlt.matrixL();
  return ldlt.transpositionsP().transpose() *
         Eigen::Matrix3d(lower * ldlt.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal());
}

/// Draws poses from N(motion, covariance).
class MotionSampler {
public:
  MotionSampler(const PoseWithCovariance2& motion, std::uint64_t seed)
      : motion_(motion.pose), factor_(factor(motion.covariance)), seed_(seed) {}

  Pose2 operator()(const Pose2& world_from_start, std::size_t index) const {
    ram_slam::Random random(seed_, index);
    const double first = random.gaussian();
    const double second = random.gaussian();
    const Eigen::Vector3d error = factor_ * Eigen::Vector3d(first, second, random.gaussian());
    return world_from_start *
           Pose2{motion_.x_m + error.x(), motion_.y_m + error.y(), motion_.yaw_rad + error.z()};
  }

private:
  Pose2 motion_;
  Eigen::Matrix3d factor_;
  std::uint64_t seed_;
};

/// Where x, y and yaw are in a state of n numbers.
std::array<Eigen::Index, 3> planarIndices(Eigen::Index size) {
  return {0, 1, size - 1};
}

void checkState(const Eigen::Ref<const Eigen::MatrixXd>& states) {
  if (!isStateSize(static_cast<std::size_t>(states.rows()))) {
    throw std::invalid_argument("a state has 3 or 6 numbers, got " + std::to_string(states.rows()));
  }
  if (!states.allFinite()) throw std::invalid_argument("state is not finite");
}

Pose2 planarPart(const Eigen::Ref<const Eigen::VectorXd>& state) {
  return {state(0), state(1), ram_slam::wrapAngle(state(state.size() - 1))};
}

void setPlanarPart(Eigen::Ref<Eigen::VectorXd> state, const Pose2& pose) {
  state(0) = pose.x_m;
  state(1) = pose.y_m;
  state(state.size() - 1) = pose.yaw_rad;
}

}  // namespace

Kinematics::Kinematics(const KinematicsParameters& parameters)
    : parameters_(parameters), buffer_(parameters.buffer) {
  parameters_.validate();
}

Added Kinematics::add(const OdometrySample& sample) {
  const std::unique_lock lock(mutex_);
  return buffer_.add(sample);
}

std::int64_t Kinematics::oldestNs() const {
  const std::shared_lock lock(mutex_);
  return buffer_.oldestNs();
}

std::int64_t Kinematics::newestNs() const {
  const std::shared_lock lock(mutex_);
  return buffer_.newestNs();
}

PoseWithCovariance2 Kinematics::motion(std::int64_t from_ns, std::int64_t to_ns) const {
  std::vector<MotionSegment> segments;
  {
    const std::shared_lock lock(mutex_);
    segments = buffer_.segments(from_ns, to_ns);
  }
  PoseWithCovariance2 motion;
  for (const MotionSegment& segment : segments) motion = motion * motionAlong(segment);
  return motion;
}

PoseWithCovariance2 Kinematics::motionAlong(const MotionSegment& segment) const {
  Eigen::Matrix3d noise = parameters_.noise_factor * segment.noise_factor *
                          parameters_.drive_model->noise(segment.increment);
  noise.diagonal() += segment.added_variance;
  const Eigen::Vector3d moved = segment.increment.cwiseAbs();
  if (moved.head<2>().maxCoeff() < parameters_.standing_speed_mps * segment.duration_s &&
      moved.z() < parameters_.standing_turn_rate_radps * segment.duration_s) {
    const double variance_m2 = std::pow(parameters_.standing_sigma_m, 2) * segment.duration_s;
    const double variance_rad2 = std::pow(parameters_.standing_sigma_rad, 2) * segment.duration_s;
    noise.diagonal() += Eigen::Vector3d(variance_m2, variance_m2, variance_rad2);
  }
  PoseWithCovariance2 motion;
  motion.pose = ram_slam::exponential(segment.increment);
  motion.covariance = carryAlong(segment.increment, noise);
  return motion;
}

std::vector<Pose2> Kinematics::sample(const std::vector<Pose2>& map_from_base,
                                      std::int64_t from_ns,
                                      std::int64_t to_ns,
                                      std::uint64_t seed) const {
  const MotionSampler sampler(motion(from_ns, to_ns), seed);
  std::vector<Pose2> samples;
  samples.reserve(map_from_base.size());
  for (const Pose2& pose : map_from_base) samples.push_back(sampler(pose, samples.size()));
  return samples;
}

Eigen::VectorXd Kinematics::predict(const Eigen::VectorXd& state,
                                    std::int64_t from_ns,
                                    std::int64_t to_ns) const {
  checkState(state);
  Eigen::VectorXd moved = state;
  setPlanarPart(moved, planarPart(state) * motion(from_ns, to_ns).pose);
  return moved;
}

StateWithCovariance Kinematics::predictWithCovariance(const StateWithCovariance& start,
                                                      std::int64_t from_ns,
                                                      std::int64_t to_ns) const {
  checkState(start.state);
  const Eigen::Index size = start.state.size();
  if (start.covariance.rows() != size || start.covariance.cols() != size) {
    throw std::invalid_argument("the covariance of a state of " + std::to_string(size) +
                                " numbers is " + std::to_string(size) + " x " +
                                std::to_string(size));
  }
  const PoseWithCovariance2 motion = this->motion(from_ns, to_ns);
  const Pose2 before = planarPart(start.state);
  const Pose2 after = before * motion.pose;
  StateWithCovariance end = start;
  setPlanarPart(end.state, after);

  // Moving turns with the yaw: F. The motion's own noise is in the axes of the base at the start:
  // rotate it.
  Eigen::MatrixXd f = Eigen::MatrixXd::Identity(size, size);
  f(0, size - 1) = before.y_m - after.y_m;
  f(1, size - 1) = after.x_m - before.x_m;
  end.covariance = f * start.covariance * f.transpose();
  const Eigen::Matrix3d rotation = before.axesRotation();
  const Eigen::Matrix3d noise = rotation * motion.covariance * rotation.transpose();
  const auto planar = planarIndices(size);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      end.covariance(planar[row], planar[column]) +=
          noise(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
    }
  }
  return end;
}

Eigen::MatrixXd Kinematics::sample(const Eigen::MatrixXd& states,
                                   std::int64_t from_ns,
                                   std::int64_t to_ns,
                                   std::uint64_t seed) const {
  checkState(states);
  const MotionSampler sampler(motion(from_ns, to_ns), seed);
  Eigen::MatrixXd samples = states;
  for (Eigen::Index i = 0; i < states.cols(); ++i) {
    setPlanarPart(samples.col(i), sampler(planarPart(states.col(i)), static_cast<std::size_t>(i)));
  }
  return samples;
}

bool isStateSize(std::size_t size) {
  return size == 3 || size == 6;
}

Eigen::MatrixXd checkedCovariance(const Eigen::MatrixXd& covariance) {
  if (!covariance.allFinite()) throw std::invalid_argument("covariance is not finite");
  const double largest = covariance.cwiseAbs().maxCoeff();
  const double asymmetry = (covariance - covariance.transpose()).cwiseAbs().maxCoeff();
  if (asymmetry > kSymmetryTolerance * largest) {
    throw std::invalid_argument("covariance is not symmetric");
  }
  const Eigen::MatrixXd symmetric = 0.5 * (covariance + covariance.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric);
  const double smallest = eigen.eigenvalues().minCoeff();
  if (smallest >= 0.0) return symmetric;
  if (smallest < -kEigenvalueTolerance * symmetric.trace()) {
    throw std::invalid_argument("covariance is not positive semi-definite: it has the eigenvalue " +
                                std::to_string(smallest));
  }
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

}  // namespace ramscout_kinematics
