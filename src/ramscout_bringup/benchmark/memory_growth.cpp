// SPDX-License-Identifier: BSD-3-Clause
// Drives rounds in a simulated office through the stages of the nodes, then rests, and reports what
// each stage keeps and how large its messages are:
//   memory_growth CONFIG_FOLDER DRIVE_MINUTES REST_MINUTES
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <memory>
#include <new>

#include <ramscout_bringup/slam_pipeline.hpp>
#include <ramscout_sim/office.hpp>

#include "simulated_robot.hpp"

namespace {

enum Stage : std::size_t { kOther, kOdometry, kFeatures, kEstimator, kSmoother, kMapper, kStages };

std::array<std::int64_t, kStages> kept_bytes{};
Stage current = kOther;

/// In front of each block: who asked for it.
struct alignas(16) Header {
  std::size_t size = 0;
  Stage stage = kOther;
};

class Asks {
public:
  explicit Asks(Stage stage) : before_(current) { current = stage; }
  ~Asks() { current = before_; }
  Asks(const Asks&) = delete;
  Asks& operator=(const Asks&) = delete;

private:
  Stage before_;
};

}  // namespace

void* operator new(std::size_t size) {
  auto* header = static_cast<Header*>(std::malloc(size + sizeof(Header)));
  if (header == nullptr) throw std::bad_alloc();
  *header = {size, current};
  kept_bytes[current] += static_cast<std::int64_t>(size + sizeof(Header));
  return header + 1;
}

void operator delete(void* block) noexcept {
  if (block == nullptr) return;
  Header* header = static_cast<Header*>(block) - 1;
  kept_bytes[header->stage] -= static_cast<std::int64_t>(header->size + sizeof(Header));
  std::free(header);
}

void operator delete(void* block, std::size_t /*size*/) noexcept {
  operator delete(block);
}

namespace {

using namespace ramscout_bringup;

/// The stages with the settings of the nodes, one after the other.
class Stages {
public:
  explicit Stages(const SlamParameters& parameters)
      : odometry_(parameters.laser_odometry),
        detector_(parameters.feature_detector),
        kinematics_(parameters.kinematics),
        estimator_(parameters.estimator, kinematics_, parameters.estimator_stage),
        smoother_(parameters.map_smoother, featureMatchers()),
        mapper_(parameters.occupancy_mapper) {}

  void add(const SimulatedRobot::Reading& reading, const ram_slam::Pose2& base_from_laser) {
    {
      const Asks asks(kSmoother);
      smoother_.add({reading.scan, base_from_laser});
    }
    const Asks asks(kOdometry);
    odometry_.addWheels({reading.scan.stamp_ns, reading.odom_from_base});
    odometry_.add({reading.scan, base_from_laser});
    while (const auto step = odometry_.next()) process(*step);
  }

  void print(double minutes, double driven_m) {
    std::printf("%6.1f min %7.0f m |", minutes, driven_m);
    for (const Stage stage : {kOdometry, kFeatures, kEstimator, kSmoother, kMapper})
      std::printf(" %8.2f", 1e-6 * static_cast<double>(kept_bytes[stage]));
    std::printf(" | %7zu %7zu %7zu | %6zu %6zu %6zu\n", estimator_.estimator().trajectory().size(),
                smoother_.smoother().trajectory().size(), largest_correction_,
                smoother_.smoother().keyScans().size(), smoother_.smoother().closures().size(),
                mapper_.scanCount());
    std::fflush(stdout);
    largest_correction_ = 0;
  }

private:
  void process(const ram_slam::OdometryStep& step) {
    const std::int64_t stamp_ns = step.scan.scan.stamp_ns;
    {
      const Asks asks(kEstimator);
      kinematics_.add({stamp_ns, step.estimate.odom_from_base.pose});
      estimator_.followMapPoses();
    }
    {
      const Asks asks(kSmoother);
      smoother_.addOdometry({stamp_ns, step.estimate.odom_from_base.pose});
      while (auto smoothed = smoother_.next()) follow(*smoothed);
    }
    {
      const Asks asks(kFeatures);
      const auto features = detector_.detect(step.scan.scan, step.scan.base_from_laser);
      {
        const Asks smoother_asks(kSmoother);
        smoother_.addFeatures(features);
      }
      const Asks estimator_asks(kEstimator);
      const auto motion = estimator_.motionUntil(stamp_ns);
      if (!motion) return;
      estimator_.update(
          features, *motion,
          std::make_shared<const ram_slam::LaserView>(step.scan.scan, step.scan.base_from_laser));
      if (auto corrected = estimator_.followCorrection()) {
        const Asks mapper_asks(kMapper);
        mapper_.correct(*corrected);
      }
    }
    const Asks asks(kMapper);
    mapper_.add(step.scan, estimator_.estimator().estimate().pose, {});
    if (++scans_ % 40 == 0) mapper_.draw();
  }

