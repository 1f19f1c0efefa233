// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/run_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <Eigen/Eigenvalues>

#include "ram_slam/calibration/mount_calibration.hpp"
#include "ramscout_bringup/evaluation.hpp"

namespace ramscout_bringup {
namespace {

using nlohmann::ordered_json;

/// Wheels are kept for the calibration at 50 Hz, which interpolation does not see.
constexpr std::int64_t kCalibrationStepNs = 20'000'000;

std::size_t acceptedClosures(const ram_slam::MapSmoother& smoother) {
  return static_cast<std::size_t>(std::count_if(
      smoother.closures().begin(), smoother.closures().end(),
      [](const auto& closure) { return closure.state == ram_slam::ClosureState::kAccepted; }));
}

/// Places where the smoother found that the robot had been carried.
std::size_t jumps(const ram_slam::MapSmoother& smoother) {
  return static_cast<std::size_t>(std::count_if(smoother.keyScans().begin(),
                                                smoother.keyScans().end(),
                                                [](const auto& key) { return key.is_jump; }));
}

const char* motionSource(const RunReport::Run& run) {
  if (!run.odometry.hasWheels()) return "scans alone: there is no odometry";
  return run.uses_laser_odometry ? "odometry and scans" : "odometry alone";
}

ordered_json withSigma(double value, double sigma) {
  return {{"value", value}, {"sigma", sigma}};
}

ordered_json toJson(const ram_slam::LidarCalibration& lidar) {
  return {{"added_turn_time_s", withSigma(lidar.addedMirrorTurn_s(), lidar.deviation_s())},
          {"meaning", toText(lidar)}};
}

}  // namespace

ordered_json toJson(const ram_slam::DropCounter& drops) {
  ordered_json list = ordered_json::array();
  for (const ram_slam::Drops& row : drops.all()) {
    list.push_back({{"reason", toText(row.reason)},
                    {"count", row.count},
                    {"first_s", 1e-9 * static_cast<double>(row.first_ns)},
                    {"last_s", 1e-9 * static_cast<double>(row.last_ns)},
                    {"last_detail", row.detail}});
  }
  return list;
}

void LossRecord::add(std::int64_t stamp_ns, bool is_lost, const std::string& state) {
  const bool was_lost = !losses_.empty() && !losses_.back().to_ns;
  if (is_lost && !was_lost) losses_.push_back({state, stamp_ns, std::nullopt});
  if (!is_lost && was_lost) losses_.back().to_ns = stamp_ns;
}

ordered_json LossRecord::toJson() const {
  ordered_json list = ordered_json::array();
  for (const Loss& loss : losses_) {
    list.push_back({{"reason", loss.reason},
                    {"from_s", 1e-9 * static_cast<double>(loss.from_ns)},
                    {"to_s", nullptr}});
    if (loss.to_ns) list.back()["to_s"] = 1e-9 * static_cast<double>(*loss.to_ns);
  }
  return list;
}

std::vector<ClosureRecord> closureRecords(const ram_slam::MapSmoother& smoother) {
  std::vector<ClosureRecord> records;
  for (const ram_slam::LoopClosure& closure : smoother.closures()) {
    if (closure.state == ram_slam::ClosureState::kRefused) continue;
    records.push_back({closure.old_stamp_ns, closure.new_stamp_ns, closure.score,
                       closure.inlier_ratio, closure.correction_m,
                       closure.state == ram_slam::ClosureState::kAccepted});
  }
  return records;
}

void RunReport::addWheels(const ram_slam::StampedPose2& odom_from_base) {
  wheel_rate_.add(odom_from_base.stamp_ns);
  if (wheels_.empty() || odom_from_base.stamp_ns - wheels_.back().stamp_ns >= kCalibrationStepNs)
    wheels_.push_back(odom_from_base);
}

void RunReport::addStep(const ram_slam::OdometryStep& step, bool is_refined) {
  scan_rate_.add(step.scan.scan.stamp_ns);
  if (is_refined)
    inliers_.samples.push_back({step.scan.scan.stamp_ns, 100.0 * step.estimate.inlier_ratio});
}

void RunReport::addReading(const ram_slam::FeatureList& features,
                           const ram_slam::Estimator& estimator) {
  feature_count_ += features.features.size();
  ++list_count_;
  losses_.add(features.stamp_ns, estimator.isLost(), estimator.state());
  features_.samples.push_back({features.stamp_ns, static_cast<double>(features.features.size())});
  const Eigen::Matrix2d covariance_m2 = estimator.estimate().covariance.topLeftCorner<2, 2>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance_m2, Eigen::EigenvaluesOnly);
  deviation_.samples.push_back(
      {features.stamp_ns, std::sqrt(std::max(axes.eigenvalues()[1], 0.0))});
}

