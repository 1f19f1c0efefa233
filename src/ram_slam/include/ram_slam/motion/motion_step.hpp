// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "ram_slam/motion/motion_model.hpp"

namespace ram_slam {

/// How the robot moved from one stamp to another: asked for once, and handed on as a value.
struct MotionStep {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
  PoseWithCovariance2 motion;          ///< the base at to_ns, seen from the base at from_ns
  const MotionModel* model = nullptr;  ///< outlives the step; only an estimator that needs a
                                       ///< sample per particle asks it again
};

/// Asks a model for the motion; the identity, without asking, if the stamps are equal or `from_ns`
/// is 0, before which there is nothing. \throws as MotionModel::motion()
inline MotionStep motionStep(const MotionModel& model, std::int64_t from_ns, std::int64_t to_ns) {
  MotionStep step{from_ns, to_ns, {}, &model};
  if (from_ns != 0 && to_ns != from_ns) step.motion = model.motion(from_ns, to_ns);
  return step;
}

}  // namespace ram_slam
