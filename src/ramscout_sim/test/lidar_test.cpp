// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <gmock/gmock.h>
#include <ode/ode.h>
#include <yaml-cpp/yaml.h>

#include "ramscout_sim/office.hpp"
#include "ramscout_sim/random.hpp"

#include "shared.hpp"

namespace ramscout_sim {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using testing::makeRoom;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kLaserHeight_m = 0.37;

LidarParameters perfect() {
  LidarParameters p;
  p.range_sigma_m = 0.0;
  p.far_range_sigma_m = 0.0;
  p.range_resolution_m = 0.0;
  return p;
}

Eigen::Isometry3d laserAt(double x_m, double y_m, double yaw_rad) {
  return Eigen::Translation3d(0.0, 0.0, kLaserHeight_m) * toIsometry({x_m, y_m, yaw_rad});
}

SensorPath standing(const Eigen::Isometry3d& world_from_laser) {
  return {{0}, {world_from_laser}};
}

/// Way from a point inside the rectangle [0, length] x [0, width] to its edge.
double wayToEdge_m(double x, double y, double direction_rad, double length_m, double width_m) {
  const double c = std::cos(direction_rad);
  const double s = std::sin(direction_rad);
  const double along_x = c > 0.0 ? (length_m - x) / c : x / -c;
  const double along_y = s > 0.0 ? (width_m - y) / s : y / -s;
  return std::min(c == 0.0 ? 1e9 : along_x, s == 0.0 ? 1e9 : along_y);
}

World wallAt(double distance_m) {
  World world;
  world.solids.push_back(makeWall({distance_m + 0.1, -500.0}, {distance_m + 0.1, 500.0}, 0.2, 2.5));
  return world;
}

/// Readings of one beam that looks straight at a wall.
std::vector<double> readWall(const LidarParameters& parameters, double distance_m, int count) {
  LidarParameters two_beams = parameters;
  two_beams.beams = 2;
  two_beams.angle_min_rad = 0.0;
  two_beams.angle_max_rad = 1.0;
  const Lidar lidar(two_beams, 5);
  const RayCaster world(wallAt(distance_m));
  std::vector<double> readings;
  for (int i = 0; i < count; ++i) {
    readings.push_back(
        lidar.measure(0, static_cast<std::uint64_t>(i), standing(laserAt(0, 0, 0)), world)
            .ranges_m[0]);
  }
  return readings;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation(const std::vector<double>& values) {
  const double centre = mean(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - centre) * (value - centre);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(Lidar, SeesARectangularRoomAsGeometryHasIt) {
  const RayCaster room(makeRoom(8.0, 5.0));
  const Lidar lidar(perfect(), 1);
  const LidarParameters& p = lidar.parameters();
  for (const Pose2& pose : {Pose2{4.0, 2.5, 0.0}, Pose2{0.3, 0.4, 2.0}, Pose2{7.0, 4.5, -0.7}}) {
    const Scan scan =
        lidar.measure(0, 0, standing(laserAt(pose.x_m, pose.y_m, pose.yaw_rad)), room);
    for (int beam = 0; beam < p.beams; ++beam) {
      const double direction_rad = pose.yaw_rad + p.angle_min_rad + beam * p.angleIncrement_rad();
      ASSERT_NEAR(scan.ranges_m[static_cast<std::size_t>(beam)],
                  wayToEdge_m(pose.x_m, pose.y_m, direction_rad, 8.0, 5.0), 1e-4)
          << beam;
    }
  }
}

/// Distance to the first solid along a ray, by ODE's own collision of rays with primitives.
class OdeRays {
public:
  explicit OdeRays(const World& world) {
    dInitODE2(0);
    space_ = dSimpleSpaceCreate(nullptr);
    for (const Solid& solid : world.solids) add(solid);
    dCreatePlane(space_, 0, 0, 1, 0);
    ray_ = dCreateRay(nullptr, 1000.0);
    dGeomRaySetClosestHit(ray_, 1);
  }
  ~OdeRays() {
    dGeomDestroy(ray_);
    dSpaceDestroy(space_);
  }
  OdeRays(const OdeRays&) = delete;
  OdeRays& operator=(const OdeRays&) = delete;

  double cast(const Ray& ray) {
    const Eigen::Vector3d o = ray.origin_m.cast<double>();
    const Eigen::Vector3d d = ray.direction.cast<double>();
    dGeomRaySet(ray_, o.x(), o.y(), o.z(), d.x(), d.y(), d.z());
    double nearest_m = std::numeric_limits<double>::infinity();
    dSpaceCollide2(ray_, reinterpret_cast<dGeomID>(space_), &nearest_m,
                   [](void* result, dGeomID a, dGeomID b) {
                     dContactGeom contact;
                     double& nearest = *static_cast<double*>(result);
                     if (dCollide(a, b, 1, &contact, sizeof(contact)) > 0)
                       nearest = std::min<double>(nearest, contact.depth);
                   });
    return nearest_m;
  }

private:
  void add(const Solid& solid) {
    const Eigen::Vector3d& size = solid.size_m;
    const dGeomID geom =
        solid.shape == Shape::kBox        ? dCreateBox(space_, size.x(), size.y(), size.z())
        : solid.shape == Shape::kCylinder ? dCreateCylinder(space_, 0.5 * size.x(), size.z())
                                          : dCreateSphere(space_, 0.5 * size.x());
    const Eigen::Vector3d p = solid.world_from_solid.translation();
    const Eigen::Quaterniond q(solid.world_from_solid.linear());
    const dQuaternion quaternion = {q.w(), q.x(), q.y(), q.z()};
    dGeomSetPosition(geom, p.x(), p.y(), p.z());
    dGeomSetQuaternion(geom, quaternion);
  }

  dSpaceID space_;
  dGeomID ray_;
};

/// Solids of every shape, in every attitude.
World clutter() {
  Random random(3, Stream::kBuilding);
  World world;
  for (int i = 0; i < 60; ++i) {
    Solid solid;
    solid.shape = i % 3 == 0 ? Shape::kBox : i % 3 == 1 ? Shape::kCylinder : Shape::kSphere;
    const double width_m = random.uniform(0.1, 1.0);
    solid.size_m = {width_m, width_m,
                    solid.shape == Shape::kSphere ? width_m : random.uniform(0.5, 2.0)};
    solid.world_from_solid.translate(Eigen::Vector3d(
        random.uniform(-10, 10), random.uniform(-10, 10), random.uniform(0.3, 0.8)));
    solid.world_from_solid.rotate(
        Eigen::AngleAxisd(random.uniform(-3, 3), Eigen::Vector3d::UnitZ()));
    if (solid.shape == Shape::kBox)
      solid.world_from_solid.rotate(
          Eigen::AngleAxisd(random.uniform(-1, 1), Eigen::Vector3d::UnitY()));
    world.solids.push_back(solid);
  }
  return world;
}

/// Share of the rays on which the two differ by more than a millimetre, `count` rays all over.
double shareThatDiffers(const World& world, int count) {
  const RayCaster caster(world);
  OdeRays oracle(world);
  const Eigen::AlignedBox3d bounds = boundsOf(world);
  Random random(9, Stream::kRange);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const double yaw_rad = random.uniform(-M_PI, M_PI);
    const double slope = random.uniform(-0.05, 0.05);
    Ray ray;
    ray.origin_m =
        Eigen::Vector3d(random.uniform(bounds.min().x(), bounds.max().x()),
                        random.uniform(bounds.min().y(), bounds.max().y()), kLaserHeight_m)
            .cast<float>();
    ray.direction =
        Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), slope).normalized().cast<float>();
    rays.push_back(ray);
  }
  const std::vector<float> found = caster.cast(rays);
  int different = 0;
  int compared = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double truth_m = oracle.cast(rays[i]);
    if (truth_m > 30.0) continue;  // beyond any lidar; ODE's floor has no end
    ++compared;
    if (std::abs(static_cast<double>(found[i]) - truth_m) > 1e-3) ++different;
  }
  EXPECT_GT(compared, count / 2);
  return static_cast<double>(different) / compared;
}

