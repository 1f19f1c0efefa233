// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/fast_slam.hpp"

#include "fast_slam_fixtures.hpp"

namespace ram_slam {
namespace {

TEST(FastSlam, SharingNodesChangesNoBit) {
  const SyntheticDrive drive = office(4);
  FastSlam shared{FastSlamParameters{}};
  FastSlam copied{FastSlamParameters{}};
  for (std::size_t i = 0; i < 300; ++i) {
    shared.update(drive.lists[i], drive.odometry);
    copied.update(drive.lists[i], drive.odometry);
    copied.unshare();
  }
  EXPECT_EQ(bytesOf(shared), bytesOf(copied));
  EXPECT_LT(shared.landmarkBytes(), copied.landmarkBytes());
}

TEST(FastSlam, SameSeedAndInputGiveTheSameBytes) {
  const SyntheticDrive drive = office(5);
  FastSlamParameters parameters;
  const std::string first = bytesOf(run(drive, parameters));
  EXPECT_EQ(first, bytesOf(run(drive, parameters)));
  parameters.seed = 2;
  EXPECT_NE(first, bytesOf(run(drive, parameters)));
}

TEST(FastSlam, RefusedListsLeaveNoTrace) {
  const SyntheticDrive drive = office(6);
  FastSlam filter{FastSlamParameters{}};
  for (std::size_t i = 0; i < 100; ++i) filter.update(drive.lists[i], drive.odometry);
  const std::string before = bytesOf(filter);
  const std::int64_t next_ns = drive.lists[100].stamp_ns;
  FeatureList bad = oneFeature(next_ns, {std::nan(""), 0.0}, 1e-4);
  EXPECT_THROW(filter.update(bad, drive.odometry), std::invalid_argument);
  bad = oneFeature(next_ns, {1.0, 0.0}, 0.0);
  EXPECT_THROW(filter.update(bad, drive.odometry), std::invalid_argument);
  bad = oneFeature(next_ns, {1.0, 0.0}, 1e-4);
  bad.features[0].covariance_m2(0, 1) = 1.0;
  EXPECT_THROW(filter.update(bad, drive.odometry), std::invalid_argument);
  EXPECT_THROW(filter.update(drive.lists[50], drive.odometry), std::invalid_argument);
  EXPECT_THROW(filter.update(oneFeature(next_ns + 1, {1.0, 0.0}, 1e-4), drive.odometry),
               std::out_of_range);
  EXPECT_EQ(bytesOf(filter), before);
  EXPECT_EQ(filter.stamp_ns(), drive.lists[99].stamp_ns);
}

TEST(FastSlam, EmptyListPredictsOnly) {  // fault F120
  FastSlam filter(plain());
  SyntheticOdometry odometry;
  Random random(1);
  FeatureList empty;
  for (int i = 1; i <= 10; ++i) {
    odometry.add(i, {0.1, 0.0, 0.0}, {}, random);
    empty.stamp_ns = i;
    filter.update(empty, odometry);
  }
  const PoseWithCovariance2 wanted = odometry.motion(1, 10);
  EXPECT_NEAR(filter.estimate().pose.x_m, wanted.pose.x_m, 1e-12);
  EXPECT_NEAR((filter.estimate().covariance - wanted.covariance).norm(), 0.0, 1e-12);
  EXPECT_TRUE(filter.landmarks().landmarks.empty());
}

TEST(FastSlam, TwoFeaturesAtOnePlaceMakeOneLandmark) {  // fault F126
  FastSlam filter(plain());
  SyntheticOdometry odometry;
  Random random(1);
  for (int i = 1; i <= 5; ++i) {
    odometry.add(i, {}, {}, random);
    FeatureList list = oneFeature(i, {2.0, 1.0}, 1e-4);
    list.features.push_back(list.features[0]);
    filter.update(list, odometry);
  }
  EXPECT_EQ(filter.landmarks().landmarks.size(), 1U);
}

std::size_t nearestTo(const Eigen::Vector2d& place_m,
                      const std::vector<Eigen::Vector2d>& landmarks_m) {
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < landmarks_m.size(); ++i) {
    if ((landmarks_m[i] - place_m).norm() < (landmarks_m[nearest] - place_m).norm()) nearest = i;
  }
  return nearest;
}

class CloseTogether : public testing::TestWithParam<std::uint64_t> {};

TEST_P(CloseTogether, LandmarksAreNeitherSwappedNorDoubled) {
  // Pairs of poles 0.15 m apart along a wall, ten times as far as a feature is off.
  std::vector<Eigen::Vector2d> landmarks_m;
  for (int i = 0; i < 12; ++i) {
    landmarks_m.push_back({1.5 * i, 2.0 + 0.3 * (i % 3)});
    landmarks_m.push_back(landmarks_m.back() + Eigen::Vector2d(0.15, 0.0));
  }
  SyntheticNoise noise;
  noise.feature_m = 0.015;
  const SyntheticDrive drive =
      syntheticDrive(rectangleTour(12.0, 1.0, 2), landmarks_m, 5.0, noise, GetParam());
  FastSlamParameters parameters;
  FastSlam filter(parameters);
  std::map<LandmarkId, std::map<std::size_t, std::size_t>> taken_for;  // matches by pole
  std::size_t match_count = 0;
  for (std::size_t i = 0; i < drive.lists.size(); ++i) {
    filter.update(drive.lists[i], drive.odometry);
    for (std::size_t k = 0; k < drive.lists[i].features.size(); ++k) {
      const Association& association = filter.associations()[k];
      if (association.outcome != AssociationOutcome::kMatched) continue;
      ++match_count;
      ++taken_for[association.id]
                 [nearestTo(drive.truth[i] * drive.lists[i].features[k].position_m, landmarks_m)];
    }
  }
  std::size_t swap_count = match_count;  // less those with the pole that the landmark stands for
  for (const auto& [id, counts] : taken_for) {
    std::size_t most = 0;
    for (const auto& [pole, count] : counts) most = std::max(most, count);
    swap_count -= most;
  }
  EXPECT_GT(match_count, 3000U);
  EXPECT_LE(swap_count, match_count / 250);
  EXPECT_LT(errorsOf(filter.trajectory(), drive.truth).position_m, 0.05);
  std::set<std::size_t> poles;
  std::size_t confirmed_count = 0;
  for (const LandmarkEstimate& landmark : filter.landmarks().landmarks) {
    if (landmark.existence_log_odds < parameters.confirm_log_odds) continue;
    ++confirmed_count;
    const std::size_t pole = nearestTo(landmark.mean_m, landmarks_m);
    poles.insert(pole);
    EXPECT_LT((landmark.mean_m - landmarks_m[pole]).norm(), 0.075);
  }
  EXPECT_EQ(confirmed_count, landmarks_m.size());  // no ghost ...
  EXPECT_EQ(poles.size(), landmarks_m.size());     // ... and none missing
}

INSTANTIATE_TEST_SUITE_P(Seeds, CloseTogether, testing::Values(3, 4, 5));

/// Confirmed landmarks on a grid of 1 m around the origin.
LandmarkMap gridOf(int side) {
  LandmarkMap map;
  for (int i = 0; i < side * side; ++i) {
    LandmarkEstimate landmark;
    landmark.id = static_cast<LandmarkId>(i);
    landmark.type = "pole";
    landmark.mean_m = {i % side - side / 2 + 0.5, i / side - side / 2 + 0.5};
    landmark.covariance_m2 = 1e-6 * Eigen::Matrix2d::Identity();
    landmark.existence_log_odds = 5.0;
    map.landmarks.push_back(landmark);
  }
  return map;
}

TEST(FastSlam, MapWithASingularCovarianceIsRefused) {  // fault F130
  FastSlam filter(plain());
  filter.setMap(gridOf(2));
  LandmarkMap bad = gridOf(3);
  bad.landmarks[4].covariance_m2 << 1e-4, 1e-4, 1e-4, 1e-4;
  EXPECT_THROW(filter.setMap(bad), std::invalid_argument);
  EXPECT_EQ(filter.landmarks().landmarks.size(), 4U);
}

TEST(FastSlam, FindsItsWayAmongAHundredThousandLandmarks) {  // fault F131
  constexpr int kSide = 316;
  FastSlamParameters parameters = plain();
  parameters.particle_amount = 10;
  FastSlam filter(parameters);
  filter.setMap(gridOf(kSide));
  SyntheticOdometry odometry;
  Random random(1);
  for (int i = 1; i <= 5; ++i) {
    odometry.add(i, {}, {}, random);
    filter.update(oneFeature(i, {0.5, 0.5}, 1e-4), odometry);
    ASSERT_EQ(filter.associations()[0].outcome, AssociationOutcome::kMatched);
    EXPECT_EQ(filter.associations()[0].id, static_cast<LandmarkId>(kSide * kSide / 2 + kSide / 2));
  }
  EXPECT_EQ(filter.landmarks().landmarks.size(), static_cast<std::size_t>(kSide * kSide));
}

TEST(FastSlam, DetectorsThatTakeTurnsMakeOneMap) {
  // Every other list comes from a second detector, of another type, and some of both at one
  // instant.
  const SyntheticDrive drive = office(8);
  FastSlam filter{FastSlamParameters{}};
  std::size_t list_count = 0;
  for (std::size_t i = 0; i < 300; ++i) {
    FeatureList first = drive.lists[i];
    FeatureList second = first;
    for (Feature& feature : second.features) feature.type = "edge";
    if (i % 3 != 1) {
      filter.update(first, drive.odometry);
      ++list_count;
    }
    if (i % 3 != 0) {
      filter.update(second, drive.odometry);
      ++list_count;
    }
    EXPECT_EQ(filter.stamp_ns(), first.stamp_ns);
  }
  EXPECT_EQ(list_count, 400U);
  std::map<std::string, std::size_t> counts;
  for (const LandmarkEstimate& landmark : filter.landmarks().landmarks) ++counts[landmark.type];
  EXPECT_EQ(counts.size(), 2U);
  EXPECT_NEAR(static_cast<double>(counts["edge"]), static_cast<double>(counts["pole"]), 3.0);
  const std::vector<Pose2> truth(drive.truth.begin(), drive.truth.begin() + 300);
  EXPECT_LT(errorsOf(filter.trajectory(), truth).position_m, 0.1);
}

TEST(FastSlam, SetPoseMovesEveryParticleAndKeepsTheMap) {
  const SyntheticDrive drive = office(7);
  FastSlam filter{FastSlamParameters{}};
  for (std::size_t i = 0; i < 100; ++i) filter.update(drive.lists[i], drive.odometry);
  const std::size_t landmarks = filter.landmarks().landmarks.size();
  filter.setPose({{5.0, 6.0, 1.0}, 1e-4 * Eigen::Matrix3d::Identity()});
  EXPECT_EQ(filter.landmarks().landmarks.size(), landmarks);
  for (const Particle& particle : filter.particles()) {
    EXPECT_NEAR(particle.map_from_base.x_m, 5.0, 0.06);
    EXPECT_NEAR(particle.map_from_base.yaw_rad, 1.0, 0.06);
  }
  PoseWithCovariance2 bad;
  bad.covariance(0, 0) = -1.0;
  EXPECT_THROW(filter.setPose(bad), std::invalid_argument);
  bad.covariance(0, 0) = std::nan("");
  EXPECT_THROW(filter.setPose(bad), std::invalid_argument);
}

/// Sees right through everything.
class EmptyView : public FieldOfView {
public:
  Sight look(const Eigen::Vector2d& point_in_base_m) const override {
    return point_in_base_m.norm() < range_m() ? Sight::kEmpty : Sight::kHidden;
  }
  double range_m() const override { return 5.0; }
};

/// Shows something everywhere.
class FullView : public FieldOfView {
public:
  Sight look(const Eigen::Vector2d& /*point_in_base_m*/) const override { return Sight::kVisible; }
  double range_m() const override { return 10.0; }
};

/// The same of things that look alike from everywhere.
class FullViewOfPoles : public FullView {
public:
  bool showsEverySide() const override { return true; }
};

TEST(FastSlam, LandmarkIsMissedFromANewSideOnlyIfItShowsEverySide) {
  const auto evidenceAfterPassing = [](const FieldOfView& view) {
    FastSlam filter(plain());
    SyntheticOdometry odometry;
    Random random(1);
    for (int i = 1; i <= 10; ++i) {
      odometry.add(i, {}, {}, random);
      filter.update(oneFeature(i, {2.0, 0.0}, 1e-4), odometry, &view);
    }
    const double before = filter.landmarks().landmarks.front().existence_log_odds;
    odometry.add(11, {4.0, 0.0, M_PI}, {0.0, 0.0, 0.0, 0.0, 0.0}, random);  // now from behind
    filter.update(oneFeature(11, {0.0, 1.5}, 1e-4), odometry, &view);
    return filter.landmarks().landmarks.front().existence_log_odds - before;
  };
  EXPECT_EQ(evidenceAfterPassing(FullView()), 0.0);
  EXPECT_LT(evidenceAfterPassing(FullViewOfPoles()), -0.1);
}

TEST(FastSlam, LandmarkThatADetectorOverlooksIsDoubtedButKept) {
  FastSlam filter(plain());
  SyntheticOdometry odometry;
  Random random(1);
  const FullView view;
  for (int i = 1; i <= 10; ++i) {
    odometry.add(i, {}, {}, random);
    filter.update(oneFeature(i, {2.0, 0.0}, 1e-4), odometry, &view);
  }
  ASSERT_EQ(filter.landmarks().landmarks.size(), 1U);
  const LandmarkId id = filter.landmarks().landmarks[0].id;
  EXPECT_GT(filter.landmarks().landmarks[0].existence_log_odds, 2.0);
  for (int i = 11; i <= 60; ++i) {
    odometry.add(i, {}, {}, random);
    filter.update(oneFeature(i, {-3.0, 0.0}, 1e-4), odometry, &view);
  }
  ASSERT_NE(filter.registry().find(id), nullptr);
  EXPECT_EQ(filter.registry().find(id)->existence_log_odds, 0.0);
  odometry.add(61, {}, {}, random);
  filter.update(oneFeature(61, {2.0, 0.0}, 1e-4), odometry, &view);
  EXPECT_GT(filter.registry().find(id)->existence_log_odds, 2.0);  // the same again
}

TEST(FastSlam, LandmarkInEmptySpaceIsRemoved) {  // S156
  FastSlam filter(plain());
  SyntheticOdometry odometry;
  Random random(1);
  const EmptyView view;
  for (int i = 1; i <= 4; ++i) {
    odometry.add(i, {0.05, 0.0, 0.0}, {}, random);
    FeatureList list = oneFeature(i, {2.0, 1.0}, 1e-4);
    if (i > 1) list.features[0].type = "another";
    list.features[0].position_m = {8.0, 0.0};
    if (i == 1) list.features[0].position_m = {2.0, 1.0};
    filter.update(list, odometry, &view);
  }
  for (const LandmarkEstimate& landmark : filter.landmarks().landmarks)
    EXPECT_EQ(landmark.type, "another");
}

TEST(FastSlam, JointCovarianceOfLandmarksIsSymmetricPositiveDefinite) {
  const SyntheticDrive drive = office(8);
  FastSlam filter{FastSlamParameters{}};
  for (std::size_t i = 0; i < 200; ++i) filter.update(drive.lists[i], drive.odometry);
  const LandmarkMap map = filter.landmarks();
  ASSERT_FALSE(map.covariances.empty());
  for (const LandmarkCovariance& block : map.covariances) {
    EXPECT_LT(block.first_id, block.second_id);
    const auto find = [&map](LandmarkId id) {
      return std::find_if(map.landmarks.begin(), map.landmarks.end(),
                          [id](const LandmarkEstimate& landmark) { return landmark.id == id; });
    };
    Eigen::Matrix4d joint;
    joint << find(block.first_id)->covariance_m2, block.covariance_m2,
        block.covariance_m2.transpose(), find(block.second_id)->covariance_m2;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(joint).eigenvalues().minCoeff(), 0.0);
  }
}

}  // namespace
}  // namespace ram_slam
