// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/pose2.hpp"

namespace ramscout_kinematics {

/// The robot's pose by its wheels.
struct OdometrySample {
  std::int64_t stamp_ns = 0;
  ram_slam::Pose2 odom_from_base;
  /// Forward, left [m/s], turning [rad/s], in the base frame, as reported. Used only right after
  /// the first sample, when there are no two poses yet that give a velocity.
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();
  /// The first one of a source that was started again: its origin is not that of those before.
  bool is_restart = false;
};

struct OdometryBufferParameters {
  /// Length of the history that can be asked about.
  double buffer_duration_s = 30.0;
  /// A sample may arrive this much after newer ones and is still put in its place.
  double reorder_window_s = 0.5;
  /// How far past the newest sample the last velocity is assumed.
  double max_extrapolation_s = 0.0;
  /// Longer intervals between samples are gaps: the noise of the motion is multiplied by interval /
  /// gap_s.
  double gap_s = 0.5;
  /// Gaps longer than this are not bridged: requests that touch one are refused.
  double max_gap_s = 10.0;
  /// Fastest the robot can move; samples that imply more than twice that are jumps of the odometry.
  double max_speed_mps = 2.0;
  double max_turn_rate_radps = 6.0;
  /// Standard deviation of the unknown acceleration while extrapolating.
  double acceleration_sigma_mps2 = 1.0;
  double turn_acceleration_sigma_radps2 = 2.0;
  /// A gap over which the pose changed by no more than this is none: the odometry went on, or the
  /// robot stood still.
  double continuous_gap_m = 0.5;
  double continuous_gap_rad = 0.5;
  /// What a sample may be off beyond the speed limits before it is a jump: stamps jitter.
  double jump_slack_m = 0.1;
  double jump_slack_rad = 0.1;
  /// Shortest time between two poses that give a velocity.
  double twist_baseline_s = 0.02;

  static const ram_parameters::ParameterTable<OdometryBufferParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// What became of a sample.
enum class Added {
  kInOrder,
  kReordered,      // put in its place among newer ones
  kRepeated,       // replaced one of the same stamp
  kTooLate,        // dropped: older than the reorder window
  kJump,           // held back: implies an impossible speed
  kDiscontinuity,  // the third in a row that does: the odometry was reset, motion continues from
                   // its new origin
  kClockSetBack,   // the first of a new history
};

/// A piece of the motion between two samples, at constant twist.
struct MotionSegment {
  /// Logarithm of the motion, in the base frame: forward, left [m], turned [rad].
  Eigen::Vector3d increment = Eigen::Vector3d::Zero();
  double duration_s = 0.0;
  /// What the drive model's noise is to be multiplied by: 1, more in a gap.
  double noise_factor = 1.0;
  /// Noise beyond the drive model's, per axis of the increment [m^2, m^2, rad^2].
  Eigen::Vector3d added_variance = Eigen::Vector3d::Zero();
};

/// Why the buffer does not know a motion. Before the first odometry there was none to forget.
enum class Unavailable { kNoOdometry, kBeforeFirst, kTooOld, kNotYetAvailable, kGap };

/// A request that the odometry received so far does not cover.
class OdometryUnavailable : public std::out_of_range {
public:
  OdometryUnavailable(Unavailable the_reason, const std::string& message)
      : std::out_of_range(message), reason(the_reason) {}
  const Unavailable reason;
};

/// The recent odometry by stamp, and the motion between any two stamps in it.
///
/// What it answers depends on the samples, not on the order in which they arrived (within the
/// reorder window): which samples are jumps is worked out along the stamps, again from a sample
/// that comes late. Only the differences between neighbouring poses count, so a reset of the
/// odometry's origin costs no more than one interval. Requests that touch the interval before a
/// source that was started again are refused as a gap, unless it is a short one.
class OdometryBuffer {
public:
  /// \throws as OdometryBufferParameters::validate()
  explicit OdometryBuffer(const OdometryBufferParameters& parameters);

  /// \throws std::invalid_argument if the stamp is not positive or a value is not finite; the
  /// buffer is unchanged
  Added add(const OdometrySample& sample);

  /// The motion from `from_ns` to `to_ns` in pieces, one per interval between samples that it
  /// touches.
  /// \throws std::invalid_argument if to < from or a stamp is not positive; OdometryUnavailable
  /// with the buffered stamps in the message
  std::vector<MotionSegment> segments(std::int64_t from_ns, std::int64_t to_ns) const;

  bool empty() const { return entries_.empty(); }
  /// Stamp of the oldest and the newest sample; zero if empty.
  std::int64_t oldestNs() const { return empty() ? 0 : entries_.front().sample.stamp_ns; }
  std::int64_t newestNs() const;

private:
  enum class Standing { kAccepted, kOriginMoved, kHeldBack };
  struct Entry {
    OdometrySample sample;
    Standing standing = Standing::kAccepted;
    /// Time since the first entry; of a gap, max_gap_s count.
    std::int64_t history_ns = 0;
  };
  using Iterator = std::deque<Entry>::const_iterator;

  /// Decides about the entries from `first` on; true if the origin was found to have moved.
  bool judgeFrom(std::size_t first);
  /// Measures the time up to the entries from `first` on.
  void measureFrom(std::size_t first);
  bool originMovedAt(std::size_t last_of_three) const;
  bool isPlausible(const OdometrySample& before, const OdometrySample& after) const;
  void forgetOld();
  Iterator nextAccepted(Iterator entry) const;
  /// The newest accepted entry not after the stamp; the first entry is always accepted.
  Iterator acceptedBefore(std::int64_t stamp_ns) const;
  Iterator newestAccepted() const;
  MotionSegment between(const Entry& before,
                        const Entry& after,
                        std::int64_t from_ns,
                        std::int64_t to_ns) const;
  MotionSegment beyond(Iterator newest, std::int64_t from_ns, std::int64_t to_ns) const;
  Eigen::Vector3d latestTwist(Iterator newest) const;
  void requireCovered(std::int64_t from_ns, std::int64_t to_ns) const;
  [[noreturn]] void refuse(Unavailable reason, const std::string& what) const;

  OdometryBufferParameters parameters_;
  /// By stamp, all different. The first is accepted.
  std::deque<Entry> entries_;
  bool has_forgotten_ = false;  ///< any sample since it was empty
};

}  // namespace ramscout_kinematics
