// SPDX-License-Identifier: BSD-3-Clause
#include "results_recorder.hpp"

#include <cmath>
#include <iostream>
#include <stdexcept>
#include <utility>

#include <boost/timer/progress_display.hpp>
#include <ram_parameters/require.hpp>
#include <ram_slam/ros/conversions.hpp>

#include "ramscout_bringup/evaluation.hpp"

#include "result_conversions.hpp"

namespace ramscout_bringup_ros {
namespace {

constexpr double kFinished = 1.0 - 1e-6;  // progress is published as a 32-bit float

ram_slam::StampedPose2 toStampedPose(const std_msgs::Header& header,
                                     const geometry_msgs::Pose& pose) {
  return {ram_slam_ros::toNanoseconds(header.stamp), ram_slam_ros::toPose2(pose)};
}

}  // namespace

void ResultsRecorderParameters::validate() const {
  using ram_parameters::requirePositive;
  if (output.empty()) throw std::invalid_argument("output must name the folder to write to");
  requirePositive("max_position_error_m", max_position_error_m);
  requirePositive("max_yaw_error_rad", max_yaw_error_rad);
  requirePositive("start_timeout_s", start_timeout_s);
  requirePositive("silence_timeout_s", silence_timeout_s);
  requirePositive("settle_time_s", settle_time_s);
}

ResultsRecorderParameters readResultsRecorderParameters(ram_parameters::ParameterReader& reader) {
  ResultsRecorderParameters parameters;
  reader.read("output", parameters.output);
  reader.read("has_ground_truth", parameters.has_ground_truth);
  reader.read("max_position_error_m", parameters.max_position_error_m);
  reader.read("max_yaw_error_rad", parameters.max_yaw_error_rad);
  reader.read("start_timeout_s", parameters.start_timeout_s);
  reader.read("silence_timeout_s", parameters.silence_timeout_s);
  reader.read("settle_time_s", parameters.settle_time_s);
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
}

ResultsRecorder::ResultsRecorder(ResultsRecorderParameters parameters)
    : parameters_(std::move(parameters)) {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  const auto listen = [&](auto subscriber) { subscribers_.push_back(std::move(subscriber)); };
  listen(node_.subscribe<nav_msgs::OccupancyGrid>(
      "map", 1, [this](const auto& message) { map_ = *message; }, {}, hints));
  listen(node_.subscribe<nav_msgs::Path>(
      "trajectory", 1, [this](const auto& message) { path_ = *message; }, {}, hints));
  listen(node_.subscribe<ram_slam_msgs::LandmarkMap>(
      "landmarks", 1, [this](const auto& message) { landmarks_ = *message; }, {}, hints));
  listen(node_.subscribe<geometry_msgs::PoseWithCovarianceStamped>(
      "pose", 1000,
      [this](const auto& message) {
        online_.push_back(toStampedPose(message->header, message->pose.pose));
      },
      {}, hints));
  listen(node_.subscribe<nav_msgs::Odometry>(
      "ground_truth", 1000,
      [this](const auto& message) {
        ground_truth_.push_back(toStampedPose(message->header, message->pose.pose));
      },
      {}, hints));
  listen(node_.subscribe<nav_msgs::Odometry>(
      "odom", 1000,
      [this](const auto& message) {
        odometry_.push_back(toStampedPose(message->header, message->pose.pose));
      },
      {}, hints));
  listen(node_.subscribe<std_msgs::Float32>(
      "tour_progress", 1, [this](const auto& message) { progress_ = message->data; }, {}, hints));
}

bool ResultsRecorder::run() {
  started_ = ros::WallTime::now();
  if (parameters_.has_ground_truth) {
    waitForTour();
  } else {
    waitForSilence();
  }
  waitForLastMessages();
  ramscout_bringup::Results run = results();
  const bool good = !parameters_.has_ground_truth || judge(run);
  run.summary.update(
      {{"distance_m", ramscout_bringup::pathLength(run.trajectory)},
       {"poses", run.trajectory.size()},
       {"landmarks", run.landmarks.size()},
       {"recorded_s",
        static_cast<double>(online_.back().stamp_ns - online_.front().stamp_ns) * 1e-9},
       {"elapsed_s", (ros::WallTime::now() - started_).toSec()}});
  ramscout_bringup::writeResults(run, parameters_.output);
  std::cout << "\n" << run.summary.dump(2) << "\n";
  return good;
}

bool ResultsRecorder::judge(ramscout_bringup::Results& run) const {
  const auto error = ramscout_bringup::compareWithTruth(run.trajectory, run.ground_truth);
  const auto online = ramscout_bringup::compareWithTruth(run.trajectory_online, run.ground_truth);
  const bool good = error.position_m.rms <= parameters_.max_position_error_m &&
                    error.yaw_rad.rms <= parameters_.max_yaw_error_rad && !run.landmarks.empty();
  run.summary = {{"verdict", good ? "good" : "bad"},
                 {"position_error_rms_m", error.position_m.rms},
                 {"yaw_error_rms_rad", error.yaw_rad.rms},
                 {"online_position_error_rms_m", online.position_m.rms},
                 {"online_yaw_error_rms_rad", online.yaw_rad.rms}};
  return good;
}

void ResultsRecorder::waitForTour() {
  boost::timer::progress_display bar(100, std::cout);
  ros::WallTime last_news = ros::WallTime::now();
  double allowed_s = parameters_.start_timeout_s;
  while (progress_ < kFinished) {
    ros::spinOnce();
    const auto percent = static_cast<unsigned long>(100.0 * progress_);
    if (percent > bar.count()) {
      bar += percent - bar.count();
      last_news = ros::WallTime::now();
      allowed_s = parameters_.silence_timeout_s;
    }
    if (!ros::ok() || (ros::WallTime::now() - last_news).toSec() > allowed_s) {
      throw std::runtime_error("the tour does not continue; no message on: " + silentTopics());
    }
    ros::WallDuration(parameters_.poll_period_s).sleep();
  }
}

void ResultsRecorder::waitForSilence() {
  ros::WallTime last_news = ros::WallTime::now();
  double allowed_s = parameters_.start_timeout_s;
  std::size_t received = 0;
  while ((ros::WallTime::now() - last_news).toSec() <= allowed_s && ros::ok()) {
    ros::spinOnce();
    if (online_.size() > received) {
      received = online_.size();
      last_news = ros::WallTime::now();
      allowed_s = parameters_.silence_timeout_s;
    }
    ros::WallDuration(parameters_.poll_period_s).sleep();
  }
}

void ResultsRecorder::waitForLastMessages() {
  const ros::WallTime deadline =
      ros::WallTime::now() + ros::WallDuration(parameters_.settle_time_s);
  const auto complete = [this] {
    return map_ && landmarks_ && path_ && !path_->poses.empty() && !online_.empty() &&
           online_.back().stamp_ns - ram_slam_ros::toNanoseconds(path_->poses.back().header.stamp) <
               parameters_.last_path_lag_ns &&
           online_.back().stamp_ns - ram_slam_ros::toNanoseconds(map_->header.stamp) <
               parameters_.last_path_lag_ns;
  };
  while (ros::ok() && !complete() && ros::WallTime::now() < deadline) {
    ros::spinOnce();
    ros::WallDuration(parameters_.poll_period_s).sleep();
  }
  const std::string silent = silentTopics();
  if (!silent.empty())
    throw std::runtime_error("the tour is over, but no message arrived on: " + silent);
}

std::string ResultsRecorder::silentTopics() const {
  std::string silent;
  const auto report = [&](bool is_received, const char* topic) {
    if (!is_received) silent += (silent.empty() ? "" : ", ") + node_.resolveName(topic);
  };
  if (parameters_.has_ground_truth) {
    report(progress_ > 0.0, "tour_progress");
    report(!ground_truth_.empty(), "ground_truth");
  }
  report(!online_.empty(), "pose");
  report(path_.has_value(), "trajectory");
  report(landmarks_.has_value(), "landmarks");
  report(map_.has_value(), "map");
  return silent;
}

ramscout_bringup::Results ResultsRecorder::results() const {
  ramscout_bringup::Results run;
  run.map = toOccupancyGrid(*map_);
  run.landmarks = toMapLandmarks(*landmarks_);
  run.trajectory = toTrajectory(*path_);
  run.trajectory_online = online_;
  run.ground_truth = ground_truth_;
  run.odometry = odometry_;
  run.about = {{"recording", "Run of the live nodes"}, {"made by", "record_results"}};
  const auto addRate = [&run](const char* topic, const ramscout_bringup::Trajectory& poses) {
    ramscout_bringup::RateCounter rate;
    for (const auto& pose : poses) rate.add(pose.stamp_ns);
    run.measurements.push_back({topic, "1/s", "Messages by their stamps.", rate.perSecond()});
  };
  addRate("pose", online_);
  addRate("odom", odometry_);
  return run;
}

}  // namespace ramscout_bringup_ros
