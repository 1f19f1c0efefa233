// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// Settings of StampOffset.
struct StampOffsetParameters {
  double step_s = 0.02;     ///< between the offsets that are compared; smaller ones are taken for 0
  double margin_s = 0.2;    ///< compared beyond the greatest offset, to see a minimum out there
  double min_turn_s = 0.4;  ///< turns are compared over at least this time
  double max_turn_s = 1.0;  ///< and at most this time
  double turn_rad = 0.05;   ///< a turn has at least this angle, by the scans or the wheels
  double max_scan_deviation_rad = 0.01;  ///< of the yaw by a scan alone; others are not compared
  double max_period_s =
      0.3;  ///< longest mean time between two scans, or two readings of the wheels
  double min_deviation_rad = 0.001;  ///< least standard deviation of a turn
  int min_turns = 80;                ///< before an offset is estimated
  int max_turns = 400;               ///< newest ones that count
  int turns_between = 20;            ///< from one estimate to the next
  int block_count = 10;              ///< of turns, whose scatter gives the error of the estimate
  double min_gain = 24.0;            ///< twice the log-likelihood ratio against no offset
  double min_lead = 6.0;             ///< the same against the next local minimum
  double deviations = 4.0;           ///< an offset is at least so many of its standard deviations
  double max_turn_ratio = 2.0;       ///< of wheels and scans, to either side
  double min_evidence = 6.0;  ///< log-likelihood ratio against no offset on turns that come after

  static const ram_parameters::ParameterTable<StampOffsetParameters>& table();
};

/// Learns while driving by how much the stamps of the wheels' odometry and those of the scans
/// differ: drivers stamp when they read, not when the sensor measured, and 0.1 s at 1 rad/s is 6
/// degrees that appear as slip.
///
/// Both measure how far the robot turned between the same two instants, which differs where the
/// turn rate changes. Over the newest turns the cost of an offset d is
///   J(d) = min_k sum_i v ln(1 + r_i^2 / v),  r_i = scans_i - k wheels_i(d),
/// with the ratio k of the turns (a wrong one looks like an offset where turns are short) and the
/// variance v of the residuals (Cauchy likelihood, as Furgale, Rehder, Siegwart, IROS 2013). The
/// minimum is used only if it is significant: see docs/laser_odometry.md. The standard deviation is
/// the greater one of sqrt(2 v / J'') and that of a jackknife over blocks of turns.
class StampOffset {
public:
  /// \param max_offset_s  greatest offset to either side; 0: never any
  /// \throws std::invalid_argument if it is negative or beyond 1 s
  explicit StampOffset(double max_offset_s, const StampOffsetParameters& parameters = {});

  /// Where the robot is by its wheels, in the order of the stamps.
  void addWheels(const StampedPose2& odom_from_base);
  /// Where the robot is by its scans, in the order of the stamps.
  void addScan(const StampedPose2& odom_from_base);
  /// The scans do not show the robot's turn here: no turn goes on over this.
  void interrupt() { start_.reset(); }

  /// To be added to a scan's stamp to have the wheels'. 0 until one is found that is significant,
  /// and again when it does not predict the turns any more.
  std::int64_t offset_ns() const { return offset_ns_; }

private:
  struct Interval {
    StampedPose2 from;
    StampedPose2 to;
  };
  struct Turn {
    double by_scans_rad = 0.0;
    std::vector<double> by_wheels_rad;  ///< by offset
  };
  struct Estimate {
    double index = 0.0;  ///< of the offset in the row of offsets
    double variance_of_index = 0.0;
    double turn_ratio = 1.0;
    double turn_ratio_without = 1.0;  ///< if there were no offset
    double variance_rad2 = 0.0;       ///< of a turn
    bool is_significant = false;
  };

  /// Keeps a turn if the wheels cover it at all offsets.
  void compare(const Interval& interval);
  void add(Turn turn);
  /// Lets the offset in use and the one on trial predict a turn.
  void test(const Turn& turn);
  Estimate estimate() const;
  /// Fills the index, its variance and whether it is significant.
  /// \param costs  by block of turns and offset
  void judge(const Eigen::MatrixXd& costs, Estimate& found) const;
  /// Log-likelihood ratio of an estimate against no offset, on one turn.
  double evidence(const Estimate& estimate, const Turn& turn) const;
  std::int64_t toOffset_ns(double index) const;
  void forgetWheels();
  /// Scans or wheels come too seldom to learn from them.
  bool isTooSlow() const;

  StampOffsetParameters parameters_;
  std::int64_t step_ns_;
  std::int64_t max_offset_ns_;   ///< that may be used
  std::int64_t last_offset_ns_;  ///< that is compared
  std::size_t offset_count_;
  std::deque<StampedPose2> wheels_;    ///< as many as the waiting intervals need
  std::deque<Interval> waiting_;       ///< for wheels after them
  std::optional<StampedPose2> start_;  ///< of the current interval
  std::optional<std::int64_t> last_scan_ns_;
  double scan_period_s_ = 0.0;  ///< mean of the recent ones
  std::deque<Turn> turns_;
  int turns_since_estimate_ = 0;
  std::optional<Estimate> candidate_;  ///< on trial
  double candidate_evidence_ = 0.0;
  std::optional<Estimate> used_;
  double used_evidence_ = 0.0;  ///< of the turns since, at most `min_evidence`
  std::int64_t offset_ns_ = 0;
};

}  // namespace ram_slam
