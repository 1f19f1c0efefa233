// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/map_smoother.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

#include "ram_slam/geometry/random.hpp"

#include "../scan_matching/walls.hpp"

namespace ram_slam {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

const Pose2 kMount{0.1, 0.0, 0.0};
constexpr double kScaleError = 1.03;

const std::vector<Eigen::Vector2d> kPillars{{2.2, -1.2}, {4.9, -1.2}, {6.1, 1.0},  {9.4, -1.2},
                                            {13.2, 1.7}, {13.2, 4.4}, {11.0, 5.9}, {10.1, 9.2},
                                            {7.7, 9.2},  {5.0, 7.0},  {3.2, 9.2},  {-1.2, 7.4},
                                            {-1.2, 5.1}, {1.0, 3.3},  {-1.2, 1.4}};

/// A corridor round a block, with pillars so that no two stretches are alike.
Walls building() {
  Walls walls = rectangle(-1.2, -1.2, 13.2, 9.2) + rectangle(1.0, 1.0, 11.0, 7.0);
  for (std::size_t i = 0; i < kPillars.size(); ++i) {
    const double half_m = 0.15 + 0.02 * static_cast<double>(i);
    const Eigen::Vector2d& p = kPillars[i];
    walls = walls + rectangle(p.x() - half_m, p.y() - half_m, p.x() + half_m, p.y() + half_m);
  }
  return walls;
}

/// Rounds of the corridor, a pose each 0.1 m.
std::vector<Pose2> rounds(int count) {
  std::vector<Pose2> poses{Pose2{}};
  for (int round = 0; round < count; ++round) {
    for (const int steps : {120, 80, 120, 80}) {
      for (int i = 0; i < steps; ++i) poses.push_back(poses.back() * Pose2{0.1, 0.0, 0.0});
      for (int i = 0; i < 15; ++i) poses.push_back(poses.back() * Pose2{0.0, 0.0, M_PI_2 / 15});
    }
  }
  return poses;
}

/// The same drive as measured by wheels whose radius is taken 3 % too large and that pull to one
/// side.
std::vector<Pose2> drifting(const std::vector<Pose2>& truth) {
  std::vector<Pose2> poses{truth[0]};
  for (std::size_t i = 1; i < truth.size(); ++i) {
    Pose2 motion = truth[i - 1].inverse() * truth[i];
    motion.x_m *= kScaleError;
    motion.yaw_rad += 0.02 * motion.x_m;
    poses.push_back(poses.back() * motion);
  }
  return poses;
}

double rmsError(const std::vector<StampedPose2>& trajectory, const std::vector<Pose2>& truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += (trajectory[i].pose.translation() - truth[i].translation()).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

/// A pose for each scan, to compare it with the truth.
MapSmootherParameters perScan() {
  MapSmootherParameters parameters;
  parameters.key_scans.pose_per_scan = true;
  return parameters;
}

MapSmoother smoothed(const Walls& walls,
                     const std::vector<Pose2>& truth,
                     const std::vector<Pose2>& odometry) {
  MapSmoother smoother{perScan()};
  TestLaser laser;
  laser.range_deviation_m = 0.01;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto stamp_ns = static_cast<std::int64_t>(i + 1) * 100000000;
    smoother.addScan(scanWalls(walls, truth[i] * kMount, stamp_ns, laser), kMount, odometry[i]);
  }
  smoother.optimize();
  return smoother;
}

TEST(MapSmoother, CutsTheErrorOfDriftingWheelsFivefold) {
  const std::vector<Pose2> truth = rounds(2);
  const std::vector<Pose2> odometry = drifting(truth);
  const MapSmoother smoother = smoothed(building(), truth, odometry);
  std::vector<StampedPose2> before;
  for (const Pose2& pose : odometry) before.push_back({0, pose});
  EXPECT_LT(rmsError(smoother.trajectory(), truth), 0.2 * rmsError(before, truth));
  EXPECT_LT(rmsError(smoother.trajectory(), truth), 0.05);
  EXPECT_THAT(smoother.closures(), Not(IsEmpty()));
}

TEST(MapSmoother, AlignsTheScansBetweenTwoKeyScans) {
  const std::vector<Pose2> truth = rounds(1);
  Random random(1);
  std::vector<Pose2> odometry;
  std::vector<StampedPose2> before;
  for (const Pose2& pose : truth) {
    odometry.push_back(pose * Pose2{0.02 * random.gaussian(), 0.02 * random.gaussian(), 0.0});
    before.push_back({0, odometry.back()});
  }
  odometry[0] = truth[0];
  const auto trajectory = smoothed(building(), truth, odometry).trajectory();
  EXPECT_LT(rmsError(trajectory, truth), 0.5 * rmsError(before, truth));
}

/// The pillars near a robot.
FeatureList pillarsNear(const Pose2& map_from_base, std::int64_t stamp_ns) {
  FeatureList list;
  list.stamp_ns = stamp_ns;
  for (const Eigen::Vector2d& pillar : kPillars) {
    Feature feature;
    feature.type = "pillar";
    feature.position_m = map_from_base.inverse() * pillar;
    feature.covariance_m2 = 1e-4 * Eigen::Matrix2d::Identity();
    if (feature.position_m.norm() < 3.0) list.features.push_back(feature);
  }
  return list;
}

TEST(MapSmoother, RecognisesAPlaceByItsFeaturesWhereverDriftHasBroughtIt) {
  MapSmootherParameters parameters = perScan();
  parameters.loops.search.min_path_m = 1e6;  // no place is sought by the poses
  parameters.loops.constellation_path_m = 20.0;
  const std::vector<Pose2> truth = rounds(2);
  const std::vector<Pose2> odometry = drifting(truth);
  TestLaser laser;
  laser.range_deviation_m = 0.01;
  for (const bool with_features : {false, true}) {
    MapSmoother smoother(parameters);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const auto stamp_ns = static_cast<std::int64_t>(i + 1) * 100000000;
      const LaserScan scan = scanWalls(building(), truth[i] * kMount, stamp_ns, laser);
      // Before the scan or after it.
      if (with_features && i % 2 == 0) smoother.addFeatures(pillarsNear(truth[i], stamp_ns));
      smoother.addScan(scan, kMount, odometry[i]);
      if (with_features && i % 2 == 1) smoother.addFeatures(pillarsNear(truth[i], stamp_ns));
    }
    EXPECT_EQ(smoother.closures().empty(), !with_features);
    if (with_features) {
      EXPECT_LT(rmsError(smoother.trajectory(), truth), 0.2);
    }
  }
}

