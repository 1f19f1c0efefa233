// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/lidar_effects.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "ramscout_sim/random.hpp"

#include "shared.hpp"

namespace ramscout_sim {
namespace {

using ::testing::Each;
using testing::makeRoom;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kLaserHeight_m = 0.37;
constexpr double kPitch_rad = 0.0043633;  // of a UTM-30LX

LidarParameters perfect(int beams, double first_rad, double last_rad) {
  LidarParameters p;
  p.beams = beams;
  p.angle_min_rad = first_rad;
  p.angle_max_rad = last_rad;
  p.time_increment_s = 0.0;
  p.range_max_m = 60.0;
  p.range_sigma_m = 0.0;
  p.far_range_sigma_m = 0.0;
  p.range_resolution_m = 0.0;
  return p;
}

SensorPath lookingAlongX() {
  return {{0}, {Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, kLaserHeight_m))}};
}

/// An upright slab whose near face is `distance_m` away along x; `incidence_rad` is the angle at
/// which a beam along x meets it.
Solid slabAt(double distance_m,
             double incidence_rad,
             std::size_t material,
             double thickness_m = 0.02) {
  Solid slab;
  slab.size_m = {thickness_m, 200.0, 3.0};
  slab.material = material;
  slab.world_from_solid = Eigen::Translation3d(distance_m, 0.0, 1.5) *
                          Eigen::AngleAxisd(incidence_rad, Eigen::Vector3d::UnitZ()) *
                          Eigen::Translation3d(0.5 * thickness_m, 0.0, 0.0);
  return slab;
}

World worldOf(std::vector<Solid> solids, const Material& special) {
  World world;
  world.materials.push_back(special);
  world.solids = std::move(solids);
  return world;
}

Material ofSurface(Surface surface) {
  Material material;
  material.surface = surface;
  return material;
}

/// What the beam along x reads in `count` scans.
std::vector<float> readings(const LidarParameters& parameters, const World& world, int count) {
  const Lidar lidar(parameters, 3);
  const RayCaster caster(world);
  std::vector<float> ranges_m;
  for (int scan = 0; scan < count; ++scan) {
    ranges_m.push_back(
        lidar.measure(0, static_cast<std::uint64_t>(scan), lookingAlongX(), caster).ranges_m[0]);
  }
  return ranges_m;
}

/// Half of the width in which a binomial share lies with three standard deviations.
double threeSigma(double share, int count) {
  return 3.0 * std::sqrt(share * (1.0 - share) / count) + 1e-9;
}

TEST(LidarEffects, AWhiteWallAtHalfTheDetectionRangeAnswersEveryOtherTime) {
  constexpr int kScans = 20000;
  LidarParameters p = perfect(2, 0.0, 0.1);
  p.half_detection_range_m = 20.0;
  const std::vector<float> ranges = readings(p, worldOf({slabAt(20.0, 0.0, 0)}, {}), kScans);
  const double lost = static_cast<double>(std::count(ranges.begin(), ranges.end(), kInfinity));
  EXPECT_NEAR(lost / kScans, 0.5, threeSigma(0.5, kScans));
}

TEST(LidarEffects, DarkAndSlantedSurfacesDropOutAsTheirEchoHasIt) {
  constexpr int kScans = 20000;
  for (const double reflectivity : {0.9, 0.3, 0.05}) {
    for (const double incidence_rad : {0.0, 1.0, 1.4}) {
      LidarParameters p = perfect(2, 0.0, 0.1);
      p.half_detection_range_m = 20.0;
      Material material;
      material.reflectivity = reflectivity;
      const std::vector<float> ranges =
          readings(p, worldOf({slabAt(8.0, incidence_rad, 1)}, material), kScans);
      const double echo = reflectivity * std::cos(incidence_rad) / (8.0 * 8.0);
      const double seen = 1.0 / (1.0 + std::pow(0.9 / (20.0 * 20.0) / echo, 4.0));
      const double share =
          1.0 - static_cast<double>(std::count(ranges.begin(), ranges.end(), kInfinity)) / kScans;
      EXPECT_NEAR(share, seen, threeSigma(seen, kScans) + 1e-4)
          << reflectivity << " at " << incidence_rad << " rad";
    }
  }
}

