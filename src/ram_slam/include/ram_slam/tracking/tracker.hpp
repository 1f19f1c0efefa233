// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "ram_slam/fast_slam/landmark_filter.hpp"
#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/tracking/checkpoint.hpp"
#include "ram_slam/tracking/map_views.hpp"
#include "ram_slam/tracking/pose_monitor.hpp"
#include "ram_slam/tracking/recovery_parameters.hpp"
#include "ram_slam/tracking/tracking_state.hpp"

namespace ram_slam {

/// A filter that notices when it is lost, and finds its place in its map again.
///
/// While the robot is tracked the filter works as it does alone, and every two seconds a copy of it
/// is put aside (copies share their maps). When the robot is lost (PoseMonitor) the filter is set
/// back to a copy from before the trouble: nothing that was seen from the wrong pose stays in the
/// map, and nothing is written until the robot is found again (Relocaliser). After that the copy
/// from before is kept for a while, the probation: if the place turns out wrong, the map is as it
/// was. transition() has all changes of state. Deterministic.
class Tracker {
public:
  /// \param make  the filter \throws std::invalid_argument as make() and
  /// RecoveryParameters::validate()
  Tracker(LandmarkFilterFactory make,
          const RecoveryParameters& recovery,
          FeatureMatchers matchers = {});

  /// As LandmarkFilter::update(), the features deskewed (deskew()). If it throws nothing has
  /// changed. \param step  the motion since stamp_ns(), the identity before the first list
  void update(const FeatureList& features,
              const MotionStep& step,
              std::shared_ptr<const FieldOfView> view = nullptr);
  /// The same, asking the model for the motion. \throws std::out_of_range as MotionModel::motion()
  void update(const FeatureList& features,
              const MotionModel& model,
              std::shared_ptr<const FieldOfView> view = nullptr);

  bool started() const { return stamp_ns_ != 0; }
  std::int64_t stamp_ns() const { return stamp_ns_; }
  const TrackingState& state() const { return state_; }
  bool lost() const { return std::holds_alternative<Lost>(state_); }
  LostReason reason() const;
  /// map_from_base of the last reading whose pose is certain; while lost not the newest one.
  StampedPose2 certainPose() const;
  /// How the last readings and the map agree; while lost, how they did when that was noticed.
  const MapAgreement& agreement() const { return monitor_.agreement(); }
  /// At stamp_ns(). While lost: where odometry alone leads from the last certain pose, with a
  /// covariance that states that it is not known.
  PoseWithCovariance2 estimate() const;
  /// Its pose and stamp are of the time before while lost.
  const LandmarkFilter& filter() const { return *filter_; }

  /// The robot is there, lost or not. \throws as LandmarkFilter::setPose()
  void setPose(const PoseWithCovariance2& map_from_base);
  /// As LandmarkFilter::movePose(); nothing happens while the robot is lost.
  void movePose(const Pose2& new_from_old) {
    if (!lost()) filter_->movePose(new_from_old);
  }
  /// As LandmarkFilter::followTrajectory(). Copies put aside before are of another map then: they
  /// are dropped. \throws std::runtime_error while the robot is lost, the map untouched
  Pose2 followTrajectory(const Trajectory& smoothed);
  /// The robot can be anywhere in the map; without a landmark in the map nothing happens.
  void forgetPose();
  /// Begins with a map learned before, of which the robot's place is not known.
  /// \param views  of places in that map \throws as LandmarkFilter::setMap()
  void setMap(const LandmarkMap& map, const std::vector<PlacedView>& views = {});
  /// As LandmarkFilter::fixMap(); no views are added either.
  void fixMap() { filter_->fixMap(); }

  /// What restore() needs to go on from here; nothing of the sort before started().
  Checkpoint checkpoint() const;
  /// Begins again with what another one knew: its map, its path, and the robot near where it was,
  /// or lost if it was. Identifiers go on behind those that may have been used meanwhile.
  /// \throws std::invalid_argument as LandmarkFilter::setMap(), or without a stamp; nothing has
  /// changed
  void restore(const Checkpoint& checkpoint);

private:
  /// Takes in one reading of a robot that is not lost.
  void track(const FeatureList& list, const Pose2& moved, const TrackedView& now);
  /// Takes in one reading of a lost robot.
  void search(const FeatureList& list, const PoseWithCovariance2& moved, const TrackedView& now);
  /// Whether a robot whose pose is doubted is found at another place of the map.
  bool isElsewhere(const FeatureList& list, const Pose2& moved, const TrackedView& now);
  /// A reading that was consistent: keeps what later ones are compared with, and copies.
  void keep(const TrackedView& now);
  /// Whether a lost robot is where its odometry leads, after all.
  bool odometryIsTrusted(Lost& lost, const TrackedView& now) const;
  PoseSource poseSource() const;

  /// Every change of state, as the table in docs/fast_slam.md.
  /// \param pose  map_from_base from now on, for events that set it
  void transition(TrackingEvent event, const PoseWithCovariance2& pose = {});
  /// Puts the robot there. \returns the filter from before
  FilterCopy moveTo(const PoseWithCovariance2& map_from_base);
  /// Corrects the pose by a slip. \returns the filter from before it
  FilterCopy correctTo(const PoseWithCovariance2& map_from_base);
  /// Sets the map back to the oldest copy, unless that is the caller's wish.
  Lost loseTrack(LostReason reason);
  Lost interrupted(const Lost& lost) const;
  /// The pose stays; what is learned from now on can be taken back.
  Probation doubted() const;
  /// Sets the map back to before the doubt. \param relocaliser  goes on searching
  Lost foundElsewhere(Relocaliser relocaliser);
  /// Whether the robot is searched for elsewhere.
  bool isDoubted() const {
    const auto* probation = std::get_if<Probation>(&state_);
    return probation != nullptr && probation->relocaliser;
  }
  /// The same copy with its map bent along a smoothed trajectory.
  static FilterCopy bent(const FilterCopy& copy, const Trajectory& smoothed);
  FilterCopy copyOfNow() const;
  /// From before anything that may be wrong; null if there is none.
  const FilterCopy* oldestCopy() const;

  LandmarkFilterFactory make_;
  RecoveryParameters parameters_;
  FeatureMatchers matchers_;
  std::unique_ptr<LandmarkFilter> filter_;
  std::int64_t stamp_ns_ = 0;
  Pose2 local_from_base_;  ///< by odometry, since the start
  double path_m_ = 0.0;    ///< driven, while not lost
  MapViews map_views_;
  PoseMonitor monitor_;
  TrackingState state_;
};

}  // namespace ram_slam
