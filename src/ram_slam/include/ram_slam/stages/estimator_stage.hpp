// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/estimation/estimator_registry.hpp"
#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/motion/gap_bridge.hpp"
#include "ram_slam/motion/motion_step.hpp"
#include "ram_slam/stages/drop_counter.hpp"

namespace ram_slam {

/// Which readings the estimator takes in.
struct EstimatorStageParameters {
  double minimum_distance_m = 0.0;
  double minimum_angle_rad = 0.0;
  double longest_pause_s = 10.0;
  double lost_after_s = 10.0;  ///< of readings without any motion
  /// A pose measured in the smoother's map is not believed if it is farther from the estimator's.
  MotionGate map_pose{0.5, 0.2};
  GapBridgeParameters gap_bridge;

  static const ram_parameters::ParameterTable<EstimatorStageParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// From features and motion to the pose: asks for the motion up to a reading once and hands it on
/// as a value, bridges gaps of the odometry, updates the estimator, and lets it follow corrected
/// trajectories.
///
/// For each reading: motionUntil(); without a motion bridgeGap(); if isDue() update(); then
/// followCorrection().
class EstimatorStage {
public:
  /// \param model  outlives this
  EstimatorStage(EstimatorFactory make,
                 const MotionModel& model,
                 const EstimatorStageParameters& parameters);

  /// The motion since the estimator's last reading; nothing if the model does not know it (yet).
  /// Begins again (reset()) if the clock was set back.
  std::optional<MotionStep> motionUntil(std::int64_t stamp_ns);
  /// Why motionUntil() gave nothing.
  const std::string& missingMotion() const { return missing_motion_; }
  /// The motion up to this stamp will not become known: the reading is dropped, and the next one
  /// continues from here; after lost_after_s without any motion the robot is lost. \param moved
  /// since the estimator's last reading, if known otherwise
  void bridgeGap(std::int64_t stamp_ns, const std::optional<Pose2>& moved = std::nullopt);

  /// Whether the estimator shall take in the reading at the end of this step.
  bool isDue(const MotionStep& step) const;
  /// \return false if the estimator refused the features, which are counted as dropped
  bool update(const FeatureList& features,
              const MotionStep& step,
              std::shared_ptr<const FieldOfView> view);
  /// map_from_base at the end of a step, whether the estimator took that reading in or not.
  Pose2 poseAt(const MotionStep& step) const;

  /// Keeps a smoothed trajectory until it can be followed: until the reading at its newest stamp
  /// was dealt with and the robot is not lost. A newer one replaces it.
  void addCorrection(Trajectory smoothed) { correction_ = std::move(smoothed); }
  /// Follows the kept trajectory if that is possible now.
  /// \return the corrected trajectory in the map frame, if one was followed
  std::optional<Trajectory> followCorrection();
  /// Follows a smoothed trajectory at once. \return it in the map frame
  /// \throws as Estimator::followTrajectory()
  Trajectory follow(Trajectory smoothed);

  /// Keeps a pose of the base that was measured in the smoother's map, in the frame of its
  /// trajectories; a hundred at most.
  void addMapPose(const StampedPose2& smoothed_from_base);
  /// Moves the estimator to the kept poses of readings that were dealt with, unless the robot is
  /// lost or a trajectory that was followed is newer. Call before each reading.
  void followMapPoses();

  /// Whether the robot is lost, at the first call and when that has changed since the last one.
  std::optional<Tracking> takeTrackingChange();

  /// Begins again with the map that the factory gives: an empty one, if none was loaded.
  void reset();
  /// How often the clock was set back or reset() was called.
  int resetCount() const { return reset_count_; }

  const Estimator& estimator() const { return *estimator_; }
  Estimator& estimator() { return *estimator_; }
  const DropCounter& drops() const { return drops_; }
  DropCounter& drops() { return drops_; }

private:
  void followMapPose(const StampedPose2& smoothed_from_base);

  EstimatorFactory make_;
  const MotionModel& model_;
  EstimatorStageParameters parameters_;
  GapBridge motion_;
  std::unique_ptr<Estimator> estimator_;
  std::string missing_motion_;
  std::int64_t reached_ns_ = 0;  ///< stamp of the newest reading whose motion was known
  bool bridges_ = false;
  std::int64_t bridged_ns_ = 0;    ///< stamp of the newest reading without a known motion
  double without_motion_s_ = 0.0;  ///< how long readings have come without any motion
  std::optional<Trajectory> correction_;
  std::deque<StampedPose2> map_poses_;
  std::optional<Pose2> map_from_smoothed_;  ///< none before the first measured pose
  std::int64_t followed_ns_ = 0;  ///< newest stamp of the last trajectory that was followed
  int reset_count_ = 0;
  std::optional<bool> stated_lost_;  ///< by takeTrackingChange()
  DropCounter drops_;
};

}  // namespace ram_slam