TEST(MapSmoother, HasACorrectionOnlyWhenAClosureMovedTheRobotOrItWasOptimized) {
  const std::vector<Pose2> truth = rounds(2);
  const std::vector<Pose2> odometry = drifting(truth);
  MapSmootherParameters parameters = perScan();
  // The pose shall drift in the second round, by little: the scans are exact.
  parameters.refinement.near_views.count = 0;
  parameters.solve_distance_m = parameters.correction_distance_m = 0.002;
  MapSmoother smoother{parameters};
  std::size_t correction_count = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto stamp_ns = static_cast<std::int64_t>(i + 1) * 100000000;
    const std::size_t closure_count = smoother.closures().size();
    smoother.addScan(scanWalls(building(), truth[i] * kMount, stamp_ns), kMount, odometry[i]);
    if (smoother.closures().size() == closure_count) {
      EXPECT_FALSE(smoother.hasCorrection());
    }
    if (!smoother.hasCorrection()) continue;
    ++correction_count;
    EXPECT_EQ(smoother.takeCorrection().size(), i + 1);
    EXPECT_FALSE(smoother.hasCorrection());
  }
  EXPECT_GT(correction_count, 0U);
  EXPECT_LE(correction_count, smoother.closures().size());
  smoother.optimize();
  EXPECT_TRUE(smoother.hasCorrection());
}

