// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/point_to_line.hpp"

#include <Eigen/Cholesky>
#include <gmock/gmock.h>

#include "ram_slam/geometry/random.hpp"
#include "ram_slam/sensing/beam_finder.hpp"

#include "walls.hpp"

namespace ram_slam {
namespace {

struct Sweep {
  double angle_min_rad;
  double angle_increment_rad;
  std::size_t beam_count;
};

class BeamFinderOfSweep : public testing::TestWithParam<Sweep> {};

TEST_P(BeamFinderOfSweep, FindsTheBeamWhoseBearingIsNearest) {
  const Sweep sweep = GetParam();
  const BeamFinder finder(sweep.angle_min_rad, sweep.angle_increment_rad, sweep.beam_count);
  const double half_beam_rad = 0.5 * std::abs(sweep.angle_increment_rad);
  const double last = static_cast<double>(sweep.beam_count - 1);
  Random random(7, 1);
  int found_count = 0;
  for (int i = 0; i < 20000; ++i) {
    const double bearing_rad = M_PI * (2.0 * random.uniform() - 1.0);
    const double range_m = 0.05 + 30.0 * random.uniform();
    const std::int32_t beam =
        finder.beamTowards(static_cast<float>(range_m * std::cos(bearing_rad)),
                           static_cast<float>(range_m * std::sin(bearing_rad)));
    if (beam >= 0) {
      ASSERT_LT(beam, static_cast<std::int32_t>(sweep.beam_count));
      const double beam_rad = sweep.angle_min_rad + beam * sweep.angle_increment_rad;
      EXPECT_LT(std::abs(wrapAngle(bearing_rad - beam_rad)), half_beam_rad + 3e-4);
      ++found_count;
      continue;
    }
    // No beam: the nearer end of the sweep is more than half a beam away.
    for (const double end : {0.0, last}) {
      const double end_rad = sweep.angle_min_rad + end * sweep.angle_increment_rad;
      EXPECT_GT(std::abs(wrapAngle(bearing_rad - end_rad)), half_beam_rad - 3e-4);
    }
  }
  const double view_rad = std::min(
      2.0 * M_PI, std::abs(sweep.angle_increment_rad) * static_cast<double>(sweep.beam_count));
  EXPECT_NEAR(found_count / 20000.0, view_rad / (2.0 * M_PI), 0.02);
}

INSTANTIATE_TEST_SUITE_P(Sweeps,
                         BeamFinderOfSweep,
                         testing::Values(Sweep{-M_PI_2, M_PI / 180.0, 181},
                                         Sweep{-0.75 * M_PI, 1.5 * M_PI / 1080.0, 1081},
                                         Sweep{0.75 * M_PI, -1.5 * M_PI / 1080.0, 1081},
                                         Sweep{0.0, 2.0 * M_PI / 360.0, 360},
                                         Sweep{M_PI, -2.0 * M_PI / 720.0, 720}));

/// The pairs by their definition: each point in view with the nearest of all, in double.
/// \param use  called with the point, its partner and target_from_source * point
template <typename Use>
void forEachPairSlowly(const SurfaceScan& target,
                       const SurfaceScan& source,
                       const Pose2& target_from_source,
                       const PairingLimits& limits,
                       const Use& use) {
  const Eigen::Matrix2d rotation = target_from_source.rotation();
  for (std::size_t i = 0; i < source.points.size(); i += limits.point_stride) {
    const SurfacePoint& point = source.points[i];
    const Eigen::Vector2d place = target_from_source * Eigen::Vector2d(point.x_m, point.y_m);
    const double beam =
        (std::atan2(place.y(), place.x()) - target.angle_min_rad) / target.angle_increment_rad;
    if (beam < -0.5 || beam > static_cast<double>(target.point_of_beam.size()) - 0.5) continue;
    const SurfacePoint* partner = nullptr;
    double least_m = limits.max_distance_m;
    for (const SurfacePoint& other : target.points) {
      const double away_m = (Eigen::Vector2d(other.x_m, other.y_m) - place).norm();
      if (away_m >= least_m) continue;
      least_m = away_m;
      partner = &other;
    }
    if (partner == nullptr || !partner->hasNormal()) continue;
    const Eigen::Vector2d normal(partner->normal_x, partner->normal_y);
    const double cosine = normal.dot(rotation * Eigen::Vector2d(point.normal_x, point.normal_y));
    if (!point.hasNormal() || cosine >= limits.min_normal_cosine) use(point, *partner, place);
  }
}

double residual_m(const SurfacePoint& partner, const Eigen::Vector2d& place) {
  return partner.normal_x * (place.x() - partner.x_m) +
         partner.normal_y * (place.y() - partner.y_m);
}

PointToLineSum sumSlowly(const SurfaceScan& target,
                         const SurfaceScan& source,
                         const Pose2& target_from_source,
                         const PairingLimits& limits) {
  PointToLineSum sum;
  forEachPairSlowly(
      target, source, target_from_source, limits,
      [&](const SurfacePoint& point, const SurfacePoint& partner, const Eigen::Vector2d& place) {
        const double residual = residual_m(partner, place);
        const double weight = 1.0 / (1.0 + std::pow(residual / limits.robust_scale_m, 2));
        const Eigen::Vector2d rotated = place - target_from_source.translation();
        const Eigen::Vector3d slope(
            partner.normal_x, partner.normal_y,
            partner.normal_y * rotated.x() - partner.normal_x * rotated.y());
        sum.information += weight * slope * slope.transpose();
        sum.gradient += weight * slope * residual;
        sum.cost_m2 += weight * residual * residual;
        sum.weight += weight;
        if (point.hasNormal()) ++sum.pair_count;
      });
  return sum;
}

TEST(SumPointToLine, IsTheSumOverTheNearestPointsOfAll) {
  const Walls walls = rectangle(-4.0, -3.0, 6.0, 5.0) + rectangle(2.0, 1.0, 3.0, 2.0);
  TestLaser laser;
  laser.field_of_view_rad = 1.5 * M_PI;
  laser.range_deviation_m = 0.01;
  const Pose2 map_from_target{0.0, 0.0, 0.3};
  const SurfaceScan target = extractSurfaces(scanWalls(walls, map_from_target, 1, laser), {});
  Random random(3, 1);
  for (std::size_t i = 0; i < 30; ++i) {
    const Pose2 target_from_source{0.3 * random.gaussian(), 0.3 * random.gaussian(),
                                   0.2 * random.gaussian()};
    const SurfaceScan source =
        extractSurfaces(scanWalls(walls, map_from_target * target_from_source, 2, laser), {});
    const Pose2 guess = target_from_source * Pose2{0.01 * random.gaussian(), 0.01, 0.003};
    PairingLimits limits;
    limits.max_distance_m = 0.1;
    limits.point_stride = 1 + i % 3;
    const PointToLineSum fast = sumPointToLine(target, source, guess, limits);
    const PointToLineSum slow = sumSlowly(target, source, guess, limits);
    ASSERT_GT(slow.pair_count, 50U);
    // Some points at the edge of a gate or as near to one as to another fall differently in float.
    EXPECT_NEAR(static_cast<double>(fast.pair_count), static_cast<double>(slow.pair_count), 2.0);
    EXPECT_GE(fast.visible_count, fast.pair_count);
    EXPECT_LT((fast.information - slow.information).norm(), 0.02 * slow.information.norm());
    EXPECT_LT((fast.gradient - slow.gradient).norm(), 0.02 * slow.weight * 0.03);
    EXPECT_NEAR(fast.weight, slow.weight, 0.02 * slow.weight);
    EXPECT_NEAR(fast.cost_m2, slow.cost_m2, 0.02 * slow.cost_m2 + 1e-5);
  }
}

TEST(SumPointToLine, UsesPointsOnNoLineButCountsThemNot) {
  // Of the thin rod in front of the wall the source sees one point, 5 cm before the line.
  SurfaceScan wall = extractSurfaces(scanWalls({{{2.0, -1.0}, {2.0, 1.0}}}, {}, 1), {});
  SurfaceScan rod = wall;
  rod.points = {{1.95F, 0.0F, 0.0F, 0.0F}};
  const PointToLineSum sum = sumPointToLine(wall, rod, {}, {});
  EXPECT_NEAR(sum.gradient.x() / sum.information(0, 0), -0.05, 1e-3);
  EXPECT_EQ(sum.visible_count, 0U);
  EXPECT_EQ(sum.pair_count, 0U);
  EXPECT_EQ(sum.inlierRatio(), 0.0);
}

TEST(SumPointToLine, OfScansWithNothingInCommonIsZero) {
  const SurfaceScan left = extractSurfaces(scanWalls(rectangle(1.0, -1.0, 2.0, 1.0), {}, 1), {});
  const SurfaceScan right = extractSurfaces(scanWalls(rectangle(8.0, -1.0, 9.0, 1.0), {}, 2), {});
  const PointToLineSum sum = sumPointToLine(left, right, {}, {});
  EXPECT_EQ(sum.pair_count, 0U);
  EXPECT_GT(sum.visible_count, 0U);
  EXPECT_EQ(sum.information.norm(), 0.0);
  EXPECT_EQ(sumPointToLine(left, {}, {}, {}).visible_count, 0U);
}

/// A scan of a laser that moves at `velocity` while one turn of its mirror takes `mirror_turn_s`,
/// as one takes it for that does not know that time.
SurfaceScan scanOfMoving(const Pose2& map_from_laser,
                         const Eigen::Vector3d& velocity,
                         double mirror_turn_s) {
  const Walls walls = rectangle(-4.0, -3.0, 6.0, 5.0) + rectangle(2.0, 1.0, 3.0, 2.0);
  const Pose2 last_beam = exponential(0.5 * mirror_turn_s * velocity);  // half a turn
  return extractSurfaces(scanWalls(walls, map_from_laser, 1, {}, last_beam), {});
}

TEST(SumScanPair, ShowsTheTimeOfTheSweep) {
  constexpr double kMirrorTurnS = 0.04;
  const Eigen::Vector3d fast(0.3, 0.0, 0.8);
  const Eigen::Vector3d slow(0.1, 0.0, -0.4);
  const Pose2 target_from_source{0.8, 0.3, 0.15};
  const SurfaceScan target = scanOfMoving({}, slow, kMirrorTurnS);
  const SurfaceScan source = scanOfMoving(target_from_source, fast, kMirrorTurnS);
  const ScanPairSum sum = sumScanPair({target, slow}, {source, fast}, target_from_source, {});
  EXPECT_NEAR(-sum.information.ldlt().solve(sum.gradient)(3), kMirrorTurnS, 0.004);
}

/// Where the lidar sees a point if one turn of its mirror takes `mirror_turn_s` longer; its beams
/// begin at -pi / 2.
SurfacePoint seenBy(const SurfacePoint& point,
                    const Eigen::Vector3d& velocity,
                    double mirror_turn_s) {
  const double later_s = mirror_turn_s * (std::atan2(point.y_m, point.x_m) + M_PI_2) / (2.0 * M_PI);
  const Eigen::Vector2d seen =
      exponential(later_s * velocity) * Eigen::Vector2d(point.x_m, point.y_m);
  SurfacePoint moved = point;
  moved.x_m = static_cast<float>(seen.x());
  moved.y_m = static_cast<float>(seen.y());
  return moved;
}

TEST(SumScanPair, IsTheSumOfWhatTheResidualsChangeBy) {
  const Eigen::Vector3d fast(0.3, 0.1, 0.8);
  const Eigen::Vector3d slow(0.1, 0.0, -0.4);
  const Pose2 pose{0.4, 0.2, 0.15};
  const SurfaceScan target = scanOfMoving({}, slow, 0.0);
  const SurfaceScan source = scanOfMoving(pose, fast, 0.0);
  PairingLimits limits;
  limits.max_distance_m = 0.1;
  double information = 0.0;
  forEachPairSlowly(
      target, source, pose, limits,
      [&](const SurfacePoint& point, const SurfacePoint& partner, const Eigen::Vector2d& place) {
        constexpr double kLongerS = 0.02;
        const SurfacePoint p = seenBy(point, fast, kLongerS);
        const SurfacePoint q = seenBy(partner, slow, kLongerS);
        const double residual = residual_m(partner, place);
        const double slope =
            (residual_m(q, pose * Eigen::Vector2d(p.x_m, p.y_m)) - residual) / kLongerS;
        information += slope * slope / (1.0 + std::pow(residual / limits.robust_scale_m, 2));
      });
  const ScanPairSum sum = sumScanPair({target, slow}, {source, fast}, pose, limits);
  EXPECT_NEAR(sum.information(3, 3), information, 0.03 * information);
}

TEST(SumScanPair, IsThePointToLineSumInThePose) {
  const SurfaceScan target = scanOfMoving({}, {0.0, 0.0, 0.0}, 0.0);
  const SurfaceScan source = scanOfMoving({0.3, 0.1, 0.15}, {0.0, 0.0, 0.0}, 0.0);
  const Pose2 guess{0.31, 0.1, 0.151};
  const PointToLineSum expected = sumPointToLine(target, source, guess, {});
  const ScanPairSum sum =
      sumScanPair({target, {0.0, 0.0, 0.0}}, {source, {0.0, 0.0, 0.0}}, guess, {});
  const Eigen::Matrix3d information = sum.information.topLeftCorner<3, 3>();
  EXPECT_LT((information - expected.information).norm(), 1e-3 * expected.information.norm());
  EXPECT_LT((sum.gradient.head<3>() - expected.gradient).norm(), 1e-3 * expected.gradient.norm());
  EXPECT_EQ(sum.information.col(3).norm(), 0.0);  // at rest a sweep shows nothing
}

TEST(SumScanPair, OfAClockwiseMirrorIsThatOfANegativeTime) {
  const Eigen::Vector3d velocity(0.0, 0.0, 0.5);
  const auto scanned = [&](const Pose2& pose) {
    return extractSurfaces(inSweepDirection(SweepDirection::kClockwise,
                                            scanWalls(rectangle(-4.0, -3.0, 6.0, 5.0), pose, 1)),
                           {});
  };
  const SurfaceScan clockwise = scanned({});
  const SurfaceScan upright =
      extractSurfaces(scanWalls(rectangle(-4.0, -3.0, 6.0, 5.0), {}, 1), {});
  const auto byYawAndTime = [&](const SurfaceScan& scan) {
    return sumScanPair({scan, -velocity}, {scan, velocity}, {}, {}).information(2, 3);
  };
  // Clockwise the first beam is at the left: from there all angles are negative.
  EXPECT_LT(byYawAndTime(clockwise), 0.0);
  EXPECT_GT(byYawAndTime(upright), 0.0);
}

}  // namespace
}  // namespace ram_slam
