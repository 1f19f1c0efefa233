// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/motion/motion_noise.hpp"

namespace ram_slam {

/// Settings of WheelScatter.
struct WheelScatterParameters {
  double memory = 200.0;        ///< so many intervals later an interval counts 1/e
  double prior = 20.0;          ///< the stated deviation counts as so many intervals
  double min_share = 0.4;       ///< of the stated deviation that is believed at least
  double max_deviations = 2.0;  ///< by which a scan may move a pose for the share to hold
  double min_scan_share = 0.5;  ///< of an interval's turn that scans measured; others do not count
  double turning_rad = 0.1;     ///< intervals with more turning show the scatter of turns

  static const ram_parameters::ParameterTable<WheelScatterParameters>& table();
};

/// Learns while driving how far the yaw of the wheels scatters about what scans measure, as a share
/// of the stated standard deviation: good wheels are believed where scans show little.
///
/// share^2 = mean of min(1, (residual^2 - scan variance) / stated variance) over intervals: a slip
/// counts once, however long it is. There is one share for driving straight on and one for turning;
/// neither exceeds 1. The scatter of the distance is not learned: its errors are alike for many
/// metres, and a small deviation would let them add up along corridors.
class WheelScatter {
public:
  explicit WheelScatter(const WheelScatterParameters& parameters = {});

  /// The deviations that are believed.
  MotionNoise of(const MotionNoise& stated) const;

  /// Takes one interval.
  /// \param wheels  the motion by the wheels, without their bias
  /// \param observed_yaw_rad  the turn by wheels and scans together
  /// \param by_scans_rad  standard deviation of the yaw by the scans alone
  void add(const Pose2& wheels,
           double observed_yaw_rad,
           const MotionNoise& stated,
           double by_scans_rad);
  /// An interval in which the scans contradicted the wheels.
  void addSlip();

private:
  /// Mean of squared shares, older ones counting less.
  struct Mean {
    double sum;
    double weight;
  };
  void count(Mean& mean, double squared_share) const;
  double share(const Mean& mean) const;

  WheelScatterParameters parameters_;
  Mean straight_;
  Mean turning_;
};

}  // namespace ram_slam