TEST(RayCaster, AgreesWithOdesRaysInARoom) {
  EXPECT_EQ(shareThatDiffers(makeRoom(8.0, 5.0), 100000), 0.0);
}

TEST(RayCaster, AgreesWithOdesRaysInAnOffice) {
  World office = generateOffice({}).world;
  // Rays that graze a round bin meet it or do not.
  EXPECT_LT(shareThatDiffers(office, 10000), 1e-3);
  office.solids.erase(std::remove_if(office.solids.begin(), office.solids.end(),
                                     [](const Solid& s) { return s.shape == Shape::kCylinder; }),
                      office.solids.end());
  EXPECT_EQ(shareThatDiffers(office, 10000), 0.0);
}

TEST(RayCaster, AgreesWithOdesRaysAmongEveryShape) {
  EXPECT_LT(shareThatDiffers(clutter(), 30000), 5e-3);
}

TEST(RayCaster, FindsNothingWhereThereIsNothing) {
  const RayCaster empty{World()};
  EXPECT_THAT(empty.cast(std::vector<Ray>(17, Ray{{0, 0, 1}, {1, 0, 0}})), Each(kInfinity));
}

TEST(RayCaster, DirectionsAlongAnAxisButForRoundingMissNothing) {
  const RayCaster caster(makeRoom(20.0, 10.0), InstructionSet::kAvx512);
  for (const float tiny : {0.0F, -0.0F, 1e-19F, -1e-19F, -9e-20F, 6e-22F, -1e-39F}) {
    std::vector<Ray> rays;
    for (int i = -8; i < 8; ++i) {
      const float bearing_rad = 0.004F * static_cast<float>(i);
      rays.push_back({{10.2F, 5.0F, 0.37F}, {std::cos(bearing_rad), std::sin(bearing_rad), tiny}});
    }
    rays[8].direction.y() = -tiny;
    EXPECT_NEAR(caster.cast(rays)[8], 9.8, 1e-5) << tiny;
    for (Ray& ray : rays) ray.direction.z() = -ray.direction.y() * 1e-18F;
    EXPECT_THAT(caster.cast(rays), Each(::testing::Le(9.9F))) << tiny;
  }
}

