// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/slam_pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "ram_slam/calibration/mount_calibration.hpp"
#include "ram_slam/geometry/trajectory.hpp"
#include "ramscout_bringup/evaluation.hpp"
#include "ramscout_feature_detector/corner_matcher.hpp"

namespace ramscout_bringup {
namespace {

using ram_slam::Pose2;

constexpr std::size_t kKeptReadings = 1000;  // of the wheels: some seconds
// From nearer than this to its last reading the filter is shown no other, unless so much later
// that the kinematics may forget the motion since.
constexpr double kTeachingDistanceM = 0.03;
constexpr double kTeachingAngleRad = 0.03;
constexpr std::int64_t kTeachingPeriodNs = 10'000'000'000;
constexpr std::int64_t kCalibrationStepNs = 20'000'000;
constexpr std::size_t kMaxWaitingScans = 100;  // for odometry that may never come

template <typename Read>
auto readFile(const std::string& folder, const std::string& node, const Read& read) {
  const std::string path = folder + "/" + node + ".yaml";
  ram_parameters::ParameterReader reader(ram_parameters::readYamlFile(path), path);
  return read(reader);
}

ram_slam::FeatureMatchers matchers() {
  return {{ramscout_feature_detector::kCornerType,
           std::make_shared<const ramscout_feature_detector::CornerMatcher>()}};
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
  SlamParameters parameters;
  parameters.laser_odometry =
      readFile(folder, "laser_odometry", ram_slam::readLaserOdometryParameters);
  parameters.feature_detector = readFile(folder, "feature_detector",
                                         ramscout_feature_detector::readFeatureDetectorParameters);
  parameters.kinematics =
      readFile(folder, "kinematics", ramscout_kinematics::readKinematicsParameters);
  std::tie(parameters.fast_slam, parameters.recovery) =
      readFile(folder, "fast_slam", [](ram_parameters::ParameterReader& reader) {
        const ram_slam::FastSlamParameters filter = ram_slam::readFastSlamParameters(reader);
        return std::pair(filter, ram_slam::readRecoveryParameters(reader));
      });
  parameters.map_smoother = readFile(folder, "map_smoother", ram_slam::readMapSmootherParameters);
  parameters.occupancy_mapper =
      readFile(folder, "occupancy_mapper", ram_slam::readOccupancyMapperParameters);
  return parameters;
}

SlamPipeline::SlamPipeline(const SlamParameters& parameters)
    : parameters_(parameters),
      laser_odometry_(parameters.laser_odometry),
      stamp_offset_(parameters.laser_odometry.max_stamp_offset_s),
      feature_detector_(parameters.feature_detector),
      kinematics_(parameters.kinematics),
      motion_(kinematics_),
      fast_slam_(parameters.fast_slam, parameters.recovery, matchers()),
      map_smoother_(parameters.map_smoother, matchers()) {}

void SlamPipeline::add(const OdometryReading& reading) {
  if (!wheels_.empty() && reading.stamp_ns <= wheels_.back().stamp_ns) {
    leaveOut("odometry with the stamp of another");
    return;
  }
  wheels_.push_back({reading.stamp_ns, reading.odom_from_base});
  if (all_wheels_.empty() || reading.stamp_ns - all_wheels_.back().stamp_ns >= kCalibrationStepNs)
    all_wheels_.push_back({reading.stamp_ns, reading.odom_from_base});
  while (wheels_.size() > kKeptReadings) wheels_.pop_front();
  if (!parameters_.use_laser_odometry) feedKinematics(reading.stamp_ns, reading.odom_from_base);
  stamp_offset_.addWheels({reading.stamp_ns, reading.odom_from_base});
  while (!waiting_.empty() &&
         waiting_.front().stampNs() + stamp_offset_.offset_ns() <= reading.stamp_ns) {
    process(waiting_.front());
    waiting_.pop_front();
  }
}

void SlamPipeline::add(ScanReading reading) {
  const bool reached =
      !wheels_.empty() && reading.stampNs() + stamp_offset_.offset_ns() <= wheels_.back().stamp_ns;
  waiting_.push_back(std::move(reading));
  if (!reached && waiting_.size() <= kMaxWaitingScans) return;
  process(waiting_.front());
  waiting_.pop_front();
}

void SlamPipeline::feedKinematics(std::int64_t stamp_ns, const Pose2& odom_from_base) {
  try {
    kinematics_.add({stamp_ns, odom_from_base});
  } catch (const std::exception& error) {
    leaveOut(error.what());
  }
}

void SlamPipeline::process(const ScanReading& reading) {
  try {
    if (parameters_.use_laser_odometry) refineOdometry(reading);
    if (teachesFilter(reading.stampNs())) updateFilter(reading);
    if (smooths() && fast_slam_.started()) followSmoother();
    const Pose2 map_from_base = poseNow(reading.stampNs());
    online_.push_back({reading.stampNs(), map_from_base});
    if (isKeyScan(map_from_base * reading.base_from_laser)) key_scans_.push_back(reading);
  } catch (const std::exception& error) {
    leaveOut(error.what());
  }
}

bool SlamPipeline::teachesFilter(std::int64_t stamp_ns) const {
  if (!fast_slam_.started() || stamp_ns - fast_slam_.stamp_ns() >= kTeachingPeriodNs) return true;
  try {
    const Pose2 moved = kinematics_.motion(fast_slam_.stamp_ns(), stamp_ns).pose;
    return moved.translation().norm() >= kTeachingDistanceM ||
           std::abs(moved.yaw_rad) >= kTeachingAngleRad;
  } catch (const std::out_of_range&) {
    return true;  // it bridges the gap
  }
}

Pose2 SlamPipeline::poseNow(std::int64_t stamp_ns) const {
  const Pose2 then = fast_slam_.estimate().pose;
  return stamp_ns == fast_slam_.stamp_ns()
             ? then
             : then * kinematics_.motion(fast_slam_.stamp_ns(), stamp_ns).pose;
}

void SlamPipeline::updateFilter(const ScanReading& reading) {
  const ram_slam::FeatureList features =
      feature_detector_.detect(reading.scan, reading.base_from_laser);
  if (smooths()) map_smoother_.addFeatures(features);
  const auto view =
      std::make_shared<const ram_slam::LaserView>(reading.scan, reading.base_from_laser);
  const bool was_lost = fast_slam_.lost();
  try {
    fast_slam_.update(features, motion_, view);
    if (fast_slam_.lost() && !was_lost) ++lost_count_;
  } catch (const std::out_of_range&) {
    // The odometry was interrupted: as in the node the filter goes on from here with a very
    // uncertain pose.
    motion_.interruptedUntil(reading.stampNs());
    throw;
  }
  motion_.forget();
  feature_count_ += features.features.size();
  ++list_count_;
}

void SlamPipeline::refineOdometry(const ScanReading& reading) {
  const ram_slam::LaserOdometryEstimate estimate =
      laser_odometry_.update(reading.scan, reading.base_from_laser,
                             wheelsAt(reading.stampNs() + stamp_offset_.offset_ns()));
  stamp_offset_.addScan({reading.stampNs(), estimate.odom_from_base.pose});
  slip_count_ += estimate.wheels_slipped ? 1 : 0;
  feedKinematics(reading.stampNs(), estimate.odom_from_base.pose);
  if (smooths()) {
    map_smoother_.addScan(reading.scan, reading.base_from_laser, estimate.odom_from_base.pose);
  }
}

std::optional<Pose2> SlamPipeline::wheelsAt(std::int64_t stamp_ns) const {
  if (wheels_.empty() || stamp_ns < wheels_.front().stamp_ns) return std::nullopt;
  if (stamp_ns > wheels_.back().stamp_ns) return wheels_.back().pose;
  return ram_slam::odometryAt(wheels_, stamp_ns);
}

void SlamPipeline::followSmoother() {
  if (fast_slam_.lost() || !map_smoother_.hasCorrection()) return;
  fast_slam_.followTrajectory(map_smoother_.takeCorrection());
}

void SlamPipeline::smooth(Results& results) {
  map_smoother_.optimize();
  results.trajectory = map_smoother_.trajectory();
  if (!fast_slam_.lost()) {
    const Pose2 map_from_smoothed = fast_slam_.followTrajectory(results.trajectory);
    for (ram_slam::StampedPose2& stamped : results.trajectory)
      stamped.pose = map_from_smoothed * stamped.pose;
  }
  results.landmarks = toMapLandmarks(fast_slam_.filter().landmarks());
  std::ostringstream graph;
  ram_slam::writeG2o(map_smoother_.graph(), graph);
  results.pose_graph_g2o = graph.str();
  for (const ram_slam::LoopClosure& closure : map_smoother_.closures()) {
    loop_closures_ += closure.state == ram_slam::ClosureState::kAccepted ? 1 : 0;
  }
}

nlohmann::ordered_json SlamPipeline::calibration() const {
  Trajectory map_from_laser;
  for (const ram_slam::KeyScan& key : map_smoother_.keyScans())
    map_from_laser.push_back({key.stamp_ns, key.map_from_laser});
  const auto found = ram_slam::calibrateMount(all_wheels_, map_from_laser);
  if (!found) return nullptr;
  const auto with = [](double value, double sigma) {
    return nlohmann::ordered_json{{"value", value}, {"sigma", sigma}};
  };
  return {{"laser_x_m", with(found->base_from_laser.x_m, found->mount_sigma[0])},
          {"laser_y_m", with(found->base_from_laser.y_m, found->mount_sigma[1])},
          {"laser_yaw_rad", with(found->base_from_laser.yaw_rad, found->mount_sigma[2])},
          {"odometry_distance_ratio", with(found->distance_ratio, found->distance_ratio_sigma)},
          {"odometry_turn_ratio", with(found->turn_ratio, found->turn_ratio_sigma)},
          {"scan_stamp_offset_s", found->stamp_offset_s},
          {"scan_stamp_offset_used_s", 1e-9 * static_cast<double>(stamp_offset_.offset_ns())},
          {"motions", found->interval_count},
          {"motions_with_slip", found->slip_count}};
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
  results.trajectory_filter = results.trajectory = fast_slam_.filter().trajectory();
  results.landmarks = toMapLandmarks(fast_slam_.filter().landmarks());
  if (smooths()) smooth(results);
  results.map = renderMap(results.trajectory);
  nlohmann::ordered_json left_out = nlohmann::ordered_json::object();
  for (const auto& [reason, count] : left_out_) left_out[reason] = count;
  results.summary = {
      {"motion_from", wheels_.empty()                  ? "scans alone: there is no odometry"
                      : parameters_.use_laser_odometry ? "odometry and scans"
                                                       : "odometry alone"},
      {"poses", results.trajectory.size()},
      {"duration_s",
       static_cast<double>(online_.back().stamp_ns - online_.front().stamp_ns) * 1e-9},
      {"distance_m", pathLength(results.trajectory)},
      {"features_per_scan", static_cast<double>(feature_count_) /
                                static_cast<double>(std::max<std::size_t>(list_count_, 1))},
      {"landmarks", results.landmarks.size()},
      {"loop_closures", loop_closures_},
      {"scans_with_wheel_slip", slip_count_},
      {"times_lost", lost_count_},
      {"key_scans", key_scans_.size()},
      {"left_out", left_out}};
  if (smooths() && !wheels_.empty()) results.summary["calibration"] = calibration();
  return results;
}

ram_slam::OccupancyGrid SlamPipeline::renderMap(const Trajectory& trajectory) {
  ram_slam::OccupancyMapper mapper(parameters_.occupancy_mapper);
  for (const ScanReading& reading : key_scans_) {
    const auto map_from_base = ram_slam::poseAt(trajectory, reading.stampNs());
    if (!map_from_base) continue;
    const auto map_from_base_then =
        ram_slam::poseAt(trajectory, reading.stampNs() + reading.scan.duration_ns());
    const Pose2 map_from_laser = *map_from_base * reading.base_from_laser;
    Pose2 last_beam;
    if (map_from_base_then)
      last_beam = map_from_laser.inverse() * *map_from_base_then * reading.base_from_laser;
    try {
      mapper.add(reading.scan, map_from_laser, last_beam);
    } catch (const std::exception& error) {
      leaveOut(error.what());
    }
  }
  return mapper.grid();
}

}  // namespace ramscout_bringup
