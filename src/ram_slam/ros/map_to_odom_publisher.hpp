// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_broadcaster.h>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/stages/fast_slam_node_parameters.hpp"
#include "ram_slam/stages/input_guard.hpp"

namespace ram_slam_ros {

/// Keeps tf map -> odom valid: publishes it from a thread of its own, dated ahead, at 25 Hz and at
/// once after a correction, never twice with the same stamp.
class MapToOdomPublisher {
public:
  /// \param ahead_s  how far ahead of now the transform is dated
  MapToOdomPublisher(const ram_slam::Frames& frames,
                     const ram_slam::MapToOdomParameters& parameters,
                     double ahead_s,
                     const tf2_ros::Buffer& buffer);
  ~MapToOdomPublisher();
  MapToOdomPublisher(const MapToOdomPublisher&) = delete;
  MapToOdomPublisher& operator=(const MapToOdomPublisher&) = delete;

  /// Where the base was at a stamp. Takes effect when tf knows odom -> base at that stamp.
  void correct(std::int64_t stamp_ns, const ram_slam::Pose2& map_from_base);
  /// How the base moved in the odometry frame, if tf knows. A jump of that frame's origin is no
  /// motion.
  std::optional<ram_slam::Pose2> odometryBetween(std::int64_t from_ns, std::int64_t to_ns) const;
  /// Back to map = odom, after the clock was set back.
  void reset();

private:
  struct Correction {
    std::int64_t stamp_ns = 0;
    ram_slam::Pose2 map_from_base;
  };
  void run();
  void publishIfDue();
  void publish(std::int64_t now_ns);
  void applyCorrection();

  ram_slam::Frames frames_;
  ram_slam::MapToOdomParameters parameters_;
  std::int64_t ahead_ns_;
  const tf2_ros::Buffer& buffer_;
  tf2_ros::TransformBroadcaster broadcaster_;
  mutable std::mutex mutex_;
  std::optional<Correction> pending_;
  std::optional<ram_slam::Pose2> map_from_odom_;
  std::int64_t last_data_ns_ = 0;
  std::int64_t last_sent_ns_ = 0;
  /// A single leap of the clock must not reach tf, which would refuse all that is older.
  ram_slam::InputGuard<std::int64_t> clock_guard_;
  ram_slam::DropCounter clock_drops_;
  bool changed_ = false;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace ram_slam_ros
