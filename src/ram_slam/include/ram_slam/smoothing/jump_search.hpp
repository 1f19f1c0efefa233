// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/smoothing/key_scan.hpp"
#include "ram_slam/smoothing/loop_closure.hpp"
#include "ram_slam/smoothing/loop_search.hpp"
#include "ram_slam/smoothing/loop_verification.hpp"
#include "ram_slam/smoothing/place_descriptor.hpp"

namespace ram_slam {

/// Settings of JumpSearch.
struct JumpSearchParameters {
  double search_path_m = 100.0;   ///< path after a possible jump along which it is searched for
  int place_count = 3;            ///< places of the same shape that are searched, at most
  double place_distance_m = 5.0;  ///< path between two of these
  /// Path between two places that must agree on where the robot was carried.
  double support_path_m = 12.0;
  /// Key scans since then, so far apart, are compared with what was seen before where they are in
  /// reach of it; this share of them must fit.
  double check_path_m = 2.0;
  double min_fitting = 0.4;

  static const ram_parameters::ParameterTable<JumpSearchParameters>& table();
};

/// Finds out whether the robot was carried, and where to: the chain of key scans then leads on from
/// where it was before, and contradicts every true closure.
///
/// A jump is possible where scans are missing for long or do not meet those before
/// (KeyScan::may_be_jump). The key scans after it are compared with all before it by the shape of
/// what they see, in any heading. The robot was carried if two places, well apart, or one place and
/// the estimator that found the robot, agree with each other and not with the poses, and enough of
/// the other key scans since then fit there, too.
class JumpSearch {
public:
  JumpSearch(const JumpSearchParameters& parameters,
             const LoopSearchParameters& loops,
             const ScanMatcherParameters& matcher);

  /// The newest possible jump; none if two closures, well apart, show that the robot was not
  /// carried, or it drove far since then.
  std::optional<std::size_t> possibleJump(const std::vector<KeyScan>& key_scans,
                                          const std::vector<LoopClosure>& closures) const;

  /// Key scans before a jump whose shape is most like that of the newest one, one of each stretch.
  std::vector<std::size_t> alikePlaces(const std::vector<KeyScan>& key_scans, std::size_t jump);

  /// The estimator, which was lost, has found the robot.
  /// \param map_from_odom  of the trajectory that was given, by the place found
  void addFoundPlace(std::int64_t stamp_ns, const Pose2& map_from_odom) {
    found_ = FoundPlace{stamp_ns, map_from_odom};
  }

  /// Whether a match of key scans on both sides of a jump, which contradicts the poses, shows that
  /// the robot was carried; if not it is kept to support later ones.
  bool isShownBy(const std::vector<KeyScan>& key_scans, const LoopMatch& match, std::size_t jump);

private:
  struct FoundPlace {
    std::int64_t stamp_ns = 0;
    Pose2 map_from_odom;
  };

  /// Whether the estimator has found the robot, since a jump, where this match puts it.
  bool isWhereFound(const std::vector<KeyScan>& key_scans,
                    const LoopMatch& match,
                    std::size_t jump) const;
  /// Whether a match that was kept agrees with this one.
  bool isSupported(const std::vector<KeyScan>& key_scans,
                   const LoopMatch& match,
                   std::size_t jump) const;
  /// Whether the match puts enough of the key scans since the jump where they fit, too.
  bool fitsSinceJump(const std::vector<KeyScan>& key_scans,
                     const LoopMatch& match,
                     std::size_t jump) const;

  JumpSearchParameters parameters_;
  LoopSearchParameters loops_;
  ScanMatcherParameters matcher_;
  std::vector<PlaceDescriptor> descriptors_;  // of the key scans
  std::vector<LoopMatch> unsupported_;
  std::optional<FoundPlace> found_;
};

}  // namespace ram_slam
