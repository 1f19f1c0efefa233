// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace ram_slam_ros {

/// Messages that may wait while a node computes: 25 s of the fastest lidars, of 40 Hz.
constexpr std::uint32_t kQueueSize = 1000;
/// Least time between two lines of the log about the same thing, so that a fault that lasts does
/// not fill it.
constexpr double kLogPeriodS = 5.0;
/// What is dropped so soon after a start is not logged: other nodes still start.
constexpr double kStartingS = 5.0;
/// Diagnostics are published at 1 Hz (REP 107).
constexpr double kDiagnosticsPeriodS = 1.0;
/// Causes are looked for at 4 Hz, so that each is stated within two seconds.
constexpr double kDiagnosticsCheckS = 0.25;
/// Inputs whose newest message is older are looked up at the master, this often.
constexpr double kLongestUsualIntervalS = 0.9;
constexpr double kMasterPeriodS = 0.5;
/// Share of lost messages that is an error: a scan in five is missed by no stage.
constexpr double kMuchShare = 0.2;
/// Of advertise(): the newest message is kept for those who subscribe later.
constexpr bool kLatched = true;

}  // namespace ram_slam_ros
