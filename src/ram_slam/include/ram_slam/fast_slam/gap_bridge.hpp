// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_slam/motion_model.hpp"

namespace ram_slam {

/// A motion model that goes on after an interruption: over an interval that the model behind it
/// cannot answer for, the robot is taken to have stood still with large noise up to the
/// interruption's end.
class GapBridge : public MotionModel {
public:
  /// \param model  outlives this
  explicit GapBridge(const MotionModel& model) : model_(model) {}

  /// From this stamp on the model may answer again.
  void interruptedUntil(std::int64_t stamp_ns) { resume_ns_ = stamp_ns; }
  void forget() { resume_ns_ = 0; }

  PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const override;
  std::vector<Pose2> sample(const std::vector<Pose2>& map_from_base,
                            std::int64_t from_ns,
                            std::int64_t to_ns,
                            std::uint64_t seed) const override;

private:
  const MotionModel& model_;
  std::int64_t resume_ns_ = 0;  ///< 0: no interruption
};

}  // namespace ram_slam