  void follow(ram_slam::SmoothingStep& smoothed) {
    const Asks asks(kEstimator);
    if (smoothed.map_from_base) estimator_.addMapPose({smoothed.stamp_ns, *smoothed.map_from_base});
    if (!smoothed.correction) return;
    largest_correction_ = std::max(largest_correction_, smoothed.correction->size());
    estimator_.addCorrection(std::move(*smoothed.correction));
  }

  ram_slam::OdometryStage odometry_;
  ramscout_feature_detector::FeatureDetector detector_;
  ramscout_kinematics::Kinematics kinematics_;
  ram_slam::EstimatorStage estimator_;
  ram_slam::SmoothingStage smoother_;
  ram_slam::MappingStage mapper_;
  std::size_t largest_correction_ = 0;  ///< poses, since print()
  std::size_t scans_ = 0;
};

ramscout_sim::Tour rounds(const ramscout_sim::Tour& once, double length_m) {
  ramscout_sim::Tour tour = once;
  while (tour.length_m() < length_m) {
    for (const Eigen::Vector2d& point_m : once.waypoints_m)
      if (point_m != tour.waypoints_m.back()) tour.waypoints_m.push_back(point_m);
  }
  return tour;
}

void run(const std::string& config, double drive_min, double rest_min) {
  ramscout_sim::OfficeParameters office_parameters;
  office_parameters.blocks_along_x = 1;
  const ramscout_sim::Office office = ramscout_sim::generateOffice(office_parameters);
  SimulatedRobot robot(ParameterFiles(config, kReferenceRobot), office.world, 1);
  const double speed_mps = office.tour.speed_mps;
  ramscout_sim::TourDriver driver(rounds(office.tour, 60.0 * drive_min * speed_mps * 1.2));
  ramscout_sim::TourDriver none(
      {{robot.position_m(), robot.position_m() + Eigen::Vector2d(0.01, 0.0)}});
  Stages stages(readSlamParameters(config));
  std::printf("one round %.0f m\n", office.tour.length_m());
  std::printf(
      "                     | MB: odom  feature estimator smoother   mapper | poses: path "
      "smoother largest correction | key scans, closures, mapped scans\n");
  const std::int64_t start_ns = robot.now_ns();
  const double end_min = drive_min + rest_min;
  double driven_m = 0.0;
  double next_min = 0.0;
  Eigen::Vector2d last_m = robot.position_m();
  for (double minutes = 0.0; minutes < end_min;) {
    minutes = 1e-9 * static_cast<double>(robot.now_ns() - start_ns) / 60.0;
    stages.add(robot.drive(minutes < drive_min ? driver : none), robot.baseFromLaser());
    driven_m += (robot.position_m() - last_m).norm();
    last_m = robot.position_m();
    if (minutes < next_min) continue;
    next_min += 5.0;
    stages.print(minutes, driven_m);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: memory_growth CONFIG_FOLDER DRIVE_MINUTES REST_MINUTES\n";
    return EXIT_FAILURE;
  }
  try {
    run(argv[1], std::atof(argv[2]), std::atof(argv[3]));
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
