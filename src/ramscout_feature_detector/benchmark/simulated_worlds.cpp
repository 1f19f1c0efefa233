// SPDX-License-Identifier: BSD-3-Clause
// Precision, recall and calibration of the detectors in random worlds.
//
// simulated_worlds [first seed] [worlds of each kind] [poses per world] [noise, m]
// [laser_range_sigma, m] [corner|edge]
//
// A feature is true if a corner of the world's geometry lies within 10 cm. A corner is visible if
// at least 0.3 m of wall are seen without a gap on both of its sides, by at least 10 beams in all,
// less than 8 m away, and its opening is at most 140 degrees; it is found if a feature lies within
// 10 cm.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "ramscout_feature_detector/edge_detector.hpp"
#include "ramscout_feature_detector/feature_detector.hpp"

#include "../test/random_world.hpp"

namespace {

using namespace ramscout_feature_detector;

constexpr double kTrueM = 0.1;
constexpr double kLegM = 0.3;
constexpr double kFarthestM = 8.0;
constexpr int kLeastBeams = 10;
constexpr double kWidestOpeningRad = 140.0 * M_PI / 180.0;

/// Corners that the lidar sees well, in the laser's frame.
std::vector<Eigen::Vector2d> visibleCorners(const PolygonWorld& world,
                                            const ram_slam::Pose2& pose,
                                            const ram_slam::LaserScan& geometry) {
  struct Run {
    int wall;
    Eigen::Vector2d first, last;
    int beams;
  };
  std::vector<Run> runs;
  for (std::size_t beam = 0; beam < geometry.ranges_m.size(); ++beam) {
    const double bearing_rad = geometry.bearing_rad(beam);
    const auto hit = world.hit(pose.translation(), pose.yaw_rad + bearing_rad);
    const Eigen::Vector2d end =
        hit.range_m * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad));
    if (runs.empty() || runs.back().wall != hit.wall) runs.push_back({hit.wall, end, end, 0});
    runs.back().last = end;
    ++runs.back().beams;
  }
  std::vector<Eigen::Vector2d> corners;
  for (std::size_t i = 1; i < runs.size(); ++i) {
    const Run& a = runs[i - 1];
    const Run& b = runs[i];
    if (a.wall < 0 || b.wall < 0 || a.beams < 2 || b.beams < 2 || a.beams + b.beams < kLeastBeams)
      continue;
    const Eigen::Vector2d along_a = (a.first - a.last).normalized();
    const Eigen::Vector2d along_b = (b.last - b.first).normalized();
    Eigen::Matrix2d directions;
    directions << along_a, -along_b;
    if (std::acos(std::clamp(along_a.dot(along_b), -1.0, 1.0)) > kWidestOpeningRad) continue;
    const Eigen::Vector2d t = directions.inverse() * (b.first - a.last);
    const Eigen::Vector2d corner = a.last + t.x() * along_a;
    const Eigen::Vector2d in_world = pose * corner;
    const auto nearWall = [&](int wall) {
      const auto& w = world.walls[wall];
      return (in_world - w.from_m).norm() + (in_world - w.to_m).norm() <
             (w.to_m - w.from_m).norm() + 1e-6;
    };
    if (nearWall(a.wall) && nearWall(b.wall) && (a.first - corner).norm() >= kLegM &&
        (b.last - corner).norm() >= kLegM && corner.norm() < kFarthestM) {
      corners.push_back(corner);
    }
  }
  return corners;
}

struct Score {
  int features = 0, true_features = 0, visible = 0, found = 0;
  double nees = 0.0;
  int nees_count = 0, nees_outliers = 0;
  double time_s = 0.0;
  int scans = 0;

  void print(const char* name) const {
    std::printf(
        "%-9s scans %d features/scan %.2f precision %.4f (%d false) recall %.4f (of %d) NEES %.2f "
        "(%d of %d beyond 99.9 %%) %.3f ms\n",
        name, scans, 1.0 * features / scans, 1.0 * true_features / features,
        features - true_features, 1.0 * found / visible, visible, nees / nees_count, nees_outliers,
        nees_count, 1e3 * time_s / scans);
  }

  /// \param pose  of the laser in the world; features are in the laser's frame
  void addFeatures(const ram_slam::FeatureList& list,
                   const ram_slam::Pose2& pose,
                   const RandomWorld& world) {
    for (const auto& feature : list.features) {
      ++features;
      true_features += world.distanceToCorner_m(pose * feature.position_m) <= kTrueM ? 1 : 0;
    }
  }

  /// \param corners_m  that can be seen, in the laser's frame
  void addVisible(const ram_slam::FeatureList& list,
                  const std::vector<Eigen::Vector2d>& corners_m) {
    for (const Eigen::Vector2d& corner_m : corners_m) {
      ++visible;
      bool is_found = false;
      for (const auto& feature : list.features) {
        const Eigen::Vector2d error_m = feature.position_m - corner_m;
        if (error_m.norm() > kTrueM) continue;
        is_found = true;
        const double e2 = error_m.dot(feature.covariance_m2.inverse() * error_m);
        nees_outliers += e2 > 13.8 ? 1 : 0;  // chi square (2 dof) exceeded once in 1000
        nees += e2;
        ++nees_count;
      }
      found += is_found ? 1 : 0;
    }
  }
};

}  // namespace

int main(int argc, char** argv) {
  const int seed = argc > 1 ? std::atoi(argv[1]) : 1;
  const int worlds = argc > 2 ? std::atoi(argv[2]) : 1;
  const int poses = argc > 3 ? std::atoi(argv[3]) : 200;
  const double noise_m = argc > 4 ? std::atof(argv[4]) : 0.01;
  FeatureDetectorParameters parameters;
  if (argc > 5) parameters.laser_range_sigma = std::atof(argv[5]);
  const bool edges = argc > 6 && argv[6] == std::string("edge");
  EdgeDetectorParameters edge_parameters;
  edge_parameters.laser_range_sigma = parameters.laser_range_sigma;
  const FeatureDetector detector(parameters);
  const EdgeDetector edge_detector(edge_parameters);
  const std::pair<const char*, RandomWorld::Kind> kinds[] = {
      {"office", RandomWorld::Kind::kOffice},
      {"polygons", RandomWorld::Kind::kPolygons},
      {"hall", RandomWorld::Kind::kHall}};
  for (const auto& [name, kind] : kinds) {
    Score score;
    for (int i = 0; i < worlds * poses; ++i) {
      const RandomWorld random_world(kind, seed + i / poses);
      const PolygonWorld world = random_world.walls();
      ram_slam::Random random(seed, 1000 + i);
      const ram_slam::Pose2 pose = random_world.freePose(random);
      const ram_slam::LaserScan scan = world.scan(pose, noise_m, random);
      const auto start = std::chrono::steady_clock::now();
      const auto list = edges ? edge_detector.detect(scan, {}) : detector.detect(scan, {});
      score.time_s +=
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      ++score.scans;
      score.addFeatures(list, pose, random_world);
      score.addVisible(list, visibleCorners(world, pose, scan));
    }
    score.print(name);
  }
}