TEST(RayCaster, GrazingRaysEndWhereTheSurfaceIs) {
  // A wall at 30 degrees, 60 m from the origin, whose corners single precision rounds.
  const double wall_yaw_rad = M_PI / 6.0;
  const Eigen::Vector2d along(std::cos(wall_yaw_rad), std::sin(wall_yaw_rad));
  const Eigen::Vector2d across(-along.y(), along.x());
  const Eigen::Vector2d begin(61.237, 17.913);
  World world;
  world.solids = {makeWall(begin, begin + 20.0 * along, 0.1, 2.0)};
  const RayCaster caster(world);
  for (const double angle_rad : {1e-3, 2e-3, 1e-2, 0.1}) {
    for (const double height_m : {0.31, 0.37, 0.43}) {
      // From 5 mm beside its face, which a ray from there meets 5 mm / sin(angle) further on.
      const Eigen::Vector2d from = begin + 1.0 * along - 0.055 * across;
      const Eigen::Vector2d to =
          Eigen::Rotation2Dd(wall_yaw_rad + angle_rad) * Eigen::Vector2d::UnitX();
      Ray ray;
      ray.origin_m = Eigen::Vector3d(from.x(), from.y(), height_m).cast<float>();
      ray.direction = Eigen::Vector3d(to.x(), to.y(), 0.0).cast<float>();
      const Rays rays(std::vector<Ray>(1, ray));
      const Eigen::Vector2d exact_from(rays.origins_m(0, 0), rays.origins_m(0, 1));
      const Eigen::Vector2d exact_to(rays.directions(0, 0), rays.directions(0, 1));
      const double expected_m =
          across.dot(begin - 0.05 * across - exact_from) / across.dot(exact_to);
      EXPECT_NEAR(caster.cast(rays)[0], expected_m, 5e-5) << angle_rad;
    }
  }
}

