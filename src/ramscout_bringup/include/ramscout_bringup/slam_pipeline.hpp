// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ram_slam/estimation/estimator_registry.hpp"
#include "ram_slam/fast_slam/landmark_filter.hpp"
#include "ram_slam/occupancy/occupancy_mapper_parameters.hpp"
#include "ram_slam/scan_matching/laser_odometry.hpp"
#include "ram_slam/smoothing/map_smoother.hpp"
#include "ram_slam/stages/estimator_stage.hpp"
#include "ram_slam/stages/input_guard.hpp"
#include "ram_slam/stages/mapping_stage.hpp"
#include "ram_slam/stages/odometry_stage.hpp"
#include "ram_slam/stages/smoothing_stage.hpp"
#include "ram_slam/tracking/tracker.hpp"
#include "ramscout_bringup/parameter_files.hpp"
#include "ramscout_bringup/recording.hpp"
#include "ramscout_bringup/results.hpp"
#include "ramscout_bringup/run_report.hpp"
#include "ramscout_feature_detector/feature_detector.hpp"
#include "ramscout_kinematics/kinematics.hpp"

namespace ramscout_bringup {

/// Parameters of all stages, as the nodes read them, and which of the optional stages take part.
struct SlamParameters {
  ram_slam::LaserOdometryParameters laser_odometry;
  ramscout_feature_detector::FeatureDetectorParameters feature_detector;
  ramscout_kinematics::KinematicsParameters kinematics;
  /// By which the variance of the motion is larger for wheels alone than for refined odometry.
  double wheels_noise_factor = 1000.0;
  ram_slam::EstimatorFactory estimator;
  /// For tools that look into the filter; none if the estimator is of another package.
  ram_slam::LandmarkFilterFactory filter;
  ram_slam::RecoveryParameters recovery;  ///< likewise
  ram_slam::EstimatorStageParameters estimator_stage;
  ram_slam::MapSmootherParameters map_smoother;
  ram_slam::OccupancyMapperParameters occupancy_mapper;
  bool use_laser_odometry = true;  ///< off: the kinematic model is fed by the wheels as they are
  bool use_map_smoother = true;    ///< off: the final trajectory is the estimator's own

  /// What a recording needs other than a live robot, since only the end counts and time is short:
  /// the estimator takes in readings after some motion only, the smoother optimises at the end
  /// only, and the map keeps all its scans.
  void useBatchSettings();
};

/// Reads the parameters of each node.
/// \param estimator  as in ram_slam::estimatorNames(); it reads `<estimator>.yaml`
/// \throws std::runtime_error if a file cannot be read
/// \throws std::invalid_argument if a parameter is refused
SlamParameters readSlamParameters(const ParameterFiles& files,
                                  const std::string& estimator = "fast_slam");
/// Without a robot's or a lidar's file.
SlamParameters readSlamParameters(const std::string& folder,
                                  const std::string& estimator = "fast_slam");

/// What differs from the defaults in the files that readSlamParameters() reads.
std::vector<ChangedParameter> changedParameters(const std::string& folder,
                                                const std::string& estimator);

/// The matchers that the feature detectors of this workspace bring, by feature type.
ram_slam::FeatureMatchers featureMatchers();

/// The stages of the ROS graph in one process, fed in the order of the stamps.
///
/// As in the graph the scans set the pace: a scan is dealt with once odometry reaches its stamp, so
/// that the motion up to it is known. Without any odometry the motion comes from the scans alone.
/// What a stage drops it counts by reason.
class SlamPipeline {
public:
  /// \throws std::invalid_argument if a stage refuses its parameters
  explicit SlamPipeline(const SlamParameters& parameters);

  /// Odometry: odom_from_base.
  void add(const ram_slam::StampedPose2& odometry);
  void add(ram_slam::MountedScan scan);

  /// Deals with what still waits, and gives the final estimate and the map drawn from it. Call
  /// once, at the end. \throws std::runtime_error if no scan could be used
  Results finish();

  const ram_slam::Estimator& estimator() const { return estimator_.estimator(); }

private:
  void use(const ram_slam::StampedPose2& odometry);
  void use(ram_slam::MountedScan scan);
  void drain();
  void process(const ram_slam::OdometryStep& step);
  void feedKinematics(const ram_slam::StampedPose2& odom_from_base);
  void smooth(const ram_slam::OdometryStep& step);
  void updateEstimator(const ram_slam::MountedScan& scan, const ram_slam::MotionStep& motion);
  bool smooths() const { return parameters_.use_laser_odometry && parameters_.use_map_smoother; }
  void smoothFinally(Results& results);
  /// The map as a robot can continue it or localise in it.
  /// \throws as WorldMap::put(), if the map is larger than one can hold
  ram_slam::WorldMap worldOf(const Results& results) const;

  SlamParameters parameters_;
  ram_slam::InputGuard<ram_slam::StampedPose2> wheels_guard_;
  ram_slam::InputGuard<ram_slam::MountedScan> scan_guard_;
  ram_slam::OdometryStage odometry_;
  ramscout_feature_detector::FeatureDetector feature_detector_;
  ramscout_kinematics::Kinematics kinematics_;
  ram_slam::EstimatorStage estimator_;
  ram_slam::SmoothingStage smoothing_;
  ram_slam::MappingStage mapping_;
  Trajectory online_;
  RunReport report_;
};

}  // namespace ramscout_bringup