TEST(MapSmoother, IsOptimizedWhenPlacesWereRecognisedButNotTooOften) {
  const std::vector<Pose2> truth = rounds(2);
  const std::vector<Pose2> odometry = drifting(truth);
  MapSmootherParameters parameters = perScan();
  parameters.optimize_period_s = 10.0;
  MapSmoother smoother{parameters};
  std::size_t closures_then = 0;
  std::int64_t last_ns = 0;
  int count = 0;
  smoother.optimizeIfDue();  // of nothing
  EXPECT_FALSE(smoother.hasCorrection());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto stamp_ns = static_cast<std::int64_t>(i + 1) * 100000000;
    smoother.addScan(scanWalls(building(), truth[i] * kMount, stamp_ns), kMount, odometry[i]);
    smoother.takeCorrection();
    const std::size_t known = smoother.closures().size();
    smoother.optimizeIfDue();
    if (!smoother.hasCorrection()) continue;
    EXPECT_GT(known, closures_then);
    EXPECT_GE(stamp_ns, last_ns + 10'000'000'000);
    closures_then = smoother.closures().size();
    last_ns = stamp_ns;
    ++count;
  }
  EXPECT_GT(count, 0);
}

TEST(MapSmoother, GivesAPoseForEachScanAtItsStamp) {
  const std::vector<Pose2> truth = rounds(1);
  const auto trajectory = smoothed(building(), truth, truth).trajectory();
  ASSERT_THAT(trajectory, SizeIs(truth.size()));
  EXPECT_EQ(trajectory[0].stamp_ns, 100000000);
  EXPECT_EQ(trajectory[77].stamp_ns, 7800000000);
  EXPECT_EQ(trajectory[0].pose.x_m, truth[0].x_m);
}

TEST(MapSmoother, FindsNoLoopBetweenPlacesOfTheSameShape) {
  // Two rooms of the same shape, 40 m of winding corridor apart.
  const auto room = [](double x_m) {
    return outline({{x_m - 2, -2}, {x_m + 2, -2}, {x_m + 2, -0.6}}) +
           outline({{x_m - 2, 2}, {x_m + 2, 2}, {x_m + 2, 0.6}});
  };
  const Walls walls =
      room(0.0) + room(40.0) + Walls{{{2, 0.6}, {38, 0.6}}, {{2, -0.6}, {38, -0.6}}};
  std::vector<Pose2> truth;
  for (int i = 0; i < 400; ++i) truth.push_back({0.1 * i, 0.0, 0.0});
  EXPECT_THAT(smoothed(walls, truth, drifting(truth)).closures(), IsEmpty());
}

TEST(MapSmoother, RefusingAndAcceptingAClosureAgainRestoresTheTrajectory) {
  const std::vector<Pose2> truth = rounds(2);
  MapSmoother smoother = smoothed(building(), truth, drifting(truth));
  smoother.optimize();
  const double error = rmsError(smoother.trajectory(), truth);
  const std::size_t count = smoother.closures().size();
  ASSERT_GT(count, 0u);
  for (std::size_t i = 0; i < count; ++i) smoother.refuseClosure(i);
  smoother.optimize();
  for (std::size_t i = 0; i < count; ++i)
    EXPECT_EQ(smoother.closures()[i].state, ClosureState::kRefused);
  for (std::size_t i = 0; i < count; ++i) smoother.acceptClosure(i);
  smoother.optimize();
  EXPECT_NEAR(rmsError(smoother.trajectory(), truth), error, 0.002);
  EXPECT_THROW(smoother.refuseClosure(100000), std::out_of_range);
}

