// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <variant>

#include "ram_slam/fast_slam/landmark_filter.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/tracking/discontinuity_detector.hpp"
#include "ram_slam/tracking/pose_monitor.hpp"
#include "ram_slam/tracking/relocaliser.hpp"

namespace ram_slam {

/// Why the robot does not know where it is.
enum class LostReason {
  kTracking,        ///< it does know
  kDiscontinuity,   ///< recent readings show two different places
  kMapContradicts,  ///< the map's landmarks or views are not where they should be
  kRequested,       ///< a caller wanted it so, or the map was loaded
};

/// A copy of the filter, and where the robot was then. Copies share their maps.
struct FilterCopy {
  std::shared_ptr<const LandmarkFilter> filter;
  Pose2 map_from_base;
  Pose2 local_from_base;
  std::int64_t stamp_ns = 0;
};

/// The robot knows where it is, and learns its map.
struct Tracked {
  std::deque<FilterCopy> copies;  ///< from certain moments, oldest first
};

/// The robot's pose is newly set or doubted and may be wrong: the map from before is kept for so
/// long.
struct Probation {
  FilterCopy before;
  PoseSource source = PoseSource::kMap;
  double remaining_m = 0.0;  ///< of driving
  /// Of a pose that is doubted: looks for the robot in the map from before.
  std::optional<Relocaliser> relocaliser = {};
};

/// The robot does not know where it is; the map is not written to.
struct Lost {
  LostReason reason = LostReason::kRequested;
  StampedPose2 certain;             ///< pose of the last reading at which it was certain
  Pose2 map_from_base;              ///< where odometry has led since
  bool may_be_false_alarm = false;  ///< then the robot is there
  std::int64_t walls_agree_since_ns = 0;
  DisturbanceDetector disturbance;
  Relocaliser relocaliser;
};

using TrackingState = std::variant<Tracked, Probation, Lost>;

/// What leads from one state to another. docs/fast_slam.md has the table.
enum class TrackingEvent {
  kSlipped,              ///< a small motion that odometry missed explains a discontinuity
  kCarriedAway,          ///< no small motion explains it
  kMapContradicted,      ///< the map denies the pose
  kDoubted,              ///< views changed at once: it may have been carried to a similar place
  kFoundElsewhere,       ///< two tries found a robot whose pose is doubted at another place
  kProbationPassed,      ///< the way of a probation is driven, and no view contradicts the map
  kOdometryInterrupted,  ///< the motion since the last reading is not known well
  kDisturbanceOver,      ///< everything appears as before the discontinuity
  kPlaceFound,           ///< two tries found the same place
  kOdometryTrusted,      ///< the robot was found nowhere else, or the walls agree with odometry
  kPoseSet,              ///< a caller states the pose
  kPoseSetBeforeStart,   ///< the same before the first reading
  kPoseForgotten,        ///< a caller states that the pose is not known
  kTrajectoryFollowed,   ///< the map was bent along a smoothed trajectory
};

}  // namespace ram_slam