TEST(LidarEffects, GlassIsSeenHeadOnAsOftenAsItsMaterialSays) {
  constexpr int kScans = 20000;
  for (const double incidence_rad : {0.0, 0.1, 0.2}) {
    const std::vector<float> ranges = readings(
        perfect(2, 0.0, 0.1),
        worldOf({slabAt(3.0, incidence_rad, 1), slabAt(9.0, 0.0, 0)}, ofSurface(Surface::kGlass)),
        kScans);
    const double expected = std::exp(-0.5 * incidence_rad * incidence_rad / 0.01);
    const double returned =
        static_cast<double>(std::count_if(ranges.begin(), ranges.end(),
                                          [](float range_m) { return range_m < 4.0F; })) /
        kScans;
    EXPECT_NEAR(returned, expected, threeSigma(expected, kScans) + 1e-6) << incidence_rad;
  }
}

TEST(LidarEffects, ThroughGlassAtFortyFiveDegreesItSeesWhatIsBehind) {
  const World world =
      worldOf({slabAt(3.0, 0.785, 1), slabAt(9.0, 0.0, 0)}, ofSurface(Surface::kGlass));
  for (const float range_m : readings(perfect(2, 0.0, 0.1), world, 100))
    EXPECT_NEAR(range_m, 9.0, 1e-3);
}

TEST(LidarEffects, AMirrorShowsTheRoomBehindItself) {
  World world = worldOf({slabAt(4.0, 0.785398163, 1)}, ofSurface(Surface::kMirror));
  world.solids.push_back(makeWall({-50.0, 7.0}, {50.0, 7.0}, 0.2, 3.0));    // 6.9 m to the left
  world.solids.push_back(makeWall({-50.0, -7.0}, {50.0, -7.0}, 0.2, 3.0));  // or to the right
  for (const float range_m : readings(perfect(2, 0.0, 0.001), world, 3))
    EXPECT_NEAR(range_m, 4.0 + 6.9, 2e-3);
}

/// In how many of many placements an edge 1 m in front of a wall gives a reading between the two.
double shareOfMixedEdges(double half_footprint_rad, double pulse_length_m) {
  constexpr int kPlacements = 2000;
  LidarParameters p = perfect(21, -10.0 * kPitch_rad, 10.0 * kPitch_rad);
  p.beam_divergence_rad = half_footprint_rad;
  p.pulse_length_m = pulse_length_m;
  const Lidar lidar(p, 1);
  int mixed = 0;
  for (int i = 0; i < kPlacements; ++i) {
    const double edge_rad = kPitch_rad * (static_cast<double>(i) / kPlacements - 0.5);
    World world;
    world.solids = {slabAt(5.0, 0.0, 0), slabAt(4.0, 0.0, 0, 0.01)};
    // Its right end at the edge's bearing.
    world.solids[1].size_m.y() = 2.0;
    world.solids[1].world_from_solid.translation().y() = 4.0 * std::tan(edge_rad) + 1.0;
    for (const float range_m : lidar.measure(0, 0, lookingAlongX(), RayCaster(world)).ranges_m) {
      if (range_m > 4.05F && range_m < 4.95F) ++mixed;
    }
  }
  return static_cast<double>(mixed) / kPlacements;
}

TEST(LidarEffects, PixelsMixAtEdgesAsOftenAsTheFootprintCoversThem) {
  for (const double half_footprint_rad : {0.0008, 0.0015}) {
    const double expected = 2.0 * half_footprint_rad / kPitch_rad;
    EXPECT_NEAR(shareOfMixedEdges(half_footprint_rad, 2.0), expected, 0.2 * expected);
  }
}

TEST(LidarEffects, EchoesFartherApartThanAPulseDoNotMix) {
  EXPECT_EQ(shareOfMixedEdges(0.0015, 0.3), 0.0);
}

