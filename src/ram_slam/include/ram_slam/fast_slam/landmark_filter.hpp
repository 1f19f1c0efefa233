// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ram_parameters/parameter_file.hpp"
#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/fast_slam/association.hpp"
#include "ram_slam/fast_slam/landmark_registry.hpp"
#include "ram_slam/fast_slam/particle.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/landmarks/feature_matcher.hpp"
#include "ram_slam/landmarks/landmark_map.hpp"
#include "ram_slam/motion/motion_step.hpp"
#include "ram_slam/sensing/field_of_view.hpp"

namespace ram_slam {

/// A filter over the robot's pose and point landmarks, as Tracker needs it: Tracker notices when
/// the robot is lost and finds it again, whatever the filter is. Deterministic: the same input
/// gives the same bytes.
class LandmarkFilter {
public:
  virtual ~LandmarkFilter() = default;
  /// The same input afterwards gives the same bytes.
  virtual std::unique_ptr<LandmarkFilter> clone() const = 0;

  /// Takes in the features of one reading, moving the robot to its stamp first. If it throws
  /// nothing has changed.
  /// \param step  the motion since stamp_ns(), anything before the first list
  /// \param view  what the sensor could have seen in that reading; null: no landmark is missed
  /// \throws std::invalid_argument as check(), or if the motion is not finite
  /// \throws std::out_of_range if the motion model cannot answer
  virtual void update(const FeatureList& list, const MotionStep& step, const FieldOfView* view) = 0;
  /// \throws std::invalid_argument if update() would because of this list: it is older than the
  /// last one, or a feature is not finite or its covariance not symmetric and positive definite
  virtual void check(const FeatureList& list) const = 0;

  /// Of the newest list; 0 before the first one.
  virtual std::int64_t stamp_ns() const = 0;
  bool started() const { return stamp_ns() != 0; }
  /// map_from_base at stamp_ns().
  virtual const PoseWithCovariance2& estimate() const = 0;
  /// map_from_base over time, oldest pose first.
  virtual Trajectory trajectory() const = 0;
  virtual LandmarkMap landmarks() const = 0;
  /// The most likely path and map.
  virtual const Particle& best() const = 0;
  /// What is known of the landmarks but for their positions.
  virtual const LandmarkRegistry& registry() const = 0;
  /// What the features of the last list were taken for, one each.
  virtual const std::vector<Association>& associations() const = 0;
  /// Landmarks whose existence is less likely than this are not certain.
  virtual double confirm_log_odds() const = 0;
  /// map_from_base of hypotheses to show.
  virtual std::vector<Pose2> hypotheses() const { return {}; }
  /// Named figures for diagnostics.
  virtual std::vector<std::pair<std::string, double>> health() const { return {}; }

  /// The robot is there. \throws std::invalid_argument if the pose is not finite or the covariance
  /// not symmetric positive semi-definite
  virtual void setPose(const PoseWithCovariance2& map_from_base) = 0;
  /// The robot is there at that stamp, however it got there. \throws std::invalid_argument as
  /// above, or if the stamp is older than stamp_ns()
  virtual void setPose(const PoseWithCovariance2& map_from_base, std::int64_t stamp_ns) = 0;
  /// The robot is at new_from_old * its pose, in the same map.
  virtual void movePose(const Pose2& new_from_old) = 0;
  /// Replaces the map by one learned before, and the path by the one from which it was learned, if
  /// that is known. The pose stays. \throws std::invalid_argument if a landmark is not finite, its
  /// covariance not symmetric and positive definite, the landmarks are not in the order of their
  /// identifiers, or as validate(Trajectory); nothing has changed then
  virtual void setMap(const LandmarkMap& map, const Trajectory& path) = 0;
  /// From now on only the pose is estimated: no landmark is added, changed or removed.
  virtual void fixMap() = 0;
  virtual bool isMapFixed() const = 0;
  /// Bends the map so that the robot came along the corrected trajectory.
  /// \returns the frame of the corrected trajectory, seen from the map
  /// \throws std::invalid_argument if the trajectory cannot be used; nothing has changed
  virtual Pose2 followTrajectory(const Trajectory& corrected) = 0;
};

/// Makes a filter that knows nothing yet, at the origin of its map.
using LandmarkFilterFactory = std::function<std::unique_ptr<LandmarkFilter>()>;

/// What the registry of estimators has to know of a filter.
struct FilterEntry {
  std::string purpose;  ///< for documents, in one sentence
  /// Reads the filter's own parameters. \throws std::invalid_argument if one is refused
  std::function<LandmarkFilterFactory(ram_parameters::ParameterReader&, FeatureMatchers)> read;
  std::vector<ram_parameters::ParameterRow> rows;  ///< of the filter's own parameters
};

}  // namespace ram_slam
