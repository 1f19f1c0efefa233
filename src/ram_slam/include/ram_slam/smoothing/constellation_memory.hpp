// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "ram_slam/landmarks/constellation.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/landmarks/local_constellation.hpp"
#include "ram_slam/smoothing/key_scan.hpp"

namespace ram_slam {

/// Recognises places by the constellation of their features, however far the poses have drifted.
///
/// The features of every stretch of the path are kept relative to a key scan, so that they move
/// with the corrections of the trajectory.
class ConstellationMemory {
public:
  /// \param matchers  by type of feature; a type without one is compared by geometry alone
  /// \param stretch_m  path whose features are kept and compared together
  ConstellationMemory(const FeatureMatchers& matchers, double stretch_m);

  /// \param list  features of the newest key scan, in the base frame
  /// \param odom_from_base  the given trajectory at that scan
  void add(const FeatureList& list, const std::vector<KeyScan>& keys, const Pose2& odom_from_base);

  /// Where the base of the newest key scan that had features should be, according to features seen
  /// at least `min_path_m` before; none if no place is much likelier than all others.
  std::optional<Pose2> findPlace(const std::vector<KeyScan>& keys, double min_path_m) const;

private:
  /// A stretch of the path.
  struct Stretch {
    std::size_t key = 0;
    Constellation points;  ///< in the base frame of the key scan
  };

  FeatureMatchers matchers_;
  double stretch_m_;
  LocalConstellation recent_;
  std::optional<Pose2> odom_from_base_;
  std::vector<Stretch> stretches_;
  double remembered_path_m_ = 0.0;
};

}  // namespace ram_slam
