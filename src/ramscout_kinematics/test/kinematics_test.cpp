// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/kinematics.hpp"

#include <algorithm>
#include <limits>
#include <thread>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "ram_slam/geometry/random.hpp"
#include "ramscout_kinematics/differential_drive.hpp"

#include "drives.hpp"

namespace ramscout_kinematics {
namespace {

using ram_slam::Pose2;
using ram_slam::PoseWithCovariance2;

class EveryModel : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Kinematics,
                         EveryModel,
                         testing::Values("ackermann", "differential", "holonomic"));

TEST_P(EveryModel, SplittingAnIntervalChangesNothing) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Kinematics kinematics(unlimited(makeDriveModel(GetParam())));
    addAll(kinematics, randomDrive(seed, 2.0, 0.02));
    ram_slam::Random random(seed, 1);
    double times_s[] = {1.9 * random.uniform(), 1.9 * random.uniform(), 1.9 * random.uniform()};
    std::sort(std::begin(times_s), std::end(times_s));
    const auto [a, b, c] = times_s;

    StateWithCovariance start;
    start.state.resize(6);
    start.state << 100.0 * random.gaussian(), 100.0 * random.gaussian(), 0.5, 0.01, -0.02,
        4.0 * random.gaussian();
    Eigen::MatrixXd root(6, 6);
    for (Eigen::Index i = 0; i < root.size(); ++i) root(i) = 0.01 * random.gaussian();
    start.covariance = root * root.transpose();

    const auto whole = kinematics.predictWithCovariance(start, after(a), after(c));
    const auto parts = kinematics.predictWithCovariance(
        kinematics.predictWithCovariance(start, after(a), after(b)), after(b), after(c));
    EXPECT_LE((whole.state - parts.state).norm(), 1e-9);
    expectRelativelyNear(parts.covariance, whole.covariance, 1e-9);
    EXPECT_LE((kinematics.predict(start.state, after(a), after(c)) - whole.state).norm(), 1e-9);
  }
}

TEST(Kinematics, YawGoesOverTheEndOfItsRange) {
  Kinematics kinematics(unlimited(differential(0.4, 1e-4, 1e-4)));
  addAll(kinematics, drive({0.0, 0.0, 2.0}, 10.0, 0.05));  // 20 rad: over +-pi several times
  const Eigen::VectorXd end =
      kinematics.predict(Eigen::Vector3d(1.0, 2.0, 3.0), after(0.0), after(10.0));
  EXPECT_NEAR(end(2), ram_slam::wrapAngle(23.0), 1e-8);
  EXPECT_NEAR(end(0), 1.0, kRoundingOnly);
  const PoseWithCovariance2 motion = kinematics.motion(after(1.0), after(2.0));
  EXPECT_NEAR(motion.pose.yaw_rad, 2.0, 1e-8);
}

TEST(Kinematics, EmptyIntervalIsTheIdentityAndHasNoSpread) {
  Kinematics kinematics(unlimited(differential(0.4, 1e-4, 1e-4)));
  addAll(kinematics, drive({1.0, 0.0, 0.3}, 2.0, 0.02));
  StateWithCovariance start;
  start.state = Eigen::Vector3d(1.0, 2.0, 0.5);
  start.covariance = Eigen::Vector3d(0.1, 0.2, 0.3).asDiagonal();
  const auto end = kinematics.predictWithCovariance(start, after(0.503), after(0.503));
  EXPECT_EQ(end.state, start.state);
  EXPECT_EQ(end.covariance, start.covariance);
  EXPECT_EQ(kinematics.sample(Eigen::MatrixXd(start.state), after(0.503), after(0.503), 9),
            start.state);
}

TEST_P(EveryModel, SamplesHaveMeanAndCovarianceOfThePrediction) {
  Kinematics kinematics(unlimited(makeDriveModel(GetParam())));
  addAll(kinematics, randomDrive(3, 3.0, 0.02));
  const Eigen::Index count = 100000;
  const Eigen::Vector3d start(5.0, -2.0, 0.7);
  const auto predicted =
      kinematics.predictWithCovariance({start, Eigen::Matrix3d::Zero()}, after(0.1), after(2.3));
  const Eigen::MatrixXd samples =
      kinematics.sample(start.replicate(1, count), after(0.1), after(2.3), 12);
  Eigen::MatrixXd errors = samples.colwise() - Eigen::VectorXd(predicted.state);
  errors.row(2) = errors.row(2).unaryExpr(&ram_slam::wrapAngle);
  const Eigen::Vector3d mean = errors.rowwise().mean();
  const Eigen::Matrix3d covariance = errors * errors.transpose() / static_cast<double>(count);
  const Eigen::Matrix3d& expected = predicted.covariance;
  for (int i = 0; i < 3; ++i) {
    EXPECT_LE(std::abs(mean(i)), 3.0 * std::sqrt(expected(i, i) / count));
    for (int j = 0; j < 3; ++j) {
      const double standard_error =
          std::sqrt((expected(i, i) * expected(j, j) + expected(i, j) * expected(i, j)) / count);
      EXPECT_LE(std::abs(covariance(i, j) - expected(i, j)), 3.0 * standard_error) << i << j;
    }
  }
}

