// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/slam_pipeline.hpp"

#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "ram_slam/parameter_files.hpp"
#include "ram_slam/pose_graph/g2o.hpp"
#include "ram_slam/world_map/landmark_layer.hpp"
#include "ramscout_bringup/named_file.hpp"
#include "ramscout_feature_detector/corner_matcher.hpp"
#include "ramscout_feature_detector/parameter_files.hpp"
#include "ramscout_kinematics/parameter_files.hpp"

namespace ramscout_bringup {
namespace {

using ram_slam::DropReason;
using ram_slam::Pose2;

template <typename Read>
auto readNode(const ParameterFiles& files,
              const std::string& name,
              const std::string& node,
              const Read& read) {
  return namingFile(files.path(name), [&] {
    ram_parameters::ParameterReader reader = files.reader(name, node);
    return read(reader);
  });
}

template <typename Read>
auto readNode(const ParameterFiles& files, const std::string& name, const Read& read) {
  return readNode(files, name, name, read);
}

/// The shipped noise is that of refined odometry; that of wheels alone is larger.
ramscout_kinematics::KinematicsParameters kinematicsParameters(const SlamParameters& parameters) {
  ramscout_kinematics::KinematicsParameters kinematics = parameters.kinematics;
  if (!parameters.use_laser_odometry) kinematics.noise_factor *= parameters.wheels_noise_factor;
  return kinematics;
}

std::vector<MapLandmark> toMapLandmarks(const ram_slam::LandmarkMap& map) {
  std::vector<MapLandmark> landmarks;
  for (const ram_slam::LandmarkEstimate& estimate : map.landmarks) {
    landmarks.push_back({estimate.id, estimate.type, estimate.classifier, estimate.mean_m,
                         estimate.covariance_m2, estimate.existence_log_odds});
  }
  return landmarks;
}

}  // namespace

void SlamParameters::useBatchSettings() {
  estimator_stage.minimum_distance_m = 0.03;
  estimator_stage.minimum_angle_rad = 0.03;
  map_smoother.optimize_period_s = 0.0;
  map_smoother.key_scans.pose_per_scan = true;
  occupancy_mapper.max_scan_count = 10'000'000;  // the most that it takes
}

ram_slam::FeatureMatchers featureMatchers() {
  return {{ramscout_feature_detector::kCornerType,
           std::make_shared<const ramscout_feature_detector::CornerMatcher>()}};
}

SlamParameters readSlamParameters(const ParameterFiles& files, const std::string& estimator) {
  using ram_parameters::ParameterReader;
  const char* estimator_node = "fast_slam";
  SlamParameters parameters;
  parameters.laser_odometry =
      readNode(files, "laser_odometry", ram_slam::readLaserOdometryParameters);
  parameters.feature_detector =
      readNode(files, "feature_detector", ramscout_feature_detector::readFeatureDetectorParameters);
  parameters.kinematics =
      readNode(files, "kinematics", ramscout_kinematics::readKinematicsParameters);
  parameters.estimator = readNode(files, estimator, estimator_node, [&](ParameterReader& reader) {
    return ram_slam::findEstimator(estimator)(reader, featureMatchers());
  });
  const auto filter = ram_slam::filters().find(estimator);
  if (filter != ram_slam::filters().end()) {
    parameters.filter = readNode(files, estimator, estimator_node, [&](ParameterReader& reader) {
      return filter->second.read(reader, featureMatchers());
    });
    parameters.recovery =
        readNode(files, estimator, estimator_node, ram_slam::readRecoveryParameters);
  }
  parameters.map_smoother = readNode(files, "map_smoother", ram_slam::readMapSmootherParameters);
  parameters.occupancy_mapper =
      readNode(files, "occupancy_mapper", ram_slam::readOccupancyMapperParameters);
  return parameters;
}

SlamParameters readSlamParameters(const std::string& folder, const std::string& estimator) {
  return readSlamParameters(ParameterFiles(folder), estimator);
}

std::vector<ChangedParameter> changedParameters(const std::string& folder,
                                                const std::string& estimator) {
  const std::set<std::string> names = {"laser_odometry.yaml", "feature_detector.yaml",
                                       "kinematics.yaml",     estimator + ".yaml",
                                       "map_smoother.yaml",   "occupancy_mapper.yaml"};
  std::vector<ChangedParameter> changed;
  for (const auto& files : {ram_slam::parameterFiles(), ramscout_feature_detector::parameterFiles(),
                            ramscout_kinematics::parameterFiles()}) {
    for (const ram_parameters::ParameterFile& file : files) {
      if (names.count(file.name) == 0) continue;
      const auto more =
          changedParameters(ram_parameters::readYamlFile(folder + "/" + file.name), file);
      changed.insert(changed.end(), more.begin(), more.end());
    }
  }
  return changed;
}

SlamPipeline::SlamPipeline(const SlamParameters& parameters)
    : parameters_(parameters),
      odometry_(parameters.laser_odometry, parameters.use_laser_odometry),
      feature_detector_(parameters.feature_detector),
      kinematics_(kinematicsParameters(parameters)),
      estimator_(parameters.estimator, kinematics_, parameters.estimator_stage),
      smoothing_(parameters.map_smoother, featureMatchers()),
      mapping_(parameters.occupancy_mapper) {}

void SlamPipeline::add(const ram_slam::StampedPose2& odometry) {
  const auto passed = wheels_guard_.add(odometry.stamp_ns, odometry, odometry_.drops());
  for (const ram_slam::StampedPose2& reading : passed.messages) use(reading);
}

void SlamPipeline::add(ram_slam::MountedScan scan) {
  const std::int64_t stamp_ns = scan.scan.stamp_ns;
  auto passed = scan_guard_.add(stamp_ns, std::move(scan), odometry_.drops());
  for (ram_slam::MountedScan& usable : passed.messages) use(std::move(usable));
}

void SlamPipeline::use(const ram_slam::StampedPose2& odometry) {
  if (!odometry_.addWheels(odometry)) return;
  report_.addWheels(odometry);
  if (!parameters_.use_laser_odometry) feedKinematics(odometry);
  drain();
}

void SlamPipeline::use(ram_slam::MountedScan scan) {
  if (smooths()) {
    // As the node does: by what is known when the scan comes.
    ram_slam::MountedScan known = scan;
    known.scan = corrected(std::move(known.scan), odometry_.lidarCalibration().addedMirrorTurn_s());
    smoothing_.add(std::move(known));
  }
  odometry_.add(std::move(scan));
  drain();
}

void SlamPipeline::drain() {
  while (const auto step = odometry_.next()) process(*step);
}

void SlamPipeline::feedKinematics(const ram_slam::StampedPose2& odom_from_base) {
  try {
    kinematics_.add({odom_from_base.stamp_ns, odom_from_base.pose});
  } catch (const std::exception& error) {
    odometry_.drops().add(DropReason::kInvalidOdometry, odom_from_base.stamp_ns, error.what());
  }
}

void SlamPipeline::process(const ram_slam::OdometryStep& step) {
  const std::int64_t stamp_ns = step.scan.scan.stamp_ns;
  report_.addStep(step, parameters_.use_laser_odometry);
  if (parameters_.use_laser_odometry) {
    for (const ram_slam::StampedPose2& pose : step.between) feedKinematics(pose);
    feedKinematics({stamp_ns, step.estimate.odom_from_base.pose});
  }
  estimator_.followMapPoses();
  if (smooths()) smooth(step);
  const auto motion = estimator_.motionUntil(stamp_ns);
  if (!motion) {
    estimator_.bridgeGap(stamp_ns);
    return;
  }
  if (estimator_.isDue(*motion)) updateEstimator(step.scan, *motion);
  if (const auto change = estimator_.takeTrackingChange()) {
    // In the end the smoother knows where each scan was taken, also while the estimator was lost.
    if (smooths()) {
      smoothing_.set(*change);
    } else {
      mapping_.set(*change);
    }
  }
  estimator_.followCorrection();
  if (!estimator_.estimator().started()) return;
  const Pose2 map_from_base = estimator_.poseAt(*motion);
  online_.push_back({stamp_ns, map_from_base});
  mapping_.add(step.scan, map_from_base, {});
}

void SlamPipeline::smooth(const ram_slam::OdometryStep& step) {
  smoothing_.addOdometry({step.scan.scan.stamp_ns, step.estimate.odom_from_base.pose});
  while (auto smoothed = smoothing_.next()) {
    if (smoothed->correction) estimator_.addCorrection(std::move(*smoothed->correction));
    if (smoothed->map_from_base)
      estimator_.addMapPose({smoothed->stamp_ns, *smoothed->map_from_base});
  }
}

void SlamPipeline::updateEstimator(const ram_slam::MountedScan& scan,
                                   const ram_slam::MotionStep& motion) {
  try {
    const ram_slam::FeatureList features =
        feature_detector_.detect(scan.scan, scan.base_from_laser);
    if (smooths()) smoothing_.addFeatures(features);
    estimator_.update(features, motion,
                      std::make_shared<const ram_slam::LaserView>(scan.scan, scan.base_from_laser));
    report_.addReading(features, estimator_.estimator());
  } catch (const std::exception& error) {
    estimator_.drops().add(DropReason::kInvalidScan, scan.scan.stamp_ns, error.what());
  }
}

Results SlamPipeline::finish() {
  for (const auto& reading : wheels_guard_.finish(odometry_.drops()).messages) use(reading);
  for (auto& scan : scan_guard_.finish(odometry_.drops()).messages) use(std::move(scan));
  odometry_.finish();
  drain();
  if (online_.empty()) {
    const auto drops = odometry_.drops().all();
    throw std::runtime_error(drops.empty()
                                 ? "the recording has no scan"
                                 : "no scan could be used: " + toText(drops.front().reason) + ": " +
                                       drops.front().detail);
  }
  Results results;
  results.trajectory_online = online_;
  results.trajectory_filter = results.trajectory = estimator_.estimator().trajectory();
  results.landmarks = toMapLandmarks(estimator_.estimator().landmarks());
  if (smooths()) smoothFinally(results);
  mapping_.correct(results.trajectory);
  mapping_.draw();
  results.map = mapping_.mapper().grid();
  std::string world_error;
  try {
    results.world = worldOf(results);
  } catch (const std::exception& error) {
    world_error = error.what();
  }
  results.odometry = report_.wheels();
  results.measurements = report_.measurements();
  results.summary = report_.summary({odometry_, estimator_, smoothing_, mapping_, results,
                                     parameters_.use_laser_odometry, smooths()});
  if (!world_error.empty()) results.summary["map_to_continue"] = "none: " + world_error;
  return results;
}

ram_slam::WorldMap SlamPipeline::worldOf(const Results& results) const {
  ram_slam::WorldMap world;
  const std::int64_t stamp_ns = results.trajectory_online.back().stamp_ns;
  world.put(
      ram_slam::LocalOccupancy{stamp_ns, parameters_.occupancy_mapper.map_frame, {}, results.map});
  world.put(ram_slam::toLandmarkLayer(estimator_.estimator().landmarks()));
  world.put(results.trajectory);
  world.put(mapping_.scans());
  return world;
}

void SlamPipeline::smoothFinally(Results& results) {
  results.trajectory = smoothing_.optimize();
  if (!estimator_.estimator().isLost())
    results.trajectory = estimator_.follow(std::move(results.trajectory));
  results.landmarks = toMapLandmarks(estimator_.estimator().landmarks());
  std::ostringstream graph;
  ram_slam::writeG2o(smoothing_.smoother().graph(), graph);
  results.pose_graph_g2o = graph.str();
  results.closures = closureRecords(smoothing_.smoother());
}

}  // namespace ramscout_bringup