TEST(LidarEffects, NothingMixesOnFlatWalls) {
  LidarParameters p = perfect(1081, -2.35619449, 2.35619449);
  LidarParameters spread = p;
  spread.beam_divergence_rad = 0.0015;
  spread.pulse_length_m = 2.0;
  const RayCaster room(makeRoom(8.0, 5.0));
  SensorPath path = lookingAlongX();
  path.world_from_laser[0].pretranslate(Eigen::Vector3d(4.0, 2.5, 0.0));
  const std::vector<float> line = Lidar(p, 1).measure(0, 0, path, room).ranges_m;
  const std::vector<float> cone = Lidar(spread, 1).measure(0, 0, path, room).ranges_m;
  for (std::size_t beam = 0; beam < line.size(); ++beam) EXPECT_EQ(cone[beam], line[beam]) << beam;
}

TEST(LidarEffects, AreKeyedBySeedAndScanAlone) {
  LidarParameters p = perfect(101, -1.0, 1.0);
  p.half_detection_range_m = 10.0;
  p.beam_divergence_rad = 0.0015;
  const RayCaster world(
      worldOf({slabAt(3.0, 0.1, 1), slabAt(9.0, 0.0, 0)}, ofSurface(Surface::kGlass)));
  const Lidar lidar(p, 7);
  const Scan first = lidar.measure(0, 5, lookingAlongX(), world);
  const Scan other = lidar.measure(0, 6, lookingAlongX(), world);
  EXPECT_EQ(lidar.measure(0, 5, lookingAlongX(), world).ranges_m, first.ranges_m);
  EXPECT_NE(other.ranges_m, first.ranges_m);
  EXPECT_NE(Lidar(p, 8).measure(0, 5, lookingAlongX(), world).ranges_m, first.ranges_m);
}

Solid turned(Shape shape, Random& random) {
  Solid solid;
  solid.shape = shape;
  solid.size_m = {random.uniform(0.2, 1.5), random.uniform(0.2, 1.5), random.uniform(0.2, 1.5)};
  if (shape != Shape::kBox) solid.size_m.y() = solid.size_m.x();
  if (shape == Shape::kSphere) solid.size_m.z() = solid.size_m.x();
  solid.world_from_solid =
      Eigen::Translation3d(random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), 0.5) *
      Eigen::AngleAxisd(random.uniform(-3.0, 3.0), Eigen::Vector3d::UnitZ()) *
      Eigen::AngleAxisd(random.uniform(-0.3, 0.3), Eigen::Vector3d::UnitX());
  return solid;
}

TEST(MovingSolids, AreSeenAsEmbreeSeesThemStanding) {
  Random random(4, Stream::kBuilding);
  LidarParameters p = perfect(721, -M_PI, M_PI);
  const Lidar lidar(p, 1);
  const RayCaster floor{World()};
  for (int round = 0; round < 20; ++round) {
    World world;
    for (const Shape shape : {Shape::kBox, Shape::kCylinder, Shape::kSphere})
      world.solids.push_back(turned(shape, random));
    SensorPath path = lookingAlongX();
    path.world_from_laser[0] =
        Eigen::Translation3d(random.uniform(-6.0, 6.0), 6.0, 0.4) *
        Eigen::AngleAxisd(random.uniform(-3.0, 3.0), Eigen::Vector3d::UnitZ());
    const Scan standing = lidar.measure(0, 0, path, RayCaster(world));
    const Scan moving = lidar.measure(0, 0, path, floor, world.solids);
    int different = 0;
    for (std::size_t beam = 0; beam < standing.ranges_m.size(); ++beam) {
      const double gap_m = std::abs(standing.ranges_m[beam] - moving.ranges_m[beam]);
      if (standing.ranges_m[beam] != moving.ranges_m[beam] && !(gap_m < 2e-3)) ++different;
    }
    EXPECT_LE(different, 3) << "polygons stand for circles: a grazing ray may miss one of them";
  }
}

}  // namespace
}  // namespace ramscout_sim