TEST(Kinematics, SameSeedGivesTheSameSamplesAndAnotherSeedOthers) {
  Kinematics kinematics(unlimited(differential(0.4, 1e-4, 2e-4)));
  addAll(kinematics, drive({1.0, 0.0, 0.3}, 2.0, 0.02));
  const Eigen::MatrixXd starts = Eigen::MatrixXd::Random(6, 20);
  const auto samples = [&](std::uint64_t seed) {
    return kinematics.sample(starts, after(0.1), after(1.0), seed);
  };
  EXPECT_EQ(samples(1), samples(1));
  EXPECT_NE(samples(1), samples(2));
  // A population answers as its members do.
  EXPECT_EQ(samples(1).leftCols(5),
            kinematics.sample(starts.leftCols(5), after(0.1), after(1.0), 1));
}

TEST(Kinematics, PosesAndStatesAreSampledAlike) {
  Kinematics kinematics(unlimited(differential(0.4, 1e-4, 2e-4)));
  addAll(kinematics, drive({1.0, 0.0, 0.3}, 2.0, 0.02));
  const Pose2 pose{1.0, 2.0, 3.0};
  const Eigen::MatrixXd sampled =
      kinematics.sample(Eigen::MatrixXd(toVector(pose)), after(0.2), after(1.7), 5);
  EXPECT_EQ(toVector(kinematics.sample(std::vector<Pose2>{pose}, after(0.2), after(1.7), 5)[0]),
            sampled.col(0));
}

/// The unscented transform of predict() over the start and of the motion over its noise gives
/// predictWithCovariance().
TEST(Kinematics, UnscentedTransformAgreesWithLinearPropagation) {
  Kinematics kinematics(unlimited(differential(0.4, 1e-5, 2e-5)));
  addAll(kinematics, randomDrive(5, 3.0, 0.02));
  StateWithCovariance start;
  start.state = Eigen::Vector3d(1.0, 2.0, -0.4);
  start.covariance.resize(3, 3);
  start.covariance << 4e-4, 1e-4, 2e-5, 1e-4, 2e-4, 0.0, 2e-5, 0.0, 1e-4;
  const auto linear = kinematics.predictWithCovariance(start, after(0.5), after(2.5));
  const PoseWithCovariance2 motion = kinematics.motion(after(0.5), after(2.5));

  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(6, 6);  // start and motion
  joint.topLeftCorner(3, 3) = start.covariance;
  joint.bottomRightCorner(3, 3) = motion.covariance;
  const Eigen::MatrixXd root = (6.0 * joint).llt().matrixL();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 6; ++i) {
    for (const double sign : {-1.0, 1.0}) {
      const Eigen::VectorXd offset = sign * root.col(i);
      const Pose2 from{start.state(0) + offset(0), start.state(1) + offset(1),
                       start.state(2) + offset(2)};
      const Pose2 by{motion.pose.x_m + offset(3), motion.pose.y_m + offset(4),
                     motion.pose.yaw_rad + offset(5)};
      Eigen::Vector3d error = toVector(from * by) - linear.state;
      error.z() = ram_slam::wrapAngle(error.z());
      spread += error * error.transpose() / 12.0;
    }
  }
  expectRelativelyNear(spread, linear.covariance, 2e-3);
}

TEST(Kinematics, PassesHeightRollAndPitchThroughWithTheirVariances) {
  Kinematics kinematics(unlimited(differential(0.4, 1e-4, 1e-4)));
  addAll(kinematics, drive({1.0, 0.0, 0.3}, 2.0, 0.02));
  StateWithCovariance start;
  start.state.resize(6);
  start.state << 1.0, 2.0, 0.3, 0.04, -0.05, 0.6;
  start.covariance = Eigen::MatrixXd::Identity(6, 6) * 1e-3;
  const auto end = kinematics.predictWithCovariance(start, after(0.0), after(2.0));
  EXPECT_EQ(end.state.segment(2, 3), start.state.segment(2, 3));
  EXPECT_EQ(end.covariance.block(2, 2, 3, 3), start.covariance.block(2, 2, 3, 3));

  const auto planar = kinematics.predictWithCovariance(
      {Eigen::Vector3d(1.0, 2.0, 0.6), Eigen::MatrixXd::Identity(3, 3) * 1e-3}, after(0.0),
      after(2.0));
  const std::vector<int> indices{0, 1, 5};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(end.state(indices[i]), planar.state(i));
    for (int j = 0; j < 3; ++j)
      EXPECT_EQ(end.covariance(indices[i], indices[j]), planar.covariance(i, j));
  }
}

