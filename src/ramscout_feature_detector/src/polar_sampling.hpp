// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/sensing/laser_scan.hpp"
#include "ramscout_feature_detector/polar_grid.hpp"

namespace ramscout_feature_detector {

/// How the samples of a cell decide its state. Part of the schemes "pg1" and "pg2": with other
/// numbers, grids are not comparable to those in saved maps.
struct CellRule {
  double surface_m = 0.08;   ///< a sample is on a surface if it is this near to its beam's reading
  double free_below = 0.2;   ///< occupied share of the samples that were seen
  double mixed_below = 0.6;  ///< likewise; occupied from there on
};

/// What one scan shows of the cells of a polar grid, from two by two samples in each of them.
class PolarSampling {
public:
  static constexpr int kSamplesPerSide = 2;
  static constexpr int kSamplesPerCell = kSamplesPerSide * kSamplesPerSide;

  /// \param radii_m  of the samples, two for each ring, ascending; sector 0 is centred on the axis
  /// \param half_pitches_m  for each ring: half the distance between its samples' radii
  PolarSampling(const std::vector<double>& radii_m,
                const std::vector<double>& half_pitches_m,
                int sectors,
                const CellRule& rule = {});

  /// The states of all cells, ring by ring from the inside.
  /// \param cells  as many as there are
  void sample(const ram_slam::Pose2& laser_from_grid,
              const ram_slam::LaserScan& scan,
              PolarGrid::Cell* cells) const;

private:
  int sectors_;
  std::vector<double> half_pitches_m_;
  CellRule rule_;
  std::vector<double> x_m_, y_m_;  ///< of the samples, cell by cell
};

}  // namespace ramscout_feature_detector
