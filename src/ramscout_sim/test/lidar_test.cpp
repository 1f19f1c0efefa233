// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include "ramscout_sim/random.hpp"

#include "shared.hpp"
#include "spoiled_parameters.hpp"

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

/// Readings of one beam that meets a wall head-on.
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

TEST(Lidar, ReportsInfinityForWhatIsOutOfRange) {
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
  const auto refusal = &testing::refusalOfSpoiled<LidarParameters>;
  EXPECT_THAT(refusal([](LidarParameters& p) { p.beams = 1; }), HasSubstr("beams"));
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
