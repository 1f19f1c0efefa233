// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/stamp_offset.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "ram_slam/geometry/median.hpp"
#include "ram_slam/geometry/trajectory.hpp"

namespace ram_slam {
namespace {

std::int64_t toNanoseconds(double duration_s) {
  return static_cast<std::int64_t>(std::llround(duration_s * 1e9));
}

/// Turns by the wheels at the offset of a fractional index.
double interpolated(const std::vector<double>& row, double index) {
  const auto before = std::min(static_cast<std::size_t>(index), row.size() - 2);
  const double share = index - static_cast<double>(before);
  return (1.0 - share) * row[before] + share * row[before + 1];
}

/// Where a row of costs is least, refined by the parabola through the neighbours.
double leastIndex(const Eigen::VectorXd& costs) {
  Eigen::Index best = 0;
  costs.minCoeff(&best);
  if (best == 0 || best + 1 == costs.size()) return static_cast<double>(best);
  const double curvature = costs[best - 1] - 2.0 * costs[best] + costs[best + 1];
  const double slope = costs[best - 1] - costs[best + 1];
  return static_cast<double>(best) + (curvature > 0.0 ? 0.5 * slope / curvature : 0.0);
}

/// The cost of the least minimum that is not beside the best one; ends of the row count.
double nextMinimum(const Eigen::VectorXd& costs, Eigen::Index best) {
  constexpr Eigen::Index kBeside = 2;  // a minimum is as wide as itself and two neighbours
  double next = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < costs.size(); ++i) {
    const bool falls = i == 0 || costs[i] <= costs[i - 1];
    const bool rises = i + 1 == costs.size() || costs[i] <= costs[i + 1];
    if (falls && rises && std::abs(i - best) > kBeside) next = std::min(next, costs[i]);
  }
  return next;
}

/// The turns by scans and, column by column, by the wheels at each offset.
class TurnTable {
public:
  TurnTable(Eigen::VectorXd by_scans, Eigen::MatrixXd by_wheels)
      : scans_(std::move(by_scans)),
        wheels_(std::move(by_wheels)),
        ratios_(Eigen::VectorXd::Ones(wheels_.cols())) {}

  double ratio(Eigen::Index offset) const { return ratios_[offset]; }

  /// Robust variance of the residuals at one offset, by their median.
  double variance(Eigen::Index offset) const {
    const Eigen::VectorXd sizes = residuals(offset).cwiseAbs();
    return std::pow(kDeviationPerMedian * median(std::vector<double>(sizes.begin(), sizes.end())),
                    2);
  }

  /// The ratio of turns at each offset, by one step of reweighted least squares.
  void fitRatios(double variance) {
    for (Eigen::Index j = 0; j < wheels_.cols(); ++j) {
      const Eigen::ArrayXd weights = 1.0 / (1.0 + residuals(j).array().square() / variance);
      const Eigen::ArrayXd weighted = weights * wheels_.col(j).array();
      const double squares = (weighted * wheels_.col(j).array()).sum();
      if (squares > 0.0) ratios_[j] = (weighted * scans_.array()).sum() / squares;
    }
  }

  /// Costs by block of successive turns (rows) and offset (columns).
  Eigen::MatrixXd costs(double variance, Eigen::Index block_count) const {
    Eigen::MatrixXd costs = Eigen::MatrixXd::Zero(block_count, wheels_.cols());
    for (Eigen::Index j = 0; j < wheels_.cols(); ++j) {
      const Eigen::VectorXd r = residuals(j);
      for (Eigen::Index i = 0; i < r.size(); ++i)
        costs(i * block_count / r.size(), j) += variance * std::log1p(r[i] * r[i] / variance);
    }
    return costs;
  }

private:
  Eigen::VectorXd residuals(Eigen::Index offset) const {
    return scans_ - ratios_[offset] * wheels_.col(offset);
  }

