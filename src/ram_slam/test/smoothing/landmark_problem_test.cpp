// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/landmark_problem.hpp"

#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>

#include "rest_problem.hpp"

namespace ram_slam {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

TEST(LandmarkProblem, HasAPosePerStampAndAReadingPerFeature) {
  RestProblem rest({{pole({1.0, 0.0}, 0.1)}, {pole({2.0, 0.0}, 0.1), pole({3.0, 0.0}, 0.1)}, {}});
  rest.landmarks = {poleAt(4, {0.0, 0.0}), poleAt(7, {0.0, 0.0})};
  const LandmarkProblem problem = rest.make();
  EXPECT_THAT(problem.poses, SizeIs(3));
  EXPECT_THAT(problem.motions, SizeIs(2));
  ASSERT_THAT(problem.readings, SizeIs(3));
  EXPECT_EQ(problem.readings[0].pose, 0U);
  EXPECT_EQ(problem.readings[2].pose, 1U);
  EXPECT_EQ(problem.readings[2].measured.position_m.x(), 3.0);
  EXPECT_FALSE(problem.readings[0].isPaired());
  EXPECT_EQ(problem.next_id, 8);
}

TEST(LandmarkProblem, ListsOfOneStampShareAPose) {
  RestProblem rest({{pole({1.0, 0.0}, 0.1)}, {pole({2.0, 0.0}, 0.1)}});
  rest.steps[1].list.stamp_ns = 1;
  const LandmarkProblem problem = rest.make();
  EXPECT_THAT(problem.poses, SizeIs(1));
  EXPECT_THAT(problem.motions, IsEmpty());
  EXPECT_EQ(problem.readings[1].pose, 0U);
}

TEST(LandmarkProblem, AddsTheDeviationAtRestToTheOdometrys) {
  RestProblem rest({{}, {}});
  rest.parameters.rest_deviation_m = 0.5;
  rest.parameters.rest_deviation_rad = 0.25;
  rest.steps[1].motion.covariance = Eigen::Matrix3d::Identity();
  const Eigen::Vector3d variances = rest.make().motions[0].covariance.diagonal();
  EXPECT_TRUE(variances.isApprox(Eigen::Vector3d(1.25, 1.25, 1.0625)));
}

TEST(LandmarkProblem, RefusesAFeatureWhoseCovarianceIsNotPositiveDefinite) {
  Feature flat = pole({1.0, 0.0}, 0.1);
  flat.covariance_m2(1, 1) = 0.0;
  EXPECT_THAT([&] { RestProblem({{flat}}).make(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("positive definite")));
  Feature nowhere = pole({std::numeric_limits<double>::infinity(), 0.0}, 0.1);
  EXPECT_THROW(RestProblem({{nowhere}}).make(), std::invalid_argument);
}

TEST(LandmarkProblem, RefusesStepsOutOfOrder) {
  RestProblem rest({{}, {}});
  rest.steps[1].list.stamp_ns = 0;
  EXPECT_THAT(
      [&] {
        makeLandmarkProblem(rest.steps, {{0, {}}, {1, {}}}, {}, rest.parameters);
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("come after those of 1 ns")));
}

}  // namespace
}  // namespace ram_slam
