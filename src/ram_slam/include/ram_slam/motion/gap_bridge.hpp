// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "ram_slam/motion/motion_model.hpp"

namespace ram_slam {

/// A motion model that goes on after an interruption: over an interval that the model behind it
/// cannot answer for, the robot is taken to have moved as somebody else says, or to have stood
/// still with large noise, up to the interruption's end.
class GapBridge : public MotionModel {
public:
  /// \param model  outlives this
  explicit GapBridge(const MotionModel& model) : model_(model) {}

  /// From this stamp on the model may answer again.
  /// \param moved  from the start of the next interval asked about up to this stamp, if anybody
  /// knows; who knew it within the last second is waited for
  void interruptedUntil(std::int64_t stamp_ns, const std::optional<Pose2>& moved = std::nullopt);
  void forget();

  PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const override;
  std::vector<Pose2> sample(const std::vector<Pose2>& map_from_base,
                            std::int64_t from_ns,
                            std::int64_t to_ns,
                            std::uint64_t seed) const override;

private:
  /// Up to the interruption's end.
  PoseWithCovariance2 bridge(std::int64_t from_ns) const;

  const MotionModel& model_;
  std::int64_t resume_ns_ = 0;  ///< 0: no interruption
  std::optional<Pose2> moved_;
};

}  // namespace ram_slam
