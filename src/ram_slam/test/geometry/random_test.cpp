// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/geometry/random.hpp"

#include <cmath>
#include <set>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

TEST(RandomStream, GivesTheSameNumbersForTheSameKey) {
  Random a(7, 3, 5);
  Random b(7, 3, 5);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a(), b());
}

TEST(RandomStream, DiffersInItsFirstNumberForEveryKey) {
  std::set<std::uint64_t> first;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    for (std::uint64_t i = 0; i < 10; ++i) {
      for (std::uint64_t j = 0; j < 10; ++j) first.insert(Random(seed, i, j)());
    }
  }
  EXPECT_EQ(first.size(), 1000U);
}

TEST(RandomStream, UniformNumbersHaveMeanOneHalfAndVarianceOneTwelfth) {
  constexpr int kCount = 100000;
  Random random(1);
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double value = random.uniform();
    ASSERT_GE(value, 0.0);
    ASSERT_LT(value, 1.0);
    sum += value;
    squares += (value - 0.5) * (value - 0.5);
  }
  // Four standard deviations of both estimates.
  EXPECT_NEAR(sum / kCount, 0.5, 4.0 * std::sqrt(1.0 / 12.0 / kCount));
  EXPECT_NEAR(squares / kCount, 1.0 / 12.0, 4.0 * std::sqrt(1.0 / 180.0 / kCount));
}

TEST(RandomStream, GaussianNumbersHaveTheMomentsOfANormalDistribution) {
  constexpr int kCount = 100000;
  Random random(2);
  double sum = 0.0;
  double squares = 0.0;
  double fourth = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double value = random.gaussian();
    sum += value;
    squares += value * value;
    fourth += std::pow(value, 4);
  }
  EXPECT_NEAR(sum / kCount, 0.0, 4.0 / std::sqrt(kCount));
  EXPECT_NEAR(squares / kCount, 1.0, 4.0 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(fourth / kCount, 3.0, 4.0 * std::sqrt(96.0 / kCount));
}

TEST(RandomStream, VectorsStayInThePlaneOfASingularCovariance) {
  // x = y always, z never moves.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  covariance.topLeftCorner<2, 2>().setConstant(0.25);
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d value = random.gaussian(covariance);
    EXPECT_NEAR(value.x(), value.y(), 1e-12);
    EXPECT_EQ(value.z(), 0.0);
  }
}

}  // namespace
}  // namespace ram_slam
