// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ekf_slam/joint_belief.hpp"

#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

PointMeasurement seenAt(double x_m, double y_m, double variance_m2 = 0.01) {
  return {{x_m, y_m}, variance_m2 * Eigen::Matrix2d::Identity()};
}

PoseWithCovariance2 step(const Pose2& motion, const Eigen::Vector3d& variances) {
  return {motion, variances.asDiagonal()};
}

/// All coordinates: x, y, yaw, then the landmarks.
Eigen::VectorXd coordinates(const JointBelief& belief) {
  Eigen::VectorXd all(3 + 2 * belief.size());
  all.head<3>() << belief.pose().x_m, belief.pose().y_m, belief.pose().yaw_rad;
  for (std::size_t i = 0; i < belief.size(); ++i)
    all.segment<2>(3 + 2 * static_cast<Eigen::Index>(i)) = belief.point_m(i);
  return all;
}

/// Covariance of the landmarks' coordinates.
Eigen::MatrixXd landmarkCovariance(const JointBelief& belief) {
  const auto count = static_cast<Eigen::Index>(belief.size());
  Eigen::MatrixXd all(2 * count, 2 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      all.block<2, 2>(2 * i, 2 * j) =
          belief.crossCovariance(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
    }
  }
  return all;
}

/// A belief with a history: turned, far from the origin, everything correlated.
JointBelief wornBelief() {
  JointBelief belief({{3.0, -2.0, 0.7}, Eigen::Vector3d(0.01, 0.02, 0.003).asDiagonal()});
  belief.add(seenAt(4.0, 1.0));
  belief.move(step({1.0, 0.2, 0.4}, {0.01, 0.004, 0.002}));
  belief.add(seenAt(2.0, -3.0));
  belief.correct({{0, seenAt(3.0, 0.1)}});
  belief.move(step({0.5, 0.0, -0.9}, {0.003, 0.002, 0.004}));
  return belief;
}

TEST(JointBelief, GivesThePoseAsItTookIt) {
  const PoseWithCovariance2 pose{{5.0, -7.0, 2.0}, [] {
                                   Eigen::Matrix3d c;
                                   c << 0.4, 0.1, -0.05, 0.1, 0.3, 0.02, -0.05, 0.02, 0.04;
                                   return c;
                                 }()};
  JointBelief belief = wornBelief();
  const Eigen::MatrixXd landmarks = landmarkCovariance(belief);
  belief.setPose(pose);
  EXPECT_NEAR((belief.poseWithCovariance().covariance - pose.covariance).norm(), 0.0, 1e-12);
  EXPECT_NEAR((landmarkCovariance(belief) - landmarks).norm(), 0.0, 1e-12) << "as they were";
}

TEST(JointBelief, MovesThePoseAsComposedPosesMove) {
  const PoseWithCovariance2 start{{3.0, -2.0, 0.7},
                                  Eigen::Vector3d(0.01, 0.02, 0.003).asDiagonal()};
  const PoseWithCovariance2 motion = step({1.0, 0.2, 0.4}, {0.01, 0.004, 0.002});
  JointBelief belief(start);
  belief.move(motion);
  const PoseWithCovariance2 wanted = start * motion;
  EXPECT_NEAR((belief.poseWithCovariance().covariance - wanted.covariance).norm(), 0.0, 1e-12);
  EXPECT_NEAR(belief.pose().y_m, wanted.pose.y_m, 1e-12);
}

TEST(JointBelief, PlacesANewLandmarkWithTheUncertaintyOfThePose) {
  const PoseWithCovariance2 pose{{3.0, -2.0, 0.7}, Eigen::Vector3d(0.01, 0.02, 0.003).asDiagonal()};
  JointBelief belief(pose);
  belief.add(seenAt(4.0, 1.0, 0.05));
  const PoseWithCovariance2 there =
      pose * PoseWithCovariance2{{4.0, 1.0, 0.0}, Eigen::Matrix3d::Zero()};
  EXPECT_NEAR((belief.landmark(0).covariance_m2 - there.covariance.topLeftCorner<2, 2>() -
               0.05 * Eigen::Matrix2d::Identity())
                  .norm(),
              0.0, 1e-12);
}

