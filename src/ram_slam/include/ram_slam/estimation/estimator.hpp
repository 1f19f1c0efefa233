// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/landmarks/landmark_map.hpp"
#include "ram_slam/motion/motion_step.hpp"
#include "ram_slam/sensing/field_of_view.hpp"
#include "ram_slam/tracking/checkpoint.hpp"

namespace ram_slam {

/// Whether an estimator knows where the robot is.
struct Tracking {
  bool is_lost = false;
  std::int64_t stamp_ns = 0;  ///< of the reading after which that changed
  /// Lost: of the last reading whose pose is certain. What was seen later was seen from an unknown
  /// place.
  std::int64_t certain_until_ns = 0;
  Pose2 map_from_base;  ///< at certain_until_ns
};

/// Estimates the robot's pose and a map of landmarks from features and motion. It knows neither the
/// robot nor the sensor. Deterministic: the same input gives the same bytes.
///
/// docs/extending.md shows how to add one.
class Estimator {
public:
  virtual ~Estimator() = default;

  /// Takes in the features of one reading, moving the robot to its stamp first. If it throws,
  /// nothing has changed.
  /// \param features  in the base frame, with the stamp step.to_ns
  /// \param step  the motion since stamp_ns(); the identity for the first reading
  /// \param view  what the sensor could have seen in that reading; may be null
  /// \throws std::invalid_argument if the features are older than those before or not finite
  /// \throws std::out_of_range if it asks the motion model for samples that it cannot give
  virtual void update(const FeatureList& features,
                      const MotionStep& step,
                      std::shared_ptr<const FieldOfView> view) = 0;

  /// Stamp of the newest reading; 0 before the first one.
  virtual std::int64_t stamp_ns() const = 0;
  bool started() const { return stamp_ns() != 0; }
  /// map_from_base at stamp_ns(), with covariance.
  virtual PoseWithCovariance2 estimate() const = 0;
  /// map_from_base of hypotheses to show; empty if there are none.
  virtual std::vector<Pose2> hypotheses() const { return {}; }
  /// map_from_base over time, oldest first.
  virtual Trajectory trajectory() const = 0;
  virtual LandmarkMap landmarks() const = 0;

  /// Whether the robot does not know where it is. Then the map must not be changed by anyone.
  virtual bool isLost() const { return false; }
  /// map_from_base of the last reading whose pose is certain: the newest one, but while lost an
  /// older one, or of the stamp 0 if there is none.
  virtual StampedPose2 certainPose() const { return {stamp_ns(), estimate().pose}; }
  /// "tracking", or in plain English why it is lost.
  virtual std::string state() const { return "tracking"; }
  /// Named figures for diagnostics.
  virtual std::vector<std::pair<std::string, double>> health() const { return {}; }

  /// The robot is there. \throws std::invalid_argument if the pose is not finite or the covariance
  /// not symmetric positive semi-definite
  virtual void setPose(const PoseWithCovariance2& map_from_base) = 0;
  /// The robot is elsewhere by a little: new_from_old * its pose, in the same map.
  virtual void movePose(const Pose2& new_from_old) {
    const PoseWithCovariance2 now = estimate();
    setPose({new_from_old * now.pose, now.covariance});
  }
  /// Moves path, map and pose so that they agree with a corrected trajectory.
  /// \returns the frame of the corrected trajectory, seen from the map
  /// \throws std::invalid_argument if the trajectory cannot be used, std::runtime_error while the
  /// robot is lost; nothing has changed
  virtual Pose2 followTrajectory(const Trajectory& corrected) = 0;
  /// The robot may be anywhere in its map. Estimators that cannot search it ignore this.
  virtual void forgetPose() {}
  /// Begins with a map made before, in which the robot's place is not known.
  /// \param views  what a sensor saw at places of that map; may be empty
  /// \throws std::invalid_argument if the map is unusable; nothing has changed
  virtual void setMap(const LandmarkMap& map, const std::vector<PlacedView>& views) = 0;
  /// From now on only the pose is estimated; the map stays as it is.
  /// \throws std::invalid_argument if the estimator cannot do that
  virtual void fixMap() { throw std::invalid_argument("this estimator cannot keep a map fixed"); }

  /// What restore() needs to continue from here.
  virtual Checkpoint checkpoint() const = 0;
  /// Continues where another run stopped. \throws std::invalid_argument; nothing has changed
  virtual void restore(const Checkpoint& checkpoint) = 0;
};

}  // namespace ram_slam