  Eigen::VectorXd scans_;
  Eigen::MatrixXd wheels_;
  Eigen::VectorXd ratios_;
};

/// Variance of the index of the minimum by leaving out one block at a time.
double jackknifeVariance(const Eigen::MatrixXd& costs) {
  const Eigen::VectorXd all = costs.colwise().sum();
  Eigen::VectorXd indices(costs.rows());
  for (Eigen::Index block = 0; block < costs.rows(); ++block)
    indices[block] = leastIndex(all - costs.row(block).transpose());
  const auto count = static_cast<double>(costs.rows());
  return (count - 1.0) / count * (indices.array() - indices.mean()).square().sum();
}

/// How far the minima of the first and the second half of the blocks are from each other.
double betweenHalves(const Eigen::MatrixXd& costs) {
  const Eigen::Index half = costs.rows() / 2;
  return std::abs(leastIndex(costs.topRows(half).colwise().sum()) -
                  leastIndex(costs.bottomRows(costs.rows() - half).colwise().sum()));
}

}  // namespace

const ram_parameters::ParameterTable<StampOffsetParameters>& StampOffsetParameters::table() {
  using namespace ram_parameters;
  using P = StampOffsetParameters;
  static const auto table =
      ParameterTable<P>()
          .add("step_s", &P::step_s, "s", within(0.001, 1.0),
               "Between the offsets that are compared; smaller ones are taken for 0.")
          .add("margin_s", &P::margin_s, "s", atLeast(0.0),
               "Offsets are compared up to this beyond the greatest that may be used: a minimum "
               "out there is seen and refused.")
          .add("min_turn_s", &P::min_turn_s, "s", positive(),
               "Turns are compared over at least this time ...")
          .add("max_turn_s", &P::max_turn_s, "s", positive(), "... and at most this time.")
          .rule(&P::max_turn_s, ">= min_turn_s",
                [](const P& p) { return p.max_turn_s >= p.min_turn_s; })
          .add("turn_rad", &P::turn_rad, "rad", positive(),
               "Turns of at least this angle, by the scans or the wheels, are compared.")
          .add("max_scan_deviation_rad", &P::max_scan_deviation_rad, "rad", positive(),
               "A scan counts if the standard deviation of its yaw, by the scan alone, is at most "
               "this: otherwise wheels would be compared with themselves.")
          .add("max_period_s", &P::max_period_s, "s", positive(),
               "Nothing is learned from scans or wheels that come more seldom: how the robot "
               "turned in between is not known.")
          .add("min_deviation_rad", &P::min_deviation_rad, "rad", positive(),
               "Least standard deviation of the difference of a turn by scans and wheels.")
          .add("min_turns", &P::min_turns, "", atLeast(10), "Turns before an offset is estimated.")
          .add("max_turns", &P::max_turns, "", atLeast(10), "Newest turns that count.")
          .rule(&P::max_turns, ">= min_turns",
                [](const P& p) { return p.max_turns >= p.min_turns; })
          .add("turns_between", &P::turns_between, "", atLeast(1),
               "Turns from one estimate to the next.")
          .add("block_count", &P::block_count, "", within(4, 10),
               "Blocks of turns whose scatter gives the standard deviation of the estimate.")
          .add("min_gain", &P::min_gain, "", positive(),
               "Twice the log-likelihood ratio of an offset against none that it needs, ...")
          .add("min_lead", &P::min_lead, "", atLeast(0.0),
               "... the same against the next local minimum, ...")
          .add("deviations", &P::deviations, "", positive(),
               "... and the number of its standard deviations that it must be away from 0.")
          .add("max_turn_ratio", &P::max_turn_ratio, "", atLeast(1.0),
               "Greatest ratio of the turns of scans and wheels, or of wheels and scans.")
          .add("min_evidence", &P::min_evidence, "", positive(),
               "Log-likelihood ratio against no offset that it needs on turns after the estimate, "
               "before it is used; one that loses as much is given up.");
  return table;
}

StampOffset::StampOffset(double max_offset_s, const StampOffsetParameters& parameters)
    : parameters_(parameters),
      step_ns_(toNanoseconds(parameters.step_s)),
      max_offset_ns_(toNanoseconds(max_offset_s)),
      last_offset_ns_(toNanoseconds(max_offset_s + parameters.margin_s)) {
  if (!(max_offset_s >= 0.0 && max_offset_s <= 1.0)) {
    throw std::invalid_argument("max_stamp_offset_s must be in [0, 1], got " +
                                std::to_string(max_offset_s));
  }
  last_offset_ns_ -= last_offset_ns_ % step_ns_;
  offset_count_ = static_cast<std::size_t>(2 * last_offset_ns_ / step_ns_) + 1;
}