std::vector<Measurement> RunReport::measurements() const {
  std::vector<Measurement> all = {
      {"scans", "1/s", "Scans whose odometry is known, by their stamps.", scan_rate_.perSecond()},
      {"odometry", "1/s", "Readings of the wheels, by their stamps.", wheel_rate_.perSecond()},
      inliers_,
      features_,
      deviation_};
  const auto is_empty = [](const Measurement& measurement) { return measurement.samples.empty(); };
  all.erase(std::remove_if(all.begin(), all.end(), is_empty), all.end());
  return all;
}

ordered_json RunReport::summary(const Run& run) const {
  const Results& results = run.results;
  const Trajectory& online = results.trajectory_online;
  ordered_json summary = {
      {"motion_from", motionSource(run)},
      {"poses", results.trajectory.size()},
      {"duration_s", static_cast<double>(online.back().stamp_ns - online.front().stamp_ns) * 1e-9},
      {"distance_m", pathLength(results.trajectory)},
      {"features_per_scan", static_cast<double>(feature_count_) /
                                static_cast<double>(std::max<std::size_t>(list_count_, 1))},
      {"landmarks", results.landmarks.size()},
      {"loop_closures", run.smooths ? acceptedClosures(run.smoothing.smoother()) : 0},
      {"scans_with_wheel_slip", run.odometry.slipCount()},
      {"scans_without_odometry", run.odometry.withoutWheelsCount()},
      {"times_lost", losses_.count()},
      {"losses", losses_.toJson()},
      {"times_carried", run.smooths ? jumps(run.smoothing.smoother()) : 0},
      {"key_scans", run.mapping.scanCount()},
      {"clock_resets", run.odometry.resetCount()},
      {"left_out",
       {{"odometry", toJson(run.odometry.drops())},
        {"estimator", toJson(run.estimator.drops())},
        {"smoothing", toJson(run.smoothing.drops())},
        {"mapping", toJson(run.mapping.drops())}}}};
  if (run.uses_laser_odometry) summary["lidar"] = toJson(run.odometry.lidarCalibration());
  if (run.smooths && run.odometry.hasWheels()) summary["calibration"] = calibration(run);
  return summary;
}

ordered_json RunReport::calibration(const Run& run) const {
  Trajectory map_from_laser;
  for (const ram_slam::KeyScan& key : run.smoothing.smoother().keyScans())
    map_from_laser.push_back({key.stamp_ns, key.map_from_laser});
  const auto found = ram_slam::calibrateMount(wheels_, map_from_laser);
  if (!found) return nullptr;
  return {
      {"laser_x_m", withSigma(found->base_from_laser.x_m, found->mount_sigma[0])},
      {"laser_y_m", withSigma(found->base_from_laser.y_m, found->mount_sigma[1])},
      {"laser_yaw_rad", withSigma(found->base_from_laser.yaw_rad, found->mount_sigma[2])},
      {"odometry_distance_ratio", withSigma(found->distance_ratio, found->distance_ratio_sigma)},
      {"odometry_turn_ratio", withSigma(found->turn_ratio, found->turn_ratio_sigma)},
      {"scan_stamp_offset_s", found->stamp_offset_s},
      {"scan_stamp_offset_used_s", 1e-9 * static_cast<double>(run.odometry.stampOffset_ns())},
      {"motions", found->interval_count},
      {"motions_with_slip", found->slip_count}};
}

}  // namespace ramscout_bringup
