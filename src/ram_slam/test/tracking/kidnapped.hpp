// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "ram_slam/fast_slam/fast_slam.hpp"
#include "ram_slam/tracking/tracker.hpp"

#include "../scan_matching/walls.hpp"

namespace ram_slam {

inline constexpr std::int64_t kStepNs = 50'000'000;
inline constexpr double kStep_m = 0.05;
inline constexpr double kSeen_m = 8.0;

/// Odometry that is exact but for the noise it states, and that knows nothing of being carried.
class ExactOdometry : public MotionModel {
public:
  void move(const Pose2& before_from_now) {
    stamp_ns_ += kStepNs;
    path_.push_back({stamp_ns_, path_.empty() ? Pose2{} : path_.back().pose * before_from_now});
  }
  std::int64_t stamp_ns() const { return stamp_ns_; }
  double variance = 1e-6;  ///< stated, per axis [m^2, rad^2]
  PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const override {
    PoseWithCovariance2 moved;
    moved.pose = poseAt(path_, from_ns)->inverse() * *poseAt(path_, to_ns);
    moved.covariance.diagonal().setConstant(variance);
    return moved;
  }
  std::vector<Pose2> sample(const std::vector<Pose2>&,
                            std::int64_t,
                            std::int64_t,
                            std::uint64_t) const override {
    return {};
  }

private:
  std::int64_t stamp_ns_ = 0;
  Trajectory path_;
};

/// A robot with a lidar that turns all round, in a room of which no part is like another.
class Kidnapped : public testing::Test {
protected:
  std::vector<Eigen::Vector2d> corners_m_{{0.0, 0.0}, {6.0, 0.0},  {6.0, -2.0}, {8.0, -2.0},
                                          {8.0, 0.0}, {14.0, 0.0}, {14.0, 3.0}, {5.0, 3.0},
                                          {5.0, 6.0}, {2.0, 6.0},  {2.0, 3.0},  {0.0, 3.0}};
  Walls walls_ = outline(corners_m_);
  ExactOdometry odometry_;
  Tracker slam_{fastSlamFactory(FastSlamParameters{}), RecoveryParameters{}};
  Pose2 truth_{1.0, 1.5, 0.0};
  const Pose2 start_ = truth_;

  void look(const Pose2& moved) {
    odometry_.move(moved);
    truth_ = truth_ * moved;
    TestLaser laser;
    laser.beam_count = 720;
    laser.field_of_view_rad = 2.0 * M_PI * 719.0 / 720.0;
    FeatureList list;
    list.stamp_ns = odometry_.stamp_ns();
    for (const Eigen::Vector2d& corner_m : corners_m_) {
      Feature feature;
      feature.type = "corner";
      feature.position_m = truth_.inverse() * corner_m;
      feature.covariance_m2 = 1e-4 * Eigen::Matrix2d::Identity();
      const double range_m = feature.position_m.norm();
      const double bearing_rad =
          truth_.yaw_rad + std::atan2(feature.position_m.y(), feature.position_m.x());
      const double free_m = rangeToWalls(walls_, truth_.translation(), bearing_rad);
      if (range_m < kSeen_m && free_m > range_m - 0.05) list.features.push_back(feature);
    }
    slam_.update(list, odometry_,
                 std::make_shared<const LaserView>(scanWalls(walls_, truth_, list.stamp_ns, laser),
                                                   Pose2{}));
  }

  void drive(double way_m) {
    const double step_m = std::copysign(kStep_m, way_m);
    for (double left_m = std::abs(way_m); left_m > 1e-9; left_m -= kStep_m)
      look({step_m, 0.0, 0.0});
  }

  void mapTheRoom() {
    look({});
    drive(11.5);
    drive(-11.5);
    drive(5.0);
  }

  void carryToAnotherBuilding() {
    corners_m_ = {{0.0, 0.0},  {9.0, 0.0}, {9.0, -4.0}, {16.0, -4.0},
                  {16.0, 5.0}, {7.0, 5.0}, {7.0, 9.0},  {0.0, 9.0}};
    walls_ = outline(corners_m_);
    truth_ = {8.0, 2.0, 0.5};
  }

  /// The process is killed and started again from its last checkpoint; the robot drives on
  /// meanwhile.
  void restart(const std::string& checkpoint, double way_m) {
    for (double left_m = way_m; left_m > 1e-9; left_m -= kStep_m) {
      odometry_.move({kStep_m, 0.0, 0.0});
      truth_ = truth_ * Pose2{kStep_m, 0.0, 0.0};
    }
    Tracker other{fastSlamFactory(FastSlamParameters{}), RecoveryParameters{}};
    other.restore(checkpointFromBytes(checkpoint));
    slam_ = std::move(other);
  }

  double error_m() const {
    return (slam_.estimate().pose.translation() - (start_.inverse() * truth_).translation()).norm();
  }

  std::string mapBytes() const {
    std::string bytes;
    for (const LandmarkEstimate& landmark : slam_.filter().landmarks().landmarks) {
      bytes += std::to_string(landmark.id) + " ";
      bytes.append(reinterpret_cast<const char*>(landmark.mean_m.data()), 2 * sizeof(double));
      bytes.append(reinterpret_cast<const char*>(&landmark.existence_log_odds), sizeof(double));
    }
    return bytes;
  }
};

}  // namespace ram_slam