/// Rays from all around to points on a line.
std::vector<Ray> aimedAt(const Eigen::Vector3d& begin_m, const Eigen::Vector3d& end_m, int count) {
  Random random(5, Stream::kRange);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d target_m = begin_m + random.uniform() * (end_m - begin_m);
    const Eigen::AngleAxisd around(random.uniform(-M_PI, M_PI), Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d from_m =
        target_m + around * Eigen::Vector3d(random.uniform(5.0, 20.0), 0.0, 0.0);
    Ray ray;
    ray.origin_m = from_m.cast<float>();
    ray.direction = (target_m - ray.origin_m.cast<double>()).normalized().cast<float>();
    rays.push_back(ray);
  }
  return rays;
}

TEST(RayCaster, NoRaySlipsIntoABoxThroughAnEdge) {
  Solid box;
  box.size_m = {6.0, 0.7, 2.0};
  box.world_from_solid = toIsometry({31.7, 12.3, 0.4});
  box.world_from_solid.pretranslate(Eigen::Vector3d(0.0, 0.0, 1.0));
  World world;
  world.solids = {box};
  const RayCaster caster(world);
  const std::vector<Ray> rays =
      aimedAt(box.world_from_solid * Eigen::Vector3d(-3.0, -0.35, -0.9),
              box.world_from_solid * Eigen::Vector3d(-3.0, -0.35, 0.9), 300000);
  const std::vector<float> found_m = caster.cast(rays);
  int hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::optional<Hit> entry = intersect(rays[i], box);
    if (!entry) continue;
    Ray inside = rays[i];
    inside.origin_m += (entry->distance_m + 1e-4F) * inside.direction;
    const std::optional<Hit> exit = intersect(inside, box);
    if (!exit || exit->distance_m < 0.01F) continue;  // cuts the edge: may pass as well
    if (std::abs(inside.direction.dot(entry->normal)) < 0.01F) continue;
    ++hits;
    ASSERT_NEAR(found_m[i], entry->distance_m, 1e-3) << i;
  }
  EXPECT_GT(hits, 100000);
}

TEST(RayCaster, NoRaySlipsBetweenBoxesEndToEnd) {
  World world;
  world.solids = {makeWall({-3.0, 8.1}, {1.3, 8.1}, 0.2, 2.0),
                  makeWall({1.3, 8.1}, {4.9, 8.1}, 0.2, 2.0)};
  const RayCaster caster(world);
  const std::vector<Ray> rays = aimedAt({1.3, 8.0, 0.1}, {1.3, 8.0, 1.9}, 300000);
  const std::vector<float> found_m = caster.cast(rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays[i].direction.y() < 0.1F) continue;  // from behind, or along the wall
    const float to_face_m = (8.0F - rays[i].origin_m.y()) / rays[i].direction.y();
    ASSERT_NEAR(found_m[i], to_face_m, 1e-3) << i;
  }
}

TEST(Lidar, NoiseHasTheStatedDeviationAndNoBias) {
  LidarParameters p = perfect();
  p.range_sigma_m = 0.01;
  p.far_range_sigma_m = 0.03;
  p.far_range_m = 10.0;
  constexpr int kCount = 20000;
  for (const double distance_m : {1.0, 5.0, 9.0, 20.0}) {
    const std::vector<double> readings = readWall(p, distance_m, kCount);
    const double sigma_m = distance_m < 10.0 ? 0.01 : 0.03;
    EXPECT_NEAR(deviation(readings) / sigma_m, 1.0, 0.02) << distance_m;
    EXPECT_NEAR(mean(readings), distance_m, 3.0 * sigma_m / std::sqrt(kCount)) << distance_m;
  }
}

