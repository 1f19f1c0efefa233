// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/slam_pipeline.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "ram_slam/trajectory.hpp"
#include "ramscout_bringup/evaluation.hpp"
#include "ramscout_feature_detector/corner_matcher.hpp"

namespace ramscout_bringup {
namespace {

using ram_slam::Pose2;

template <typename Read>
auto readFile(const std::string& folder, const std::string& node, const Read& read) {
  const std::string path = folder + "/" + node + ".yaml";
  ram_parameters::ParameterReader reader(ram_parameters::readYamlFile(path), path);
  return read(reader);
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

SlamParameters readSlamParameters(const std::string& folder) {
  return {readFile(folder, "feature_detector",
                   ramscout_feature_detector::readFeatureDetectorParameters),
          readFile(folder, "kinematics", ramscout_kinematics::readKinematicsParameters),
          readFile(folder, "fast_slam", ram_slam::readFastSlamParameters),
          readFile(folder, "occupancy_mapper", ram_slam::readOccupancyMapperParameters)};
}

SlamPipeline::SlamPipeline(const SlamParameters& parameters)
    : parameters_(parameters),
      feature_detector_(parameters.feature_detector),
      kinematics_(parameters.kinematics),
      fast_slam_(parameters.fast_slam,
                 {{ramscout_feature_detector::kCornerType,
                   std::make_shared<const ramscout_feature_detector::CornerMatcher>()}}) {}

void SlamPipeline::add(const OdometryReading& reading) {
  try {
    kinematics_.add({reading.stamp_ns, reading.odom_from_base});
    odometry_ns_ = reading.stamp_ns;
  } catch (const std::exception& error) {
    leaveOut(error.what());
  }
  while (!waiting_.empty() && odometry_ns_ && waiting_.front().stampNs() <= *odometry_ns_) {
    process(waiting_.front());
    waiting_.pop_front();
  }
}

void SlamPipeline::add(ScanReading reading) {
  if (odometry_ns_ && reading.stampNs() <= *odometry_ns_) {
    process(reading);
  } else {
    waiting_.push_back(std::move(reading));
  }
}

void SlamPipeline::process(const ScanReading& reading) {
  try {
    const ram_slam::FeatureList features =
        feature_detector_.detect(reading.scan, reading.base_from_laser);
    const ram_slam::LaserView view(reading.scan, reading.base_from_laser);
    fast_slam_.update(features, kinematics_, &view);
    feature_count_ += features.features.size();
    const Pose2 map_from_base = fast_slam_.estimate().pose;
    online_.push_back({reading.stampNs(), map_from_base});
    if (isKeyScan(map_from_base * reading.base_from_laser)) key_scans_.push_back(reading);
  } catch (const std::exception& error) {
    leaveOut(error.what());
  }
}

bool SlamPipeline::isKeyScan(const Pose2& map_from_laser) {
  if (last_key_) {
    const Pose2 motion = last_key_->inverse() * map_from_laser;
    if (motion.translation().norm() < parameters_.occupancy_mapper.key_distance_m &&
        std::abs(motion.yaw_rad) < parameters_.occupancy_mapper.key_angle_rad) {
      return false;
    }
  }
  last_key_ = map_from_laser;
  return true;
}

Results SlamPipeline::finish() {
  for (const ScanReading& reading : waiting_) process(reading);
  waiting_.clear();
  if (online_.empty()) {
    throw std::runtime_error(left_out_.empty()
                                 ? "the recording has no scan"
                                 : "no scan could be used: " + left_out_.begin()->first);
  }
  Results results;
  results.trajectory_online = online_;
  results.trajectory = fast_slam_.trajectory();
  results.landmarks = toMapLandmarks(fast_slam_.landmarks());
  results.map = renderMap(results.trajectory);
  nlohmann::ordered_json left_out = nlohmann::ordered_json::object();
  for (const auto& [reason, count] : left_out_) left_out[reason] = count;
  results.summary = {
      {"poses", results.trajectory.size()},
      {"duration_s",
       static_cast<double>(online_.back().stamp_ns - online_.front().stamp_ns) * 1e-9},
      {"distance_m", pathLength(results.trajectory)},
      {"features_per_scan",
       static_cast<double>(feature_count_) / static_cast<double>(online_.size())},
      {"landmarks", results.landmarks.size()},
      {"key_scans", key_scans_.size()},
      {"left_out", left_out}};
  return results;
}

ram_slam::OccupancyGrid SlamPipeline::renderMap(const Trajectory& trajectory) {
  ram_slam::OccupancyMapper mapper(parameters_.occupancy_mapper);
  for (const ScanReading& reading : key_scans_) {
    const auto map_from_base = ram_slam::poseAt(trajectory, reading.stampNs());
    if (!map_from_base) continue;
    try {
      mapper.add(reading.scan, *map_from_base * reading.base_from_laser);
    } catch (const std::exception& error) {
      leaveOut(error.what());
    }
  }
  return mapper.grid();
}

}  // namespace ramscout_bringup
