// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_slam/ekf_slam/ekf_slam.hpp"

#include "../fast_slam/fast_slam_fixtures.hpp"

namespace ram_slam {

/// As plain() of the particle filter.
inline EkfSlamParameters plainEkf() {
  EkfSlamParameters parameters;
  parameters.common = plain();
  return parameters;
}

inline void feed(EkfSlam& filter, const FeatureList& list, const MotionModel& model) {
  filter.update(list, motionStep(model, filter.stamp_ns(), list.stamp_ns));
}

inline EkfSlam runEkf(const SyntheticDrive& drive, const EkfSlamParameters& parameters) {
  EkfSlam filter(parameters);
  for (const FeatureList& list : drive.lists) feed(filter, list, drive.odometry);
  return filter;
}

}  // namespace ram_slam