TEST(Lidar, NoiseGrowsWithTheRangeWhereThePresetSaysSo) {
  LidarParameters p = perfect();
  p.range_sigma_m = 0.01;
  p.range_sigma_per_m = 0.01;
  EXPECT_NEAR(deviation(readWall(p, 0.5, 20000)), 0.01, 2e-4);
  EXPECT_NEAR(deviation(readWall(p, 4.0, 20000)), 0.04, 8e-4);
}

TEST(Lidar, NoiseIsGaussianAndWithoutMemory) {
  LidarParameters p = perfect();
  p.range_sigma_m = 0.01;
  constexpr int kCount = 20000;
  std::vector<double> z = readWall(p, 5.0, kCount);
  for (double& reading : z) reading = (reading - 5.0) / 0.01;
  double product = 0.0;
  for (std::size_t i = 1; i < z.size(); ++i) product += z[i] * z[i - 1];
  EXPECT_NEAR(product / kCount, 0.0, 3.0 / std::sqrt(kCount));
  // Kolmogorov and Smirnov, 1 %: largest distance of the distributions 1.63 / sqrt(n).
  std::sort(z.begin(), z.end());
  double largest = 0.0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    const double expected = 0.5 * std::erfc(-z[i] / std::sqrt(2.0));
    largest = std::max(largest, std::abs(expected - (static_cast<double>(i) + 0.5) / kCount));
  }
  EXPECT_LT(largest, 1.63 / std::sqrt(kCount));
}

TEST(Lidar, BeamsOfOneScanHaveNoiseOfTheirOwn) {
  LidarParameters p = perfect();
  p.range_sigma_m = 0.01;
  const RayCaster room(makeRoom(8.0, 5.0));
  const SensorPath path = standing(laserAt(4.0, 2.5, 0.0));
  const Scan noisy = Lidar(p, 1).measure(0, 0, path, room);
  const Scan exact = Lidar(perfect(), 1).measure(0, 0, path, room);
  std::vector<double> errors;
  for (std::size_t i = 0; i < noisy.ranges_m.size(); ++i)
    errors.push_back(noisy.ranges_m[i] - exact.ranges_m[i]);
  EXPECT_NEAR(mean(errors), 0.0, 3.0 * 0.01 / std::sqrt(1081));
  EXPECT_NEAR(deviation(errors), 0.01, 0.001);
}

TEST(Lidar, NoiseDependsOnSeedAndScanOnly) {
  const RayCaster room(makeRoom(8.0, 5.0));
  const SensorPath path = standing(laserAt(4.0, 2.5, 0.0));
  const Lidar lidar({}, 1);
  const Scan seventh = lidar.measure(0, 7, path, room);
  const Scan eighth = lidar.measure(0, 8, path, room);
  EXPECT_EQ(lidar.measure(0, 7, path, room).ranges_m, seventh.ranges_m);
  EXPECT_NE(eighth.ranges_m, seventh.ranges_m);
  EXPECT_NE(Lidar({}, 2).measure(0, 7, path, room).ranges_m, seventh.ranges_m);
}

TEST(Lidar, TheWarmUpDriftDiesAwayWithItsTimeConstant) {
  LidarParameters p = perfect();
  p.warm_up_drift_m = 0.02;
  p.warm_up_time_s = 100.0;
  const RayCaster world(wallAt(5.0));
  const SensorPath path = standing(laserAt(0, 0, 0));
  p.beams = 2;
  p.angle_min_rad = 0.0;
  p.angle_max_rad = 0.1;
  const Lidar lidar(p, 1);
  for (const double running_s : {0.0, 100.0, 1000.0}) {
    const auto scan_index = static_cast<std::uint64_t>(running_s * p.scan_rate_hz);
    EXPECT_NEAR(lidar.measure(0, scan_index, path, world).ranges_m[0],
                5.0 + 0.02 * std::exp(-running_s / 100.0), 1e-5)
        << running_s;
  }
  p.warm_up_time_s = 0.0;
  EXPECT_THROW(p.validate(), std::invalid_argument);
}

