// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <string>

#include <Eigen/Core>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/scan_matching/point_to_line.hpp"
#include "ram_slam/sensing/laser_scan.hpp"

namespace ram_slam {

/// What a lidar does otherwise than its driver states.
struct LidarCorrection {
  double turn_s = 0.0;   ///< added to the time of one counterclockwise turn of the mirror
  double range_m = 0.0;  ///< added to each reading

  bool operator==(const LidarCorrection& other) const {
    return turn_s == other.turn_s && range_m == other.range_m;
  }
};

/// The scan as the lidar has measured it. If the time of a turn is negative, the mirror turns
/// clockwise: the beams are put into the order in which they are fired.
LaserScan corrected(LaserScan scan, const LidarCorrection& correction);

/// Settings of LidarCalibration.
struct LidarCalibrationParameters {
  double max_turn_s = 0.2;     ///< greatest correction to either side; 0: none is learned
  double max_range_m = 0.0;    ///< the same; where scans are bent otherwise, false offsets appear
  double min_turn_s = 0.005;   ///< smaller corrections are not used: no mirror is as fast
  double min_range_m = 0.003;  ///< smaller corrections are not used
  double min_turn_rate_radps = 0.1;  ///< to key scans, of a scan that is none
  double max_interval_s = 0.3;       ///< to the scan before; over longer ones no speed is known
  int min_blocks = 24;               ///< of scans that are compared with the same key scans
  int max_blocks = 200;              ///< the newest, which count
  double deviations = 4.0;  ///< that a correction is large, at least; half as many to keep it

  static const ram_parameters::ParameterTable<LidarCalibrationParameters>& table();
};

/// Learns while driving what the driver of a lidar states wrongly or, as most do, not at all: how
/// long a sweep takes, and an offset of the readings. Each makes the heading drift: a mirror of
/// 75 Hz bends a scan by 0.4 degrees at 1 rad/s, and readings 1 cm too short bend a wall, which
/// seems to turn as the robot drives along it.
///
/// The residuals of aligned scans are linear in the pose and in these two; the pose is eliminated
/// (Schur complement), and the two solve sum H x = sum b over the pairs. Pairs with the same key
/// scans share their errors and are one block; the scatter of the blocks gives the covariance
/// (sum H)^-1 (sum r r^T) (sum H)^-1 with r = b - H x (White, Econometrica 1980). What is not
/// significant is left out, and the other is solved for alone.
class LidarCalibration {
public:
  explicit LidarCalibration(const LidarCalibrationParameters& parameters = {});

  /// Takes one aligned pair of scans, both corrected by what is known now.
  void add(const ScanPairSum& pair);
  /// The pairs that follow are with other key scans.
  void endBlock();

  /// How the next scan is to be corrected.
  const LidarCorrection& correction() const { return correction_; }
  /// Standard deviations of the corrections; 0 of those that are not used.
  const LidarCorrection& deviation() const { return deviation_; }

private:
  /// H, and b for corrections that begin at zero.
  struct Block {
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
    Eigen::Vector2d weighted = Eigen::Vector2d::Zero();
  };
  struct Solution {
    Eigen::Array2d values;
    Eigen::Array2d deviations;
  };

  /// \param used  0 or 1 for each correction
  Solution solve(const Eigen::Vector2d& used) const;
  /// Whether one of the corrections is large enough, given its deviation.
  bool isSignificant(const Solution& solution, Eigen::Index which) const;
  void use(const Solution& solution);

  LidarCalibrationParameters parameters_;
  Eigen::Array2d least_;
  Eigen::Array2d most_;
  Block block_;  ///< the current one
  std::deque<Block> blocks_;
  LidarCorrection correction_;
  LidarCorrection deviation_;
};

/// For people: "one turn of the mirror takes 13.3 ms (+- 0.6 ms) longer than stated, ...".
std::string toText(const LidarCalibration& calibration);

}  // namespace ram_slam
