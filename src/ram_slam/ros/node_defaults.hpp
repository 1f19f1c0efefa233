// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace ram_slam_ros {

/// Messages that may wait while a node computes: 25 s of the fastest lidars, of 40 Hz.
constexpr std::uint32_t kQueueSize = 1000;
/// Least time between two lines of the log about the same thing, so that a fault that lasts does
/// not fill it.
constexpr double kLogPeriodS = 5.0;
/// Diagnostics are published at 1 Hz (REP 107).
constexpr double kDiagnosticsPeriodS = 1.0;
/// Of advertise(): the newest message is kept for those who subscribe later.
constexpr bool kLatched = true;

}  // namespace ram_slam_ros
