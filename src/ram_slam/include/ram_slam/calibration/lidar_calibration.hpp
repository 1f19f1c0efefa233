// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <string>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/scan_matching/point_to_line.hpp"
#include "ram_slam/sensing/laser_scan.hpp"

namespace ram_slam {

/// The time of one counterclockwise turn of the mirror by the scan's time increment [s]; negative
/// if the mirror turns clockwise.
double mirrorTurn_s(const LaserScan& scan);

/// The scan as the lidar has measured it. If the time of a mirror turn becomes negative, the mirror
/// turns clockwise: the beams are put into the order in which they are fired.
/// \param added_mirror_turn_s  to the time of one counterclockwise turn of the mirror that the
/// scan states [s]
LaserScan corrected(LaserScan scan, double added_mirror_turn_s);

/// Settings of LidarCalibration.
struct LidarCalibrationParameters {
  double max_turn_s = 0.2;           ///< greatest correction to either side; 0: none is learned
  double min_turn_s = 0.005;         ///< smaller corrections are not used: no mirror is as fast
  double min_turn_rate_radps = 0.1;  ///< to key scans, of a scan that is none
  double max_interval_s = 0.3;       ///< to the scan before; over longer ones no speed is known
  int min_blocks = 24;               ///< of scans that are compared with the same key scans
  int max_blocks = 200;              ///< the newest, which count
  double deviations = 4.0;  ///< that a correction is large, at least; half as many to keep it

  static const ram_parameters::ParameterTable<LidarCalibrationParameters>& table();
};

/// Learns while driving what the driver of a lidar states wrongly or, as most do, not at all: how
/// long the mirror takes for a turn. It makes the heading drift: a mirror of 75 Hz bends a scan by
/// 0.4 degrees at 1 rad/s.
///
/// The residuals of aligned scans are linear in the pose and in the time p of a mirror turn; the
/// pose is eliminated (Schur complement), and p solves sum H p = sum b over the pairs. Pairs with
/// the same key scans share their errors and are one block; the scatter of the blocks gives the
/// variance (sum H)^-1 (sum r^2) (sum H)^-1 with r = b - H p (White, Econometrica 1980). A mirror
/// turn that takes longer than the mean interval between scans, beyond what the variance explains,
/// is impossible: then nothing is used.
class LidarCalibration {
public:
  explicit LidarCalibration(const LidarCalibrationParameters& parameters = {});

  /// When the beams of a scan were measured.
  struct Timing {
    double interval_s = 0.0;     ///< from the scan before to this one
    double mirror_turn_s = 0.0;  ///< as mirrorTurn_s() has it, of the corrected scan
  };

  /// Takes one aligned pair of scans, both corrected by what is known now.
  /// \param timing  of the newer one
  void add(const ScanPairSum& pair, const Timing& timing);
  /// The pairs that follow are with other key scans.
  void endBlock();

  /// What is to be added to the time of a mirror turn that the next scan states; 0 if nothing
  /// significant was found.
  double addedMirrorTurn_s() const { return used_.mirror_turn_s; }
  /// Its standard deviation; 0 if nothing is added.
  double deviation_s() const { return used_.deviation_s; }

private:
  /// H, and b for a correction that begins at zero.
  struct Block {
    double information = 0.0;
    double weighted = 0.0;
    int pair_count = 0;
    double intervals_s = 0.0;  ///< sum over the pairs
  };
  struct Solution {
    double mirror_turn_s = 0.0;
    double deviation_s = 0.0;
  };

  Block sumOfBlocks() const;
  Solution solve(const Block& sum) const;
  /// Whether it is large enough, given its deviation, and not too large.
  bool isUsable(const Solution& solution) const;
  /// Whether the whole mirror turn fits between two scans, given its deviation.
  bool isPossible(const Solution& solution, double mean_interval_s) const;
  void use(const Solution& solution);

  LidarCalibrationParameters parameters_;
  Block block_;  ///< the current one
  std::deque<Block> blocks_;
  double stated_mirror_turn_s_ = 0.0;  ///< of the newest scan
  Solution used_;
};

/// For people: "one turn of the mirror takes 13.3 ms (+- 0.6 ms) longer than stated".
std::string toText(const LidarCalibration& calibration);

}  // namespace ram_slam
