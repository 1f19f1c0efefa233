// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ukf_localiser/ukf_localiser.hpp"

#include "../fast_slam/fast_slam_fixtures.hpp"

namespace ram_slam {
namespace {

/// Counts what it is asked for.
class CountingOdometry : public MotionModel {
public:
  explicit CountingOdometry(const MotionModel& model) : model_(model) {}
  PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const override {
    ++motions;
    return model_.motion(from_ns, to_ns);
  }
  std::vector<Pose2> predictEach(const std::vector<Pose2>& map_from_base,
                                 std::int64_t from_ns,
                                 std::int64_t to_ns) const override {
    predicted += map_from_base.size();
    return model_.predictEach(map_from_base, from_ns, to_ns);
  }
  mutable std::size_t motions = 0;
  mutable std::size_t predicted = 0;

private:
  const MotionModel& model_;
};

/// The true landmarks, known to a centimetre.
LandmarkMap trueMap(const SyntheticDrive& drive) {
  LandmarkMap map;
  for (const Eigen::Vector2d& place_m : drive.landmarks_m) {
    LandmarkEstimate landmark;
    landmark.id = static_cast<LandmarkId>(map.landmarks.size());
    landmark.type = "pole";
    landmark.mean_m = place_m;
    landmark.covariance_m2 = 1e-4 * Eigen::Matrix2d::Identity();
    landmark.existence_log_odds = 5.0;
    map.landmarks.push_back(landmark);
  }
  return map;
}

const PoseWithCovariance2 kAboutTheStart{{0.1, -0.1, 0.03},
                                         Eigen::Vector3d(0.02, 0.02, 0.002).asDiagonal()};

void feed(UkfLocaliser& filter, const FeatureList& list, const MotionModel& model) {
  filter.update(list, motionStep(model, filter.stamp_ns(), list.stamp_ns));
}

TEST(UkfLocaliser, FollowsARobotThroughItsMap) {
  const SyntheticDrive drive = office(1);
  const CountingOdometry odometry(drive.odometry);
  UkfLocaliser filter{UkfLocaliserParameters{}};
  filter.setMap(trueMap(drive), {});
  filter.setPose(kAboutTheStart);
  double sum = 0.0;
  int above = 0;
  for (std::size_t i = 0; i < drive.lists.size(); ++i) {
    feed(filter, drive.lists[i], odometry);
    const Eigen::Vector3d error = componentDifference(filter.estimate().pose, drive.truth[i]);
    const double nees = error.dot(filter.estimate().covariance.inverse() * error);
    sum += nees;
    above += nees > 9.348 ? 1 : 0;
  }
  const double count = static_cast<double>(drive.lists.size());
  EXPECT_LT(errorsOf(filter.trajectory(), drive.truth).position_m, 0.05);
  EXPECT_LT(sum / count, 6.0);
  EXPECT_LT(above / count, 0.1);
  EXPECT_EQ(odometry.predicted, 6 * (drive.lists.size() - 1)) << "each sigma point, each interval";
  EXPECT_EQ(odometry.motions, drive.lists.size() - 1);
}

TEST(UkfLocaliser, KeepsTheMapAsItIs) {
  const SyntheticDrive drive = office(2);
  UkfLocaliser filter{UkfLocaliserParameters{}};
  const LandmarkMap map = trueMap(drive);
  filter.setMap(map, {});
  filter.setPose(kAboutTheStart);
  for (const FeatureList& list : drive.lists) feed(filter, list, drive.odometry);
  const LandmarkMap after = filter.landmarks();
  ASSERT_EQ(after.landmarks.size(), map.landmarks.size());
  EXPECT_EQ(after.landmarks[3].existence_log_odds, map.landmarks[3].existence_log_odds);
  EXPECT_EQ(after.stamp_ns, filter.stamp_ns());
  EXPECT_TRUE(filter.isMapFixed());
  EXPECT_THROW(filter.followTrajectory(filter.trajectory()), std::invalid_argument);
}

TEST(UkfLocaliser, RefusesToStartWithoutAMap) {
  UkfLocaliser filter{UkfLocaliserParameters{}};
  EXPECT_THROW(filter.update(oneFeature(1, {1.0, 0.0}, 0.01), {}), std::invalid_argument);
  EXPECT_FALSE(filter.started());
}

TEST(UkfLocaliser, RefusesBadInputAndChangesNothing) {
  const SyntheticDrive drive = office(3);
  UkfLocaliser filter{UkfLocaliserParameters{}};
  filter.setMap(trueMap(drive), {});
  for (std::size_t i = 0; i < 10; ++i) feed(filter, drive.lists[i], drive.odometry);
  const double x_m = filter.estimate().pose.x_m;
  EXPECT_THROW(filter.update(drive.lists[2], {}), std::invalid_argument) << "it is old";
  MotionStep step{filter.stamp_ns(), drive.lists[10].stamp_ns, {}, nullptr};
  step.motion.pose.x_m = NAN;
  EXPECT_THROW(filter.update(drive.lists[10], step), std::invalid_argument);
  PoseWithCovariance2 pose;
  pose.covariance(0, 0) = -1.0;
  EXPECT_THROW(filter.setPose(pose), std::invalid_argument);
  LandmarkMap map = trueMap(drive);
  map.landmarks[1].id = 0;
  EXPECT_THROW(filter.setMap(map, {}), std::invalid_argument);
  EXPECT_EQ(filter.estimate().pose.x_m, x_m);
  EXPECT_EQ(filter.stamp_ns(), drive.lists[9].stamp_ns);
  EXPECT_EQ(filter.landmarks().landmarks.size(), drive.landmarks_m.size());
}

TEST(UkfLocaliser, MovesWhereItIsTold) {
  const SyntheticDrive drive = office(4);
  UkfLocaliser filter{UkfLocaliserParameters{}};
  filter.setMap(trueMap(drive), {});
  for (std::size_t i = 0; i < 10; ++i) feed(filter, drive.lists[i], drive.odometry);
  const Pose2 before = filter.estimate().pose;
  filter.movePose({0.5, 0.0, 0.0});
  EXPECT_NEAR(filter.estimate().pose.x_m, before.x_m + 0.5, 1e-12);
  EXPECT_NEAR(filter.trajectory().back().pose.x_m, before.x_m + 0.5, 1e-12);
  filter.setPose({{7.0, 1.0, 0.0}, Eigen::Matrix3d::Identity()}, filter.stamp_ns());
  EXPECT_EQ(filter.estimate().pose.x_m, 7.0);
  EXPECT_THROW(filter.setPose({}, 1), std::invalid_argument) << "older than the filter";
}

TEST(UkfLocaliser, GivesTheSameBytesForTheSameInputAlsoAsACopy) {
  const SyntheticDrive drive = office(5);
  UkfLocaliser filter{UkfLocaliserParameters{}};
  filter.setMap(trueMap(drive), {});
  for (std::size_t i = 0; i < 50; ++i) feed(filter, drive.lists[i], drive.odometry);
  const std::unique_ptr<LandmarkFilter> copy = filter.clone();
  for (std::size_t i = 50; i < 100; ++i) {
    feed(filter, drive.lists[i], drive.odometry);
    copy->update(drive.lists[i],
                 motionStep(drive.odometry, copy->stamp_ns(), drive.lists[i].stamp_ns), nullptr);
  }
  EXPECT_EQ(copy->estimate().pose.x_m, filter.estimate().pose.x_m);
  EXPECT_EQ((copy->estimate().covariance - filter.estimate().covariance).norm(), 0.0);
}

TEST(UkfLocaliser, ReadsWhatFiltersOfLandmarksHaveInCommon) {
  ram_parameters::ParameterReader reader(YAML::Load("{association_gate: 5.0, node: {}}"), "test");
  EXPECT_NE(ukfLocaliserEntry().read(reader, {})(), nullptr);
  ram_parameters::ParameterReader other(YAML::Load("{particle_amount: 5}"), "test");
  EXPECT_THROW(ukfLocaliserEntry().read(other, {}), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