TEST(Lidar, TheBiasIsTheSameForAllBeamsOfARunAndHasTheStatedDeviation) {
  LidarParameters p = perfect();
  p.range_bias_sigma_m = 0.005;
  p.beams = 2;
  const RayCaster world(wallAt(5.0));
  const SensorPath path = standing(laserAt(0, 0, 0));
  p.angle_min_rad = 0.0;
  p.angle_max_rad = 0.1;
  std::vector<double> biases;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    const Lidar lidar(p, seed);
    const Scan scan = lidar.measure(0, 0, path, world);
    biases.push_back(scan.ranges_m[0] - 5.0);
    ASSERT_NEAR(scan.ranges_m[1] - 5.0 / std::cos(0.1), biases.back(), 1e-5);
    ASSERT_EQ(lidar.measure(0, 1, path, world).ranges_m, scan.ranges_m);
  }
  EXPECT_NEAR(deviation(biases) / 0.005, 1.0, 3.0 / std::sqrt(2.0 * 2000));
}

TEST(Lidar, RoundsToItsResolution) {
  LidarParameters p = perfect();
  p.range_resolution_m = 0.01;
  EXPECT_THAT(readWall(p, 2.347, 3), Each(::testing::DoubleNear(2.35, 1e-6)));
  p.range_sigma_m = 0.02;
  for (const double reading : readWall(p, 2.0, 200))
    EXPECT_NEAR(reading / 0.01, std::round(reading / 0.01), 1e-3);
}

TEST(Lidar, SaysWithInfinityWhatIsOutOfRange) {
  EXPECT_EQ(readWall(perfect(), 30.5, 1)[0], kInfinity);
  EXPECT_EQ(readWall(perfect(), 0.05, 1)[0], -kInfinity);
  EXPECT_THAT(readWall(perfect(), 29.5, 1), Each(::testing::DoubleNear(29.5, 1e-4)));
  // Noise does not push readings past the limits.
  LidarParameters p = perfect();
  p.range_sigma_m = 0.05;
  int beyond = 0;
  for (const double reading : readWall(p, 30.0, 2000)) {
    ASSERT_TRUE(reading <= 30.0 || reading == kInfinity);
    beyond += reading == kInfinity ? 1 : 0;
  }
  EXPECT_NEAR(beyond, 1000, 3.0 * std::sqrt(500.0));
}

TEST(Lidar, StrayReadingsComeAsOftenAsStatedAndInFrontOfTheSurface) {
  LidarParameters p = perfect();
  p.outlier_probability = 0.05;
  constexpr int kCount = 20000;
  int strays = 0;
  for (const double reading : readWall(p, 5.0, kCount)) {
    if (std::abs(reading - 5.0) < 1e-4) continue;
    ++strays;
    EXPECT_LT(reading, 5.0);
  }
  EXPECT_NEAR(strays, 0.05 * kCount, 3.0 * std::sqrt(0.05 * 0.95 * kCount));
}

TEST(Lidar, EachBeamOfAMovingSensorStartsWhereTheSensorIs) {
  // Turning at 1 rad/s and driving at 1 m/s along x, towards a wall.
  const Lidar lidar(perfect(), 1);
  const LidarParameters& p = lidar.parameters();
  EXPECT_NEAR(p.sweep_s(), 0.01875, 1e-8);
  SensorPath path;
  for (int i = 0; i <= 25; ++i) {
    path.stamps_ns.push_back(1'000'000 * i);
    path.world_from_laser.push_back(laserAt(1.0 + 1e-3 * i, 2.5, 1e-3 * i));
  }
  const Scan scan = lidar.measure(2'000'000, 0, path, RayCaster(makeRoom(8.0, 5.0)));
  EXPECT_EQ(scan.stamp_ns, 2'000'000);
  for (int beam = 0; beam < p.beams; ++beam) {
    const double t = 0.002 + beam * p.time_increment_s;
    const double direction_rad = t + p.angle_min_rad + beam * p.angleIncrement_rad();
    ASSERT_NEAR(scan.ranges_m[static_cast<std::size_t>(beam)],
                wayToEdge_m(1.0 + t, 2.5, direction_rad, 8.0, 5.0), 2e-4)
        << beam;
  }
}

