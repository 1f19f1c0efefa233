// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

#include <ceres/ceres.h>

namespace ram_slam {

/// Sparse nonlinear least squares on one thread; the parameters are left where the cost is least.
/// \param function_tolerance  relative change of the cost at which it ends
/// \return the cost: half the sum of squares, kernels applied
/// \throws std::runtime_error, beginning with `failure`, if there is no usable solution
inline double solveLeastSquares(ceres::Problem& problem,
                                int max_iterations,
                                double function_tolerance,
                                const std::string& failure) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  // As fast as SuiteSparse at this size, and without the threads of its BLAS.
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.max_num_iterations = max_iterations;
  options.num_threads = 1;
  options.function_tolerance = function_tolerance;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) throw std::runtime_error(failure + ": " + summary.message);
  return summary.final_cost;
}

}  // namespace ram_slam
