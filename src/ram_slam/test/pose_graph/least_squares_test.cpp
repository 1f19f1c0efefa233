// SPDX-License-Identifier: BSD-3-Clause
#include "../../src/pose_graph/least_squares.hpp"

#include <array>
#include <limits>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// a x + b y - c
struct LineError {
  double a, b, c;

  template <typename T>
  bool operator()(const T* const point, T* residual) const {
    residual[0] = a * point[0] + b * point[1] - c;
    return true;
  }
};

void add(ceres::Problem& problem, const LineError& error, std::array<double, 2>& point) {
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<LineError, 1, 2>(new LineError(error)),
                           nullptr, point.data());
}

TEST(SolveLeastSquares, FindsThePointOfLeastSquaredDistancesAndReturnsHalfTheirSum) {
  // x = 1, x = 3, y = 2: the least squares are at (2, 2), with a cost of (1 + 1) / 2.
  std::array<double, 2> point{10.0, -7.0};
  ceres::Problem problem;
  add(problem, {1.0, 0.0, 1.0}, point);
  add(problem, {1.0, 0.0, 3.0}, point);
  add(problem, {0.0, 1.0, 2.0}, point);
  EXPECT_NEAR(solveLeastSquares(problem, 20, 1e-12, "not solved"), 1.0, 1e-9);
  EXPECT_NEAR(point[0], 2.0, 1e-6);
  EXPECT_NEAR(point[1], 2.0, 1e-6);
}

TEST(SolveLeastSquares, StartsItsErrorWithTheGivenText) {
  std::array<double, 2> point{0.0, 0.0};
  ceres::Problem problem;
  add(problem, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}, point);
  EXPECT_THAT([&] { solveLeastSquares(problem, 20, 1e-6, "map not solved"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("map not solved: ")));
}

}  // namespace
}  // namespace ram_slam
