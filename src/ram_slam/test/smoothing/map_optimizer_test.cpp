// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/map_optimizer.hpp"

#include <gmock/gmock.h>

#include "key_scan_drive.hpp"

namespace ram_slam {
namespace {

constexpr double kStepM = 0.5;

/// Key scans along the x axis that see nothing, so that only edges hold them.
KeyScans blindDrive(std::size_t count) {
  std::vector<Pose2> poses;
  for (std::size_t i = 0; i < count; ++i)
    poses.push_back({kStepM * static_cast<double>(i), 0.0, 0.0});
  return scansAt({}, poses, poses);
}

std::vector<Pose2> posesOf(const KeyScans& scans) {
  std::vector<Pose2> poses;
  for (const KeyScan& key : scans.keys()) poses.push_back(key.map_from_laser);
  return poses;
}

TEST(MapOptimizer, GraphHasAnEdgePerMotion) {
  const KeyScans scans = blindDrive(5);
  const PoseGraph graph = laserGraph(scans, LoopCloser({}, {}, {}));
  ASSERT_EQ(graph.map_from_node.size(), 5U);
  ASSERT_EQ(graph.edges.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(graph.edges[i].from, i);
    EXPECT_EQ(graph.edges[i].to, i + 1);
    EXPECT_NEAR(graph.edges[i].from_from_to.x_m, kStepM, 1e-12);
  }
}

TEST(MapOptimizer, SolvingRestoresPosesThatContradictTheMotion) {
  KeyScans scans = blindDrive(5);
  std::vector<Pose2> poses = posesOf(scans);
  for (std::size_t i = 1; i < poses.size(); ++i) poses[i].y_m += 0.3;
  scans.setPoses(poses);
  LoopCloser loops({}, {}, {});
  MapOptimizer({}, {}, {}).solve(scans, loops);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(scans.keys()[i].map_from_laser.x_m, kStepM * static_cast<double>(i), 1e-6);
    EXPECT_NEAR(scans.keys()[i].map_from_laser.y_m, 0.0, 1e-6);
  }
}

TEST(MapOptimizer, RefiningMovesKeyScansOntoEachOthersWalls) {
  const std::vector<Pose2> truth = thereAndBack(15);
  KeyScans scans = scansAt(pillarRoom(), truth, truth);
  std::vector<Pose2> poses = posesOf(scans);
  for (std::size_t i = 1; i < poses.size(); ++i) poses[i].y_m += i % 2 == 0 ? 0.04 : -0.04;
  scans.setPoses(poses);
  MapOptimizer({}, {}, {}).refine(scans);
  for (const KeyScan& key : scans.keys()) EXPECT_NEAR(key.map_from_laser.y_m, 0.0, 0.01);
}

TEST(MapOptimizer, BaseGraphIsTheLaserGraphSeenFromTheBase) {
  const Pose2 mount{0.2, -0.1, 0.5};
  KeyScans scans({}, {}, {}, 0.4);
  for (int i = 0; i < 3; ++i)
    scans.add(scanWalls({}, {}, i + 1), mount, {kStepM * static_cast<double>(i), 0.0, 0.0});
  const PoseGraph graph = baseGraph(scans, LoopCloser({}, {}, {}));
  ASSERT_EQ(graph.edges.size(), 2U);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(graph.map_from_node[i].x_m, kStepM * static_cast<double>(i), 1e-9);
  EXPECT_NEAR(graph.edges[0].from_from_to.x_m, kStepM, 1e-9);
  EXPECT_NEAR(graph.edges[0].from_from_to.y_m, 0.0, 1e-9);
  EXPECT_NEAR(graph.edges[0].from_from_to.yaw_rad, 0.0, 1e-9);
}

}  // namespace
}  // namespace ram_slam