TEST(MapSmoother, ExportsAGraphWhoseNodesAreThePosesOfTheBase) {
  const std::vector<Pose2> truth = rounds(1);
  const MapSmoother smoother = smoothed(building(), truth, truth);
  const PoseGraph graph = smoother.graph();
  ASSERT_EQ(graph.map_from_node.size(), smoother.keyScans().size());
  EXPECT_NEAR(graph.map_from_node[0].x_m, truth[0].x_m, 1e-12);
  for (const PoseEdge& edge : graph.edges) {
    const Pose2 difference =
        edge.from_from_to.inverse() *
        (graph.map_from_node[edge.from].inverse() * graph.map_from_node[edge.to]);
    EXPECT_LT(difference.translation().norm(), 0.03);
  }
}

TEST(MapSmoother, SameInputGivesTheSameBits) {
  const std::vector<Pose2> truth = rounds(1);
  const auto a = smoothed(building(), truth, drifting(truth)).trajectory();
  const auto b = smoothed(building(), truth, drifting(truth)).trajectory();
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].pose.x_m, b[i].pose.x_m);
    EXPECT_EQ(a[i].pose.yaw_rad, b[i].pose.yaw_rad);
  }
}

TEST(MapSmoother, RefusesWhatItCannotUse) {
  MapSmoother smoother{perScan()};
  const LaserScan scan = scanWalls(building(), kMount, 5);
  smoother.addScan(scan, kMount, Pose2{});
  EXPECT_THAT([&] { smoother.addScan(scan, kMount, Pose2{}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("not later than the last")));
  EXPECT_THROW(smoother.addScan(LaserScan(), kMount, Pose2{}), std::invalid_argument);
  EXPECT_THROW(smoother.addScan(scan, kMount, Pose2{0.0, NAN, 0.0}), std::invalid_argument);
  EXPECT_THAT(smoother.trajectory(), SizeIs(1));
}

TEST(MapSmoother, HasNoTrajectoryBeforeTheFirstScan) {
  MapSmoother smoother{perScan()};
  smoother.optimize();
  EXPECT_THAT(smoother.trajectory(), IsEmpty());
}

TEST(MapSmoother, JoinsThePartsOfADriveBetweenWhichTheRobotWasCarried) {
  // A second round begins elsewhere, in another heading; the wheels know nothing of it.
  MapSmootherParameters parameters = perScan();
  parameters.loops.jumps.support_path_m = 5.0;
  parameters.optimize_period_s = 0.0;
  std::vector<Pose2> truth = rounds(1);
  std::vector<Pose2> odometry = truth;
  const std::size_t first_count = truth.size();
  constexpr std::size_t kElsewhere = 175;  // on the short side, towards a corner
  for (std::size_t i = 0; i < first_count; ++i) {
    truth.push_back(truth[(kElsewhere + i) % first_count]);
    odometry.push_back(odometry[first_count - 1] * truth[first_count].inverse() * truth.back());
  }
  MapSmoother smoother(parameters);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const std::int64_t gap_ns = i < first_count ? 0 : 60'000'000'000;
    const auto stamp_ns = static_cast<std::int64_t>(i + 1) * 100000000 + gap_ns;
    smoother.addScan(scanWalls(building(), truth[i] * kMount, stamp_ns), kMount, odometry[i]);
  }
  smoother.optimize();
  int bridges = 0;
  for (const LoopClosure& closure : smoother.closures()) bridges += closure.jump ? 1 : 0;
  EXPECT_EQ(bridges, 1);
  const std::vector<StampedPose2> trajectory = smoother.trajectory();
  for (std::size_t i = first_count + 5; i < truth.size(); i += 10)
    EXPECT_LT((trajectory[i].pose.translation() - truth[i].translation()).norm(), 0.1) << i;
}

