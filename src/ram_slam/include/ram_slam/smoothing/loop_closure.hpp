// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "ram_slam/pose_graph/pose_graph.hpp"

namespace ram_slam {

/// What became of a loop closure.
enum class ClosureState {
  kAccepted,
  kOutvoted,  ///< the rest of the graph contradicts it
  kRefused,   ///< taken back by LoopCloser::refuse()
};

/// A place that was recognised; the log of the smoother.
struct LoopClosure {
  std::int64_t old_stamp_ns = 0;
  std::int64_t new_stamp_ns = 0;
  PoseEdge edge;              ///< between laser poses of key scans
  double score = 0.0;         ///< of the dense search
  double inlier_ratio = 0.0;  ///< of the alignment
  double correction_m = 0.0;  ///< how far it moved the newest pose when it was found
  /// The key scan to which the robot was carried, if this closure shows it.
  std::optional<std::size_t> jump = {};
  bool is_ambiguous = false;  ///< along a corridor; the edge then holds the other directions only
  ClosureState state = ClosureState::kAccepted;
};

}  // namespace ram_slam