void StampOffset::addWheels(const StampedPose2& odom_from_base) {
  if (max_offset_ns_ == 0) return;
  wheels_.push_back(odom_from_base);
  while (!waiting_.empty() &&
         waiting_.front().to.stamp_ns + last_offset_ns_ <= odom_from_base.stamp_ns) {
    compare(waiting_.front());
    waiting_.pop_front();
  }
  forgetWheels();
}

void StampOffset::forgetWheels() {
  const std::int64_t first_ns =
      waiting_.empty() ? wheels_.back().stamp_ns - 2 * toNanoseconds(parameters_.max_turn_s)
                       : waiting_.front().from.stamp_ns;
  while (wheels_.size() > 2 && wheels_[1].stamp_ns < first_ns - last_offset_ns_)
    wheels_.pop_front();
}

void StampOffset::addScan(const StampedPose2& odom_from_base) {
  if (max_offset_ns_ == 0) return;
  const std::int64_t stamp_ns = odom_from_base.stamp_ns;
  if (last_scan_ns_) {
    constexpr double kShare = 0.1;  // of a new interval in the mean
    const double interval_s = 1e-9 * static_cast<double>(stamp_ns - *last_scan_ns_);
    scan_period_s_ += (scan_period_s_ == 0.0 ? 1.0 : kShare) *
                      (std::min(interval_s, parameters_.max_turn_s) - scan_period_s_);
  }
  last_scan_ns_ = stamp_ns;
  if (!start_) {
    start_ = odom_from_base;
    return;
  }
  const double since_s = 1e-9 * static_cast<double>(stamp_ns - start_->stamp_ns);
  if (since_s < parameters_.min_turn_s) return;
  if (since_s <= parameters_.max_turn_s && !isTooSlow())
    waiting_.push_back({*start_, odom_from_base});
  start_ = odom_from_base;
}

bool StampOffset::isTooSlow() const {
  if (wheels_.size() < 2) return true;
  const double span_s =
      1e-9 * static_cast<double>(wheels_.back().stamp_ns - wheels_.front().stamp_ns);
  return scan_period_s_ > parameters_.max_period_s ||
         span_s > parameters_.max_period_s * static_cast<double>(wheels_.size() - 1);
}

void StampOffset::compare(const Interval& interval) {
  Turn turn;
  turn.by_scans_rad = wrapAngle(interval.to.pose.yaw_rad - interval.from.pose.yaw_rad);
  double greatest_rad = std::abs(turn.by_scans_rad);
  for (std::int64_t offset_ns = -last_offset_ns_; offset_ns <= last_offset_ns_;
       offset_ns += step_ns_) {
    const auto before = odometryAt(wheels_, interval.from.stamp_ns + offset_ns);
    const auto after = odometryAt(wheels_, interval.to.stamp_ns + offset_ns);
    if (!before || !after) return;
    turn.by_wheels_rad.push_back(wrapAngle(after->yaw_rad - before->yaw_rad));
    greatest_rad = std::max(greatest_rad, std::abs(turn.by_wheels_rad.back()));
  }
  if (greatest_rad >= parameters_.turn_rad) add(std::move(turn));
}

void StampOffset::add(Turn turn) {
  test(turn);
  turns_.push_back(std::move(turn));
  if (turns_.size() > static_cast<std::size_t>(parameters_.max_turns)) turns_.pop_front();
  ++turns_since_estimate_;
  if (candidate_ || turns_since_estimate_ < parameters_.turns_between ||
      turns_.size() < static_cast<std::size_t>(parameters_.min_turns))
    return;
  turns_since_estimate_ = 0;
  const Estimate found = estimate();
  if (!found.is_significant) return;
  const bool is_same = used_ && std::abs(found.index - used_->index) <
                                    std::max(0.5, 2.0 * std::sqrt(found.variance_of_index));
  if (is_same) return;
  candidate_ = found;
  candidate_evidence_ = 0.0;
}

