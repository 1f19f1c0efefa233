// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/landmark_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <ceres/ceres.h>

#include "../pose_graph/least_squares.hpp"

namespace ram_slam {
namespace {

template <typename T>
using Vector2 = Eigen::Matrix<T, 2, 1>;

/// A vector of the map in the axes of the pose.
template <typename T>
Vector2<T> fromPose(const T* pose, const Vector2<T>& difference) {
  return Eigen::Rotation2D<T>(-pose[2]) * difference;
}

template <typename Matrix>
Matrix rootOfInverse(const Matrix& covariance) {
  return Matrix(covariance.inverse()).llt().matrixU();
}

/// Measured motion between two poses.
class MotionError {
public:
  explicit MotionError(const PoseWithCovariance2& motion)
      : motion_(motion.pose), root_(rootOfInverse(motion.covariance)) {}

  template <typename T>
  bool operator()(const T* from, const T* to, T* residual) const {
    const Vector2<T> moved = fromPose(from, Vector2<T>(to[0] - from[0], to[1] - from[1]));
    const T turn = to[2] - from[2] - motion_.yaw_rad;
    const Eigen::Matrix<T, 3, 1> error(moved.x() - motion_.x_m, moved.y() - motion_.y_m,
                                       atan2(sin(turn), cos(turn)));
    Eigen::Map<Eigen::Matrix<T, 3, 1>>{residual} = root_.cast<T>() * error;
    return true;
  }

private:
  Pose2 motion_;
  Eigen::Matrix3d root_;
};

/// A landmark measured from a pose.
class FeatureError {
public:
  explicit FeatureError(const PointMeasurement& measured)
      : position_m_(measured.position_m), root_(rootOfInverse(measured.covariance_m2)) {}

  template <typename T>
  bool operator()(const T* pose, const T* landmark, T* residual) const {
    const Vector2<T> seen =
        fromPose(pose, Vector2<T>(landmark[0] - pose[0], landmark[1] - pose[1]));
    Eigen::Map<Vector2<T>>{residual} = root_.cast<T>() * (seen - position_m_.cast<T>());
    return true;
  }

private:
  Eigen::Vector2d position_m_;
  Eigen::Matrix2d root_;
};

/// Motions, and features that are paired.
void fill(ceres::Problem& least_squares,
          LandmarkProblem& problem,
          const LandmarkSmootherParameters& parameters) {
  for (std::size_t i = 0; i < problem.motions.size(); ++i) {
    least_squares.AddResidualBlock(
        new ceres::AutoDiffCostFunction<MotionError, 3, 3, 3>(new MotionError(problem.motions[i])),
        nullptr, problem.poses[i].data(), problem.poses[i + 1].data());
  }
  for (const FeatureReading& reading : problem.readings) {
    if (!reading.isPaired()) continue;
    auto* const kernel =
        new ceres::ScaledLoss(new ceres::CauchyLoss(std::sqrt(parameters.robust_chi2)),
                              parameters.reading_share, ceres::TAKE_OWNERSHIP);
    least_squares.AddResidualBlock(
        new ceres::AutoDiffCostFunction<FeatureError, 2, 3, 2>(new FeatureError(reading.measured)),
        kernel, problem.poses[reading.pose].data(),
        problem.landmarks[reading.landmark].mean_m.data());
  }
  least_squares.AddParameterBlock(problem.poses.front().data(), 3);
  least_squares.SetParameterBlockConstant(problem.poses.front().data());
}

/// J^T J over all poses but the first, and the paired landmarks behind them.
Eigen::SparseMatrix<double> informationMatrix(LandmarkProblem& problem,
                                              const std::vector<bool>& is_paired,
                                              const LandmarkSmootherParameters& parameters) {
  ceres::Problem least_squares;
  fill(least_squares, problem, parameters);
  ceres::Problem::EvaluateOptions options;
  for (std::size_t i = 1; i < problem.poses.size(); ++i)
    options.parameter_blocks.push_back(problem.poses[i].data());
  for (std::size_t j = 0; j < problem.landmarks.size(); ++j) {
    if (is_paired[j]) options.parameter_blocks.push_back(problem.landmarks[j].mean_m.data());
  }
  ceres::CRSMatrix rows;
  least_squares.Evaluate(options, nullptr, nullptr, nullptr, &rows);
  const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> jacobian(
      rows.num_rows, rows.num_cols, static_cast<Eigen::Index>(rows.values.size()), rows.rows.data(),
      rows.cols.data(), rows.values.data());
  return jacobian.transpose() * jacobian;
}

}  // namespace

void adjust(LandmarkProblem& problem, const LandmarkSmootherParameters& parameters) {
  ceres::Problem least_squares;
  fill(least_squares, problem, parameters);
  problem.cost = solveLeastSquares(least_squares, parameters.max_iterations, parameters.precision,
                                   "landmarks not smoothed");
}

std::vector<bool> pairedLandmarks(const LandmarkProblem& problem) {
  std::vector<bool> is_paired(problem.landmarks.size(), false);
  for (const FeatureReading& reading : problem.readings) {
    if (reading.isPaired()) is_paired[reading.landmark] = true;
  }
  return is_paired;
}

void computeCovariances(LandmarkProblem& problem, const LandmarkSmootherParameters& parameters) {
  const std::vector<bool> is_paired = pairedLandmarks(problem);
  if (std::count(is_paired.begin(), is_paired.end(), true) == 0) return;
  const Eigen::SparseMatrix<double> information = informationMatrix(problem, is_paired, parameters);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(information);
  if (solver.info() != Eigen::Success)
    throw std::runtime_error("landmarks not smoothed: their covariance is singular");
  auto column = static_cast<Eigen::Index>(3 * (problem.poses.size() - 1));
  for (std::size_t j = 0; j < problem.landmarks.size(); ++j) {
    if (!is_paired[j]) continue;
    Eigen::MatrixX2d unit = Eigen::MatrixX2d::Zero(information.rows(), 2);
    unit.middleRows<2>(column).setIdentity();
    const Eigen::MatrixX2d inverse = solver.solve(unit);
    const Eigen::Matrix2d block = inverse.middleRows<2>(column);
    problem.landmarks[j].covariance_m2 = 0.5 * (block + block.transpose());
    column += 2;
  }
}

}  // namespace ram_slam