TEST(Kinematics, RefusesStatesThatAreNotOne) {
  Kinematics kinematics(unlimited(differential(0.4, 1e-4, 1e-4)));
  addAll(kinematics, drive({1.0, 0.0, 0.3}, 2.0, 0.02));
  for (const int size : {0, 1, 2, 4, 5, 7, 12}) {
    EXPECT_THROW(kinematics.predict(Eigen::VectorXd::Zero(size), after(0.0), after(1.0)),
                 std::invalid_argument);
  }
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(kinematics.predict(Eigen::Vector3d(0.0, bad, 0.0), after(0.0), after(1.0)),
                 std::invalid_argument);
  }
  EXPECT_THROW(kinematics.predictWithCovariance({Eigen::Vector3d::Zero(), Eigen::Matrix2d::Zero()},
                                                after(0.0), after(1.0)),
               std::invalid_argument);
}

TEST(Kinematics, TakesAYawOfManyTurnsAsTheWrappedOne) {
  Kinematics kinematics(unlimited(differential(0.4, 1e-4, 1e-4)));
  addAll(kinematics, drive({1.0, 0.0, 0.3}, 2.0, 0.02));
  const Eigen::VectorXd many =
      kinematics.predict(Eigen::Vector3d(1.0, 2.0, 1e6), after(0.0), after(1.0));
  const Eigen::VectorXd one = kinematics.predict(
      Eigen::Vector3d(1.0, 2.0, ram_slam::wrapAngle(1e6)), after(0.0), after(1.0));
  EXPECT_EQ(many, one);
  EXPECT_LE(std::abs(many(2)), M_PI);
}

TEST(CheckedCovariance, RepairsRoundingAndRefusesTheRest) {
  Eigen::Matrix3d good = Eigen::Vector3d(1.0, 2.0, 3.0).asDiagonal();
  EXPECT_EQ(checkedCovariance(good), good);
  EXPECT_EQ(checkedCovariance(Eigen::Matrix3d::Zero()), Eigen::Matrix3d::Zero());

  Eigen::Matrix3d nearly_symmetric = good;
  nearly_symmetric(0, 1) = 1e-4;
  EXPECT_EQ(checkedCovariance(nearly_symmetric)(1, 0), 0.5e-4);
  Eigen::Matrix3d asymmetric = good;
  asymmetric(0, 1) = 1e-2;
  EXPECT_THROW(checkedCovariance(asymmetric), std::invalid_argument);

  Eigen::Matrix3d nearly_positive = good;
  nearly_positive(0, 0) = -1e-7;
  EXPECT_NEAR(checkedCovariance(nearly_positive)(0, 0), 0.0, kRoundingOnly);
  Eigen::Matrix3d negative = good;
  negative(0, 0) = -1e-3;
  EXPECT_THROW(checkedCovariance(negative), std::invalid_argument);
  Eigen::Matrix3d infinite = good;
  infinite(2, 2) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(checkedCovariance(infinite), std::invalid_argument);
}

/// Odometry with jumps, resets, repetitions, gaps, disorder and clocks set back, as bad as random
/// numbers make it.
TEST(Kinematics, AnswersNothingThatIsNotFiniteWhateverOdometryBrings) {
  int answers = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    ram_slam::Random random(seed);
    Kinematics kinematics{KinematicsParameters()};
    double time_s = 20.0;
    Pose2 pose;
    for (int i = 0; i < 300; ++i) {
      const double fate = random.uniform();
      time_s += fate < 0.02 ? 20.0 * random.uniform() - 10.0 : 0.05 * (random.uniform() - 0.2);
      if (fate > 0.9)
        pose = pose * Pose2{random.gaussian() * std::exp(10.0 * random.gaussian()), 0.0,
                            random.gaussian()};
      if (fate > 0.99) pose = {1e300, -1e300, 1e9};
      if (fate > 0.98 && fate < 0.99) pose = {};
      kinematics.add({after(time_s), pose, {random.gaussian(), 0.0, random.gaussian()}});
      const double from_s = time_s - 2.0 * random.uniform();
      try {
        const PoseWithCovariance2 motion =
            kinematics.motion(after(from_s), after(from_s + 1.5 * random.uniform()));
        ++answers;
        EXPECT_TRUE(motion.pose.isFinite());
        EXPECT_TRUE(motion.covariance.allFinite());
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(motion.covariance);
        EXPECT_GE(eigen.eigenvalues().minCoeff(), -1e-9 * motion.covariance.trace());
      } catch (const OdometryUnavailable&) {
        continue;
      }
    }
  }
  EXPECT_GT(answers, 10000);
}

TEST(Kinematics, AnswersWhileOdometryIsAdded) {
  Kinematics kinematics{KinematicsParameters()};
  const auto samples = drive({1.0, 0.0, 0.3}, 20.0, 0.01);
  const auto half = samples.begin() + 1000;
  addAll(kinematics, {samples.begin(), half});
  std::thread adder([&] { addAll(kinematics, {half, samples.end()}); });
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t to_ns = kinematics.newestNs();
    expectNear(kinematics.motion(to_ns - 1'000'000'000, to_ns).pose,
               ram_slam::exponential(Eigen::Vector3d(1.0, 0.0, 0.3)), 1e-6);
  }
  adder.join();
}

}  // namespace
}  // namespace ramscout_kinematics
