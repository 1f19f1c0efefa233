// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/sensing/no_return.hpp"
#include "ramscout_bringup/odometry_review.hpp"
#include "ramscout_bringup/recording.hpp"
#include "ramscout_bringup/topic_choice.hpp"
#include "ramscout_bringup/transform_tree.hpp"

#include "message_source.hpp"

namespace ramscout_bringup_ros {

/// Header stamps and times of recording of one topic, in the order of the file.
struct TopicTimes {
  std::vector<std::int64_t> stamps_ns;
  std::vector<std::int64_t> received_ns;
};

/// What a recording holds, from reading it once.
struct RecordingSurvey {
  struct Scans {
    std::string topic;
    TopicTimes times;
    std::map<std::string, std::size_t> count_of_frame;
    ram_slam::NoReturnDetector no_return;
    std::size_t beam_count = 0;               ///< of the first scan
    double increment_rad = 0.0;               ///< likewise
    double scan_time_s = 0.0;                 ///< likewise
    double time_increment_s = 0.0;            ///< likewise
    std::size_t at_limit_count = 0;           ///< readings at range_max
    double limit_m = 0.0;                     ///< range_max of the first scan
    std::size_t unlimited_count = 0;          ///< scans without a limit of their range
    std::size_t implausible_sweep_count = 0;  ///< scans whose time_increment cannot be true
  };
  struct Odometry {
    TopicTimes times;
    std::vector<ramscout_bringup::OdometryReading> readings;
    std::string child_frame;  ///< of the first reading
    std::size_t invalid_count = 0;
  };

  std::vector<ramscout_bringup::RecordedTopic> topics;
  Scans scans;
  std::map<std::string, Odometry> odometry;  ///< by topic: all candidates
  ramscout_bringup::TransformTree tree;
  std::vector<std::string> source_notes;  ///< what the file's reader left out
};

/// What to read, decided from a survey.
struct RecordingPlan {
  std::string base_frame;
  std::vector<ram_slam::StampedPose2> odometry;  ///< odom_from_base by rising stamps
  /// Of each scan of the file the stamp, and its place among those to read; none if left out.
  std::vector<std::int64_t> scan_stamps_ns;
  std::vector<std::optional<std::size_t>> scan_ranks;
  std::size_t scan_count = 0;  ///< to be read, or left out though they were wished for
  std::size_t read_count = 0;  ///< to be read
  std::optional<float> no_return_m;
  std::optional<double> sweep_s;  ///< of a scan, where its time_increment cannot be true
  std::vector<std::string> notes;
};

/// Reads a file from its beginning to its end.
/// \throws std::runtime_error if there is no clear topic of scans, or as MessageSource::next()
RecordingSurvey survey(MessageSource& source, const ramscout_bringup::RecordingOptions& options);

/// \throws std::runtime_error if what the file holds is ambiguous or of no use
RecordingPlan plan(const RecordingSurvey& survey,
                   const ramscout_bringup::RecordingOptions& options);

}  // namespace ramscout_bringup_ros