TEST(MapSmoother, KnowsAfterAPauseThatTheRobotWasNotCarried) {
  MapSmoother smoother{perScan()};
  const std::vector<Pose2> truth = rounds(2);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const std::int64_t pause_ns = i < truth.size() / 2 ? 0 : 60'000'000'000;
    const auto stamp_ns = static_cast<std::int64_t>(i + 1) * 100000000 + pause_ns;
    smoother.addScan(scanWalls(building(), truth[i] * kMount, stamp_ns), kMount, truth[i]);
  }
  smoother.optimize();
  EXPECT_THAT(smoother.closures(), Not(IsEmpty()));
  for (const LoopClosure& closure : smoother.closures()) EXPECT_FALSE(closure.jump);
  const std::vector<StampedPose2> trajectory = smoother.trajectory();
  for (std::size_t i = 0; i < truth.size(); i += 10)
    EXPECT_LT((trajectory[i].pose.translation() - truth[i].translation()).norm(), 0.1) << i;
}

TEST(MapSmoother, OptimizesOnRequestOnlyWithAPeriodOfZero) {
  MapSmootherParameters parameters = perScan();
  parameters.optimize_period_s = 0.0;
  parameters.solve_distance_m = 1e6;  // no closure is solved for at once
  parameters.solve_angle_rad = 1e6;
  const std::vector<Pose2> truth = rounds(2);
  const std::vector<Pose2> odometry = drifting(truth);
  MapSmoother smoother(parameters);
  for (std::size_t i = 0; i < truth.size(); i += 2) {
    const auto stamp_ns = static_cast<std::int64_t>(i + 1) * 100000000;
    smoother.addScan(scanWalls(building(), truth[i] * kMount, stamp_ns), kMount, odometry[i]);
    smoother.optimizeIfDue();
  }
  EXPECT_THAT(smoother.closures(), Not(IsEmpty()));
  EXPECT_FALSE(smoother.hasCorrection());
  smoother.optimize();
  EXPECT_TRUE(smoother.hasCorrection());
}

TEST(MapSmoother, RefusesParametersOutOfBounds) {
  MapSmootherParameters parameters;
  parameters.loops.search.drift_m_per_m = -0.1;
  EXPECT_THAT([&] { MapSmoother smoother(parameters); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("loop_drift_m_per_m must be >= 0")));
}

TEST(MapSmoother, ContinuesALoadedMapInItsFrameAndLeavesItWhereItIs) {
  const Walls walls = building();
  const std::vector<Pose2> truth = rounds(1);
  const std::vector<Pose2> odometry = drifting(truth);
  TestLaser laser;
  laser.range_deviation_m = 0.01;
  std::vector<PlacedScan> map;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Pose2 place = truth[i] * kMount;
    const auto stamp_ns = static_cast<std::int64_t>(1000 - i) * 100000000;  // of another clock
    map.push_back({scanWalls(walls, place, stamp_ns, laser), kMount, place, {}});
  }
  MapSmoother smoother{perScan()};
  smoother.load(map);
  const std::vector<KeyScan> loaded = smoother.keyScans();
  ASSERT_GT(loaded.size(), 100u);
  const Pose2 found_beside{0.2, -0.15, 0.04};
  smoother.startSession();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto stamp_ns = static_cast<std::int64_t>(i + 1) * 100000000;
    smoother.addScan(scanWalls(walls, truth[i] * kMount, stamp_ns, laser), kMount,
                     found_beside * odometry[i]);
  }
  smoother.optimize();
  EXPECT_THAT(smoother.closures(), Not(IsEmpty()));
  ASSERT_THAT(smoother.trajectory(), SizeIs(truth.size()));
  EXPECT_LT(rmsError(smoother.trajectory(), truth), 0.03);
  for (std::size_t i = 0; i < loaded.size(); ++i) {
    const Pose2 moved = loaded[i].map_from_laser.inverse() * smoother.keyScans()[i].map_from_laser;
    EXPECT_LT(moved.translation().norm(), 0.005) << i;
  }
}

}  // namespace
}  // namespace ram_slam