void StampOffset::test(const Turn& turn) {
  if (used_) {
    used_evidence_ = std::min(parameters_.min_evidence, used_evidence_ + evidence(*used_, turn));
    if (used_evidence_ <= -parameters_.min_evidence) {
      used_.reset();
      candidate_.reset();
      turns_.clear();
      offset_ns_ = 0;
    }
  }
  if (!candidate_) return;
  candidate_evidence_ += evidence(*candidate_, turn);
  if (candidate_evidence_ >= parameters_.min_evidence) {
    used_ = candidate_;
    used_evidence_ = parameters_.min_evidence;
    offset_ns_ = toOffset_ns(used_->index);
  }
  if (std::abs(candidate_evidence_) >= parameters_.min_evidence) candidate_.reset();
}

double StampOffset::evidence(const Estimate& estimate, const Turn& turn) const {
  const double without =
      turn.by_scans_rad - estimate.turn_ratio_without * turn.by_wheels_rad[offset_count_ / 2];
  const double with =
      turn.by_scans_rad - estimate.turn_ratio * interpolated(turn.by_wheels_rad, estimate.index);
  return 0.5 * (std::log1p(without * without / estimate.variance_rad2) -
                std::log1p(with * with / estimate.variance_rad2));
}

std::int64_t StampOffset::toOffset_ns(double index) const {
  return static_cast<std::int64_t>(index * static_cast<double>(step_ns_)) - last_offset_ns_;
}

StampOffset::Estimate StampOffset::estimate() const {
  const auto turn_count = static_cast<Eigen::Index>(turns_.size());
  const auto offset_count = static_cast<Eigen::Index>(offset_count_);
  Eigen::VectorXd scans(turn_count);
  Eigen::MatrixXd wheels(turn_count, offset_count);
  for (Eigen::Index i = 0; i < turn_count; ++i) {
    const Turn& turn = turns_[static_cast<std::size_t>(i)];
    scans[i] = turn.by_scans_rad;
    wheels.row(i) = Eigen::Map<const Eigen::RowVectorXd>(turn.by_wheels_rad.data(), offset_count);
  }
  TurnTable table(std::move(scans), std::move(wheels));
  const double least = std::pow(parameters_.min_deviation_rad, 2);
  Eigen::Index best = offset_count / 2;
  double variance = std::max(least, table.variance(best));
  Eigen::MatrixXd costs;
  for (int iteration = 0; iteration < 2; ++iteration) {  // the second with the first's variance
    table.fitRatios(variance);
    table.fitRatios(variance);
    costs = table.costs(variance, parameters_.block_count);
    costs.colwise().sum().minCoeff(&best);
    if (iteration == 0) variance = std::max(least, table.variance(best));
  }
  Estimate found;
  found.variance_rad2 = variance;
  found.turn_ratio = table.ratio(best);
  found.turn_ratio_without = table.ratio(offset_count / 2);
  judge(costs, found);
  return found;
}

void StampOffset::judge(const Eigen::MatrixXd& costs, Estimate& found) const {
  const Eigen::VectorXd all = costs.colwise().sum();
  Eigen::Index best = 0;
  const double least = all.minCoeff(&best);
  found.index = leastIndex(all);
  const std::int64_t offset_ns = toOffset_ns(found.index);
  if (std::abs(offset_ns) > max_offset_ns_ - 2 * step_ns_ || best == 0 || best + 1 == all.size())
    return;
  const double variance = found.variance_rad2;
  const double curvature = all[best - 1] - 2.0 * all[best] + all[best + 1];
  const double by_curvature = 2.0 * variance / curvature;
  const double by_blocks = jackknifeVariance(costs);
  found.variance_of_index = std::max(by_curvature, by_blocks);
  const double deviation = std::sqrt(found.variance_of_index);
  const double gain = (all[all.size() / 2] - least) / variance;
  const double lead = (nextMinimum(all, best) - least) / variance;
  const double steps = std::abs(static_cast<double>(offset_ns)) / static_cast<double>(step_ns_);
  const double max_ratio = parameters_.max_turn_ratio;
  found.is_significant =
      curvature > 0.0 && gain >= parameters_.min_gain * std::max(1.0, by_blocks / by_curvature) &&
      lead >= parameters_.min_lead && steps >= std::max(1.0, parameters_.deviations * deviation) &&
      betweenHalves(costs) <= std::max(1.0, parameters_.deviations * 2.0 * deviation) &&
      found.turn_ratio <= max_ratio && found.turn_ratio >= 1.0 / max_ratio;
}

}  // namespace ram_slam