TEST(Lidar, PresetsAreTheDataSheets) {
  const auto read = [](const std::string& yaml) {
    ram_parameters::ParameterReader reader(YAML::Load(yaml), "test");
    return readLidarParameters(reader);
  };
  EXPECT_EQ(read("{preset: utm_30lx}").beams, 1081);
  EXPECT_NEAR(read("{preset: utm_30lx}").angleIncrement_rad(), 0.25 * M_PI / 180.0, 1e-9);
  EXPECT_EQ(read("{preset: urg_04lx}").beams, 682);
  EXPECT_NEAR(read("{preset: urg_04lx}").angleIncrement_rad(), 2.0 * M_PI / 1024.0, 1e-12);
  EXPECT_NEAR(read("{preset: urg_04lx}").sweep_s(), 0.0665, 1e-4);
  EXPECT_NEAR(read("{preset: sick_lms}").angleIncrement_rad(), 0.5 * M_PI / 180.0, 1e-12);
  EXPECT_EQ(read("{preset: sick_lms}").beams, 361);
  EXPECT_EQ(read("{preset: sick_lms_180}").beams, 180);
  EXPECT_NEAR(read("{preset: sick_lms_180}").angleIncrement_rad(), M_PI / 180.0, 1e-12);
  EXPECT_NEAR(read("{preset: sick_lms_180}").angle_min_rad, -M_PI_2, 1e-12);
  EXPECT_NEAR(read("{preset: utm_30lx}").sweep_s(), 0.01875, 1e-6);
  EXPECT_NEAR(read("{preset: urg_04lx}").scan_rate_hz, 10.0, 1e-12);
  // A turn without its end: the last beam is one increment before the first.
  const LidarParameters round = read("{preset: rplidar_a2}");
  EXPECT_NEAR(round.angle_max_rad + round.angleIncrement_rad() - round.angle_min_rad, 2.0 * M_PI,
              1e-12);
  EXPECT_NEAR(read("{preset: rplidar_a2}").angleIncrement_rad(), M_PI / 180.0, 1e-12);
  EXPECT_EQ(read("{preset: sick_lms, range_max_m: 8.0}").range_max_m, 8.0);
  EXPECT_THROW(read("{preset: velodyne}"), std::invalid_argument);
}

TEST(Lidar, RefusesBadParametersByName) {
  const auto refusal = [](void (*spoil)(LidarParameters&)) {
    LidarParameters p;
    spoil(p);
    try {
      p.validate();
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refusal([](LidarParameters& p) { p.beams = 1; }), HasSubstr("lidar.beams"));
  EXPECT_THAT(refusal([](LidarParameters& p) { p.angle_max_rad = 9.0; }),
              HasSubstr("angle_max_rad"));
  EXPECT_THAT(refusal([](LidarParameters& p) { p.range_min_m = 50.0; }), HasSubstr("range_max_m"));
  EXPECT_THAT(refusal([](LidarParameters& p) { p.time_increment_s = 1e-3; }),
              HasSubstr("time_increment_s"));
  EXPECT_THAT(refusal([](LidarParameters& p) { p.range_sigma_m = std::nan(""); }),
              HasSubstr("range_sigma_m"));
  EXPECT_THAT(refusal([](LidarParameters& p) { p.outlier_probability = 1.5; }),
              HasSubstr("outlier_probability"));
}

}  // namespace
}  // namespace ramscout_sim
