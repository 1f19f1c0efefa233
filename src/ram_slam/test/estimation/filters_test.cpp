// SPDX-License-Identifier: BSD-3-Clause
// What every filter of the registry owes to Tracker, one and the same test for each.
#include <stdexcept>

#include <gmock/gmock.h>

#include "ram_slam/estimation/estimator_registry.hpp"

#include "../fast_slam/fast_slam_fixtures.hpp"

namespace ram_slam {
namespace {

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

/// Of the name of a filter; with the true map of a drive.
class EachFilter : public testing::TestWithParam<const char*> {
protected:
  const SyntheticDrive drive_ = office(21);
  std::unique_ptr<LandmarkFilter> filter_ = make();

  std::unique_ptr<LandmarkFilter> make() const {
    ram_parameters::ParameterReader reader(YAML::Node(), "test");
    std::unique_ptr<LandmarkFilter> filter = filters().at(GetParam()).read(reader, {})();
    filter->setMap(trueMap(drive_), {});
    filter->setPose({{}, Eigen::Vector3d(1e-3, 1e-3, 1e-4).asDiagonal()});
    return filter;
  }
  void feed(LandmarkFilter& filter, std::size_t from, std::size_t to) const {
    for (std::size_t i = from; i < to; ++i) {
      const FeatureList& list = drive_.lists[i];
      filter.update(list, motionStep(drive_.odometry, filter.stamp_ns(), list.stamp_ns), nullptr);
    }
  }
};

TEST_P(EachFilter, KnowsWhereItIsInAMap) {
  feed(*filter_, 0, 150);
  EXPECT_LT((filter_->estimate().pose.translation() - drive_.truth[149].translation()).norm(), 0.1);
  EXPECT_EQ(filter_->stamp_ns(), drive_.lists[149].stamp_ns);
  EXPECT_EQ(filter_->trajectory().back().stamp_ns, drive_.lists[149].stamp_ns);
  EXPECT_EQ(filter_->associations().size(), drive_.lists[149].features.size());
  EXPECT_FALSE(filter_->health().empty());
}

TEST_P(EachFilter, HoldsItsLandmarksWhereItsMapHasThem) {
  feed(*filter_, 0, 50);
  for (const LandmarkEstimate& landmark : filter_->landmarks().landmarks) {
    ASSERT_NE(filter_->registry().find(landmark.id), nullptr);
    const Landmark* held = filter_->best().landmarks.find(landmark.id);
    ASSERT_NE(held, nullptr);
    EXPECT_LT((held->mean_m - landmark.mean_m).norm(), 0.05);
  }
}

TEST_P(EachFilter, GoesOnAsACopyOfItself) {
  feed(*filter_, 0, 50);
  const std::unique_ptr<LandmarkFilter> copy = filter_->clone();
  feed(*filter_, 50, 100);
  EXPECT_EQ(copy->stamp_ns(), drive_.lists[49].stamp_ns) << "it is another one";
  feed(*copy, 50, 100);
  EXPECT_EQ(copy->estimate().pose.x_m, filter_->estimate().pose.x_m);
  EXPECT_EQ((copy->estimate().covariance - filter_->estimate().covariance).norm(), 0.0);
}

TEST_P(EachFilter, LeavesAFixedMapAsItIs) {
  filter_->fixMap();
  ASSERT_TRUE(filter_->isMapFixed());
  const LandmarkMap before = filter_->landmarks();
  feed(*filter_, 0, 100);
  const LandmarkMap after = filter_->landmarks();
  ASSERT_EQ(after.landmarks.size(), before.landmarks.size());
  for (std::size_t i = 0; i < before.landmarks.size(); ++i)
    EXPECT_LT((after.landmarks[i].mean_m - before.landmarks[i].mean_m).norm(), 1e-12);
}

TEST_P(EachFilter, IsWhereACallerPutsItAndRefusesWhatIsNoPose) {
  feed(*filter_, 0, 10);
  const Pose2 there{3.0, 1.0, 0.5};
  filter_->setPose({there, 0.01 * Eigen::Matrix3d::Identity()}, filter_->stamp_ns());
  EXPECT_EQ(filter_->estimate().pose.x_m, there.x_m);
  filter_->movePose({1.0, 0.0, 0.0});
  EXPECT_NEAR(filter_->estimate().pose.x_m, there.x_m + 1.0, 1e-12);
  PoseWithCovariance2 broken;
  broken.covariance(0, 0) = -1.0;
  EXPECT_THROW(filter_->setPose(broken), std::invalid_argument);
  EXPECT_THROW(filter_->setPose({}, 1), std::invalid_argument) << "older than the filter";
  EXPECT_NEAR(filter_->estimate().pose.x_m, there.x_m + 1.0, 1e-12);
}

TEST_P(EachFilter, RefusesBadListsAndChangesNothing) {
  feed(*filter_, 0, 10);
  const double x_m = filter_->estimate().pose.x_m;
  EXPECT_THROW(filter_->check(drive_.lists[3]), std::invalid_argument) << "it is old";
  FeatureList broken = drive_.lists[10];
  broken.features.push_back({});
  broken.features.back().position_m.x() = NAN;
  EXPECT_THROW(filter_->check(broken), std::invalid_argument);
  EXPECT_THROW(filter_->update(broken, {}, nullptr), std::invalid_argument);
  EXPECT_EQ(filter_->estimate().pose.x_m, x_m);
  EXPECT_EQ(filter_->stamp_ns(), drive_.lists[9].stamp_ns);
}

constexpr const char* kTested[] = {"ekf_slam", "fast_slam", "ukf_localiser"};

TEST(Filters, AreAllTested) {
  std::vector<std::string> names;
  for (const auto& [name, filter] : filters()) names.push_back(name);
  EXPECT_THAT(names, testing::ElementsAreArray(kTested)) << "add the new one to kTested";
}

INSTANTIATE_TEST_SUITE_P(OfTheRegistry,
                         EachFilter,
                         testing::ValuesIn(kTested),
                         [](const auto& each) { return std::string(each.param); });

}  // namespace
}  // namespace ram_slam