/// Standing still and knowing the yaw everything is linear: the filter is the Kalman filter, and
/// that the least squares solution of all measurements at once.
TEST(JointBelief, EqualsLeastSquaresWhereEverythingIsLinear) {
  JointBelief belief;
  const std::vector<Eigen::Vector2d> truth_m{{2.0, 1.0}, {3.0, -1.0}};
  // Unknowns: positions after each of the steps, then the landmarks.
  const int steps = 6;
  const Eigen::Index size = 2 * steps + 4;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd vector = Eigen::VectorXd::Zero(size);
  const auto addDifference = [&](Eigen::Index to, Eigen::Index from, const Eigen::Vector2d& d_m,
                                 double variance_m2) {
    Eigen::MatrixXd by = Eigen::MatrixXd::Zero(2, size);
    by.middleCols<2>(to).setIdentity();
    if (from >= 0) by.middleCols<2>(from) -= Eigen::Matrix2d::Identity();
    information += by.transpose() * by / variance_m2;
    vector += by.transpose() * d_m / variance_m2;
  };
  Random random(3);
  for (int k = 0; k < steps; ++k) {
    const Eigen::Vector2d moved_m(0.3 + 0.01 * random.gaussian(), 0.02 * random.gaussian());
    belief.move(step({moved_m.x(), moved_m.y(), 0.0}, {0.004, 0.004, 0.0}));
    addDifference(2 * k, k == 0 ? -1 : 2 * (k - 1), moved_m, 0.004);
    const Eigen::Vector2d here_m(0.3 * (k + 1), 0.0);
    for (std::size_t i = 0; i < truth_m.size(); ++i) {
      const Eigen::Vector2d seen_m =
          truth_m[i] - here_m + 0.1 * Eigen::Vector2d(random.gaussian(), random.gaussian());
      if (k == 0) {
        belief.add(seenAt(seen_m.x(), seen_m.y()));
      } else {
        belief.correct({{i, seenAt(seen_m.x(), seen_m.y())}});
      }
      addDifference(2 * steps + 2 * static_cast<Eigen::Index>(i), 2 * k, seen_m, 0.01);
    }
  }
  const Eigen::VectorXd best = information.ldlt().solve(vector);
  const Eigen::MatrixXd covariance = information.inverse();
  EXPECT_NEAR((belief.pose().translation() - best.segment<2>(2 * (steps - 1))).norm(), 0.0, 1e-9);
  EXPECT_NEAR((belief.point_m(1) - best.segment<2>(2 * steps + 2)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(
      (belief.crossCovariance(0, 1) - covariance.block<2, 2>(2 * steps, 2 * steps + 2)).norm(), 0.0,
      1e-9);
}

TEST(JointBelief, PredictsTheCovarianceOfAnInnovation) {
  const JointBelief belief = wornBelief();
  // Central differences of the expected measurement by all coordinates.
  const Eigen::VectorXd at = coordinates(belief);
  const auto expected = [&](const Eigen::VectorXd& x) {
    return Eigen::Vector2d(Pose2{x(0), x(1), x(2)}.inverse() * Eigen::Vector2d(x.segment<2>(5)));
  };
  Eigen::MatrixXd by(2, at.size());
  for (Eigen::Index k = 0; k < at.size(); ++k) {
    Eigen::VectorXd more = at, less = at;
    more(k) += 1e-6;
    less(k) -= 1e-6;
    by.col(k) = (expected(more) - expected(less)) / 2e-6;
  }
  // The joint covariance of the coordinates, by shifting each landmark's covariance out: of the
  // pose alone it is known, of pose and landmark it follows from a landmark placed on the robot.
  JointBelief marked = belief;
  marked.add({Eigen::Vector2d::Zero(), Eigen::Matrix2d::Zero()});
  marked.add({{1.0, 0.0}, Eigen::Matrix2d::Zero()});
  Eigen::Matrix<double, 7, 7> joint = Eigen::Matrix<double, 7, 7>::Zero();
  joint.topLeftCorner<3, 3>() = belief.poseWithCovariance().covariance;
  joint.bottomRightCorner<4, 4>() = landmarkCovariance(belief);
  const Eigen::Vector2d side(-std::sin(belief.pose().yaw_rad), std::cos(belief.pose().yaw_rad));
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Index row = 3 + 2 * static_cast<Eigen::Index>(i);
    joint.block<2, 2>(0, row) = marked.crossCovariance(2, i);
    joint.block<1, 2>(2, row) =
        side.transpose() * (marked.crossCovariance(3, i) - marked.crossCovariance(2, i));
    joint.block<2, 3>(row, 0) = joint.block<3, 2>(0, row).transpose();
  }
  const Innovation found = belief.innovation({1, seenAt(1.0, 1.0, 0.02)});
  EXPECT_NEAR(
      (found.covariance_m2 - by * joint * by.transpose() - 0.02 * Eigen::Matrix2d::Identity())
          .norm(),
      0.0, 1e-6);
}

TEST(JointBelief, LearnsNothingAboutTheHeadingOfTheWholeFromLandmarks) {
  JointBelief belief = wornBelief();
  const double before = [&] {
    JointBelief far = belief;
    far.movePose(belief.pose().inverse());  // the error of the yaw alone
    return far.poseWithCovariance().covariance(2, 2);
  }();
  // The turn of the line from one landmark to the other, which a robot at rest cannot learn either.
  const auto turn = [](const JointBelief& b) {
    const Eigen::Vector2d line = b.point_m(1) - b.point_m(0);
    const Eigen::Vector2d side = Eigen::Vector2d(-line.y(), line.x()).normalized();
    const Eigen::Matrix2d c = b.crossCovariance(0, 0) + b.crossCovariance(1, 1) -
                              b.crossCovariance(0, 1) - b.crossCovariance(1, 0);
    return side.dot(c * side) / line.squaredNorm();
  };
  EXPECT_GT(turn(belief), 0.0);
  Random random(4);
  for (int k = 0; k < 1000; ++k) {
    std::vector<JointBelief::Sighting> sightings;
    for (std::size_t i = 0; i < 2; ++i) {
      const Eigen::Vector2d seen_m = belief.pose().inverse() * belief.point_m(i);
      sightings.push_back(
          {i, seenAt(seen_m.x() + 0.1 * random.gaussian(), seen_m.y() + 0.1 * random.gaussian())});
    }
    belief.correct(sightings);
  }
  // Robot and landmarks agree ever better, but all of them together may be turned as before: by the
  // initial yaw's variance at least.
  EXPECT_GE(turn(belief), 0.003 * (1.0 - 1e-6));
  EXPECT_GE(belief.poseWithCovariance().covariance(2, 2), 0.003 * (1.0 - 1e-6));
  EXPECT_LE(belief.poseWithCovariance().covariance(2, 2), before);
}

TEST(JointBelief, KeepsWhatIsLeftWhenLandmarksGo) {
  JointBelief belief = wornBelief();
  belief.add(seenAt(1.0, 1.0));
  const Eigen::Matrix2d kept = belief.crossCovariance(0, 2);
  belief.remove({1});
  ASSERT_EQ(belief.size(), 2u);
  EXPECT_NEAR((belief.crossCovariance(0, 1) - kept).norm(), 0.0, 1e-15);
}

TEST(JointBelief, TakesOverLandmarksWithTheirCovariance) {
  JointBelief belief = wornBelief();
  Eigen::Matrix4d covariance = 0.2 * Eigen::Matrix4d::Identity();
  covariance(0, 2) = covariance(2, 0) = 0.1;
  belief.add({{9.0, 9.0}, {8.0, 1.0}}, covariance);
  EXPECT_NEAR((landmarkCovariance(belief).bottomRightCorner<4, 4>() - covariance).norm(), 0.0,
              1e-12);
  EXPECT_NEAR(belief.crossCovariance(0, 2).norm(), 0.0, 1e-12) << "independent of the others";
}

TEST(JointBelief, MovesPoseAndLandmarksRigidly) {
  JointBelief belief = wornBelief();
  const PoseWithCovariance2 before = belief.poseWithCovariance();
  const Landmark landmark = belief.landmark(1);
  const Pose2 move{1.0, -0.5, 0.3};
  const PoseWithCovariance2 wanted = PoseWithCovariance2{move, Eigen::Matrix3d::Zero()} * before;
  belief.movePose(move);
  EXPECT_NEAR((belief.poseWithCovariance().covariance - wanted.covariance).norm(), 0.0, 1e-12);
  EXPECT_NEAR((belief.landmark(1).covariance_m2 - landmark.covariance_m2).norm(), 0.0, 1e-12);
  belief.movePoints({{}, move});
  EXPECT_NEAR((belief.landmark(1).covariance_m2 -
               move.rotation() * landmark.covariance_m2 * move.rotation().transpose())
                  .norm(),
              0.0, 1e-12);
  EXPECT_NEAR((belief.point_m(1) - move * landmark.mean_m).norm(), 0.0, 1e-12);
  EXPECT_NEAR((belief.poseWithCovariance().covariance - wanted.covariance).norm(), 0.0, 1e-12);
}

TEST(JointBelief, StaysPositiveDefiniteWhateverIsDone) {
  Random random(5);
  JointBelief belief;
  for (int k = 0; k < 300; ++k) {
    belief.move(step({0.2, 0.0, 0.3 * random.gaussian()}, {1e-4, 1e-5, 1e-4}));
    if (belief.size() < 12) belief.add(seenAt(3.0 * random.gaussian(), 3.0 * random.gaussian()));
    if (k % 7 == 0 && belief.size() > 3) belief.remove({1, 2});
    if (k % 11 == 0) belief.movePose({0.01, 0.0, 0.01});
    if (k % 13 == 0) belief.movePoints(std::vector<Pose2>(belief.size(), Pose2{0.1, -0.1, 0.05}));
    const Eigen::Vector2d seen_m = belief.pose().inverse() * belief.point_m(0);
    belief.correct({{0, seenAt(seen_m.x(), seen_m.y() + 0.05, 1e-4)}});
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(landmarkCovariance(belief));
    ASSERT_GE(solver.eigenvalues().minCoeff(), -1e-12 * solver.eigenvalues().maxCoeff());
  }
}

}  // namespace
}  // namespace ram_slam
