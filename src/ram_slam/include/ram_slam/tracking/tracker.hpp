// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/fast_slam/fast_slam.hpp"
#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/landmarks/constellation.hpp"
#include "ram_slam/tracking/checkpoint.hpp"
#include "ram_slam/tracking/discontinuity_detector.hpp"
#include "ram_slam/tracking/local_constellation.hpp"
#include "ram_slam/tracking/lost_detector.hpp"
#include "ram_slam/tracking/map_views.hpp"
#include "ram_slam/tracking/place_finder.hpp"

namespace ram_slam {

/// Settings of Tracker; the section `relocalisation` of config/fast_slam.yaml, which
/// explains them.
struct RecoveryParameters {
  /// False: the filter alone; it is never lost and never recovers.
  bool enabled = true;
  LostDetectorParameters lost;
  LocalConstellationParameters local;
  ConstellationParameters constellation;

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// Reads the section `relocalisation`. \throws std::invalid_argument for an unknown key, a wrong
/// type or a value out of bounds
RecoveryParameters readRecoveryParameters(ram_parameters::ParameterReader& all);

/// Why the robot does not know where it is.
enum class LostReason {
  kTracking,        ///< it does know
  kDiscontinuity,   ///< two readings in a row show different places
  kMapContradicts,  ///< nothing of the map is where it should be, but other things are
  kRequested,       ///< somebody wanted it so, or the map was loaded
};

/// FastSlam that notices when it is lost, and finds its place in its map again.
///
/// While the robot is tracked the filter works as it does alone, and every second a copy of it is
/// put aside (copies share their maps). When the robot is lost (LostDetector, or two readings that
/// contradict each other) the filter is set back to a copy from before the trouble: nothing that
/// was seen from the wrong pose stays in the map, and nothing is written until the robot is found
/// again. Meanwhile the features of the way driven are put together (LocalConstellation) and laid
/// over the map's landmarks (matchConstellations()). A place counts as found if it is unique and
/// found twice, half a metre of driving apart. After that the copy from before is kept for a while:
/// if the place turns out wrong, the map is as it was. Deterministic.
class Tracker {
public:
  /// \throws std::invalid_argument as FastSlam and RecoveryParameters::validate()
  Tracker(const FastSlamParameters& filter,
          const RecoveryParameters& recovery,
          FeatureMatchers matchers = {});

  /// As FastSlam::update(), the features deskewed (deskew()). If it throws nothing has changed.
  /// \param step  the motion since stamp_ns(), the identity before the first list
  void update(const FeatureList& features,
              const MotionStep& step,
              std::shared_ptr<const FieldOfView> view = nullptr);
  /// The same, asking the model for the motion. \throws std::out_of_range as MotionModel::motion()
  void update(const FeatureList& features,
              const MotionModel& model,
              std::shared_ptr<const FieldOfView> view = nullptr);

  bool started() const { return stamp_ns_ != 0; }
  std::int64_t stamp_ns() const { return stamp_ns_; }
  bool lost() const { return reason_ != LostReason::kTracking; }
  LostReason reason() const { return reason_; }
  /// How the last readings and the map agree; while lost, how they did when that was noticed.
  const MapAgreement& agreement() const { return agreement_; }
  /// At stamp_ns(). While lost: where odometry alone leads from the last certain pose, with a
  /// covariance that says that it is not known.
  PoseWithCovariance2 estimate() const;
  /// Its pose and stamp are of the time before while lost.
  const FastSlam& filter() const { return filter_; }

  /// The robot is there, lost or not. \throws as FastSlam::setPose()
  void setPose(const PoseWithCovariance2& map_from_base);
  /// As FastSlam::followTrajectory(). Copies put aside before are of another map then: they are
  /// dropped. \throws std::runtime_error while the robot is lost, the map untouched
  Pose2 followTrajectory(const Trajectory& smoothed);
  /// The robot can be anywhere in the map; without a landmark in the map nothing happens.
  void forgetPose();
  /// Begins with a map learned before, of which the robot's place is not known. \throws as
  /// FastSlam::setMap()
  void setMap(const LandmarkMap& map);

  /// What restore() needs to go on from here; nothing of the sort before started().
  Checkpoint checkpoint() const;
  /// Begins anew with what another one knew: its map, its path, and the robot near where it was,
  /// or lost if it was. Identifiers go on behind those that may have been used meanwhile.
  /// \throws std::invalid_argument as FastSlam::setMap(), or without a stamp; nothing has changed
  void restore(const Checkpoint& checkpoint);

private:
  /// A copy of the filter, and where the robot was then.
  struct Memory {
    FastSlam filter;
    Pose2 map_from_base;
    Pose2 local_from_base;
    std::int64_t stamp_ns = 0;
  };
  void search(const FeatureList& list, const PoseWithCovariance2& moved, const TrackedView& now);
  /// The motion that odometry did not tell, if a small one makes this view agree with those before.
  std::optional<Pose2> slipUpTo(const TrackedView& now) const;
  /// Moves the robot; the map as it was before is kept for a while.
  void correctBy(const Pose2& slip);
  /// Whether a robot that the map contradicts is where its odometry leads, after all.
  bool odometryIsRight(const TrackedView& now);
  /// Whether a robot that was seemingly carried away was found nowhere for a long way, and may as
  /// well be where its odometry leads.
  bool nothingDeniesOdometry(const TrackedView& now) const;
  /// Whether views of late contradict those that the map was learned from.
  bool contradictsMap(const TrackedView& now);
  /// The share of contradiction that says nothing.
  double usualContradiction() const;
  /// Whether this view is as the map's are: then landmarks that are not there were moved.
  bool agreesWithMap(const TrackedView& now) const;
  /// Whether a pose nearby would agree with the views of late.
  bool isDrift(const TrackedView& now) const;
  void remember();
  /// Back to the map as it was before.
  void loseTrack(LostReason reason);
  void resume(const PoseWithCovariance2& map_from_base);
  /// Where odometry has led since the robot was lost.
  void resumeByOdometry(double sigma_m, double sigma_rad);
  void tryToRecover();
  Constellation mapConstellation() const;

  FastSlamParameters filter_parameters_;
  RecoveryParameters parameters_;
  FeatureMatchers matchers_;
  FastSlam filter_;
  std::int64_t stamp_ns_ = 0;
  LostReason reason_ = LostReason::kTracking;
  MapAgreement agreement_;
  DiscontinuityDetector discontinuities_;
  DisturbanceDetector disturbance_;  ///< while lost
  LostDetector detector_;
  LocalConstellation local_;
  Pose2 local_from_base_;  ///< by odometry, since the start
  double path_m_ = 0.0;    ///< driven, while not lost

  std::deque<Memory> memories_;   ///< oldest first
  bool on_probation_ = false;     ///< the pose is newly set: memories_ is from before
  bool place_was_found_ = false;  ///< that pose is of the map, not of odometry: without drift
  double probation_left_m_ = 0.0;
  MapViews map_views_;
  std::int64_t walls_agree_since_ns_ = 0;  ///< while lost, where odometry leads
  std::int64_t doubted_ns_ = 0;            ///< when a view was compared with the map's last
  double doubt_s_ = 0.0;                   ///< how much such views have contradicted of late
  PoseWithCovariance2 dead_reckoned_;      ///< while lost
  bool may_be_false_alarm_ = false;        ///< then the robot is where odometry leads
  double next_try_m_ = 0.0;
  std::optional<Pose2> found_;  ///< local frame in the map, as the last try found it
};

}  // namespace ram_slam
