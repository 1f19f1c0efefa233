// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/lidar_calibration.hpp"

#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace ram_slam {
namespace {

/// So that what no scan shows stays zero.
constexpr double kRegularisation = 1e-6;

}  // namespace

const ram_parameters::ParameterTable<LidarCalibrationParameters>&
LidarCalibrationParameters::table() {
  using namespace ram_parameters;
  using P = LidarCalibrationParameters;
  static const auto table =
      ParameterTable<P>()
          .add("max_turn_s", &P::max_turn_s, "s", within(0.0, 1.0),
               "Greatest correction of the time that the mirror takes for one turn; 0: none is "
               "learned.")
          .add("min_turn_s", &P::min_turn_s, "s", atLeast(0.0),
               "Smaller corrections of that time are not used: no mirror is as fast.")
          .add(
              "min_turn_rate_radps", &P::min_turn_rate_radps, "rad/s", positive(),
              "A scan that is no key scan is compared with key scans only if its turn rate differs "
              "from theirs by this.")
          .add("max_interval_s", &P::max_interval_s, "s", positive(),
               "Longest time between two scans over which the speed is known.")
          .add("min_blocks", &P::min_blocks, "", atLeast(3),
               "Sets of key scans that scans were compared with, before a correction is used.")
          .add("max_blocks", &P::max_blocks, "", atLeast(3), "The newest of them, which count.")
          .rule(&P::max_blocks, ">= min_blocks",
                [](const P& p) { return p.max_blocks >= p.min_blocks; })
          .add("deviations", &P::deviations, "", positive(),
               "A correction that is taken is at least so many of its standard deviations, one "
               "that is kept half as many; the mirror turn is longer than the time between scans "
               "by at most so many.");
  return table;
}

LidarCalibration::LidarCalibration(const LidarCalibrationParameters& parameters)
    : parameters_(parameters) {}

void LidarCalibration::add(const ScanPairSum& pair, const Timing& timing) {
  const Eigen::Matrix3d pose =
      pair.information.topLeftCorner<3, 3>() + kRegularisation * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d cross = pair.information.topRightCorner<3, 1>();
  const Eigen::Vector3d eliminated = pose.ldlt().solve(cross);
  const double information = pair.information(3, 3) - cross.dot(eliminated);
  const double gradient = pair.gradient(3) - eliminated.dot(pair.gradient.head<3>());
  block_.information += information;
  block_.weighted += information * used_.mirror_turn_s - gradient;
  ++block_.pair_count;
  block_.intervals_s += timing.interval_s;
  stated_mirror_turn_s_ = timing.mirror_turn_s - used_.mirror_turn_s;
}

void LidarCalibration::endBlock() {
  const Block block = std::exchange(block_, {});
  if (!(block.information > 0.0)) return;
  blocks_.push_back(block);
  if (blocks_.size() > static_cast<std::size_t>(parameters_.max_blocks)) blocks_.pop_front();
  if (blocks_.size() < static_cast<std::size_t>(parameters_.min_blocks)) return;

  const Block sum = sumOfBlocks();
  const Solution solution = solve(sum);
  const bool is_used = isUsable(solution) && isPossible(solution, sum.intervals_s / sum.pair_count);
  use(is_used ? solution : Solution{});
}

LidarCalibration::Block LidarCalibration::sumOfBlocks() const {
  Block sum;
  for (const Block& block : blocks_) {
    sum.information += block.information;
    sum.weighted += block.weighted;
    sum.pair_count += block.pair_count;
    sum.intervals_s += block.intervals_s;
  }
  return sum;
}

LidarCalibration::Solution LidarCalibration::solve(const Block& sum) const {
  const double variance = 1.0 / (sum.information + kRegularisation);
  const double mirror_turn_s = variance * sum.weighted;
  double scatter = 0.0;
  for (const Block& block : blocks_)
    scatter += std::pow(block.weighted - block.information * mirror_turn_s, 2);
  return {mirror_turn_s, variance * std::sqrt(scatter)};
}

bool LidarCalibration::isUsable(const Solution& solution) const {
  const double size_s = std::abs(solution.mirror_turn_s);
  // One that is in use is given up later than it was taken.
  const double deviations = (used_.mirror_turn_s == 0.0 ? 1.0 : 0.5) * parameters_.deviations;
  return size_s >= parameters_.min_turn_s && size_s <= parameters_.max_turn_s &&
         size_s >= deviations * solution.deviation_s;
}

bool LidarCalibration::isPossible(const Solution& solution, double mean_interval_s) const {
  const double mirror_turn_s = std::abs(stated_mirror_turn_s_ + solution.mirror_turn_s);
  return mirror_turn_s <= mean_interval_s + parameters_.deviations * solution.deviation_s;
}

void LidarCalibration::use(const Solution& solution) {
  const bool is_new = (solution.mirror_turn_s == 0.0) != (used_.mirror_turn_s == 0.0);
  const bool has_moved =
      std::abs(solution.mirror_turn_s - used_.mirror_turn_s) > solution.deviation_s;
  if (is_new || has_moved) used_ = solution;
}

std::string toText(const LidarCalibration& calibration) {
  const double added_s = calibration.addedMirrorTurn_s();
  if (added_s == 0.0) return "as its driver states, as far as the scans show";
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << "one turn of the mirror takes "
       << 1e3 * std::abs(added_s) << " ms (+- " << 1e3 * calibration.deviation_s() << " ms) "
       << (added_s > 0.0 ? "longer than stated" : "less than stated, or is clockwise");
  return text.str();
}

double mirrorTurn_s(const LaserScan& scan) {
  return scan.time_increment_s * (2.0 * M_PI / scan.angle_increment_rad);
}

LaserScan corrected(LaserScan scan, double added_mirror_turn_s) {
  if (added_mirror_turn_s == 0.0) return scan;
  const double increments_per_turn = 2.0 * M_PI / scan.angle_increment_rad;
  const double mirror_turn_s = mirrorTurn_s(scan) + added_mirror_turn_s;
  scan = inSweepDirection(
      mirror_turn_s < 0.0 ? SweepDirection::kClockwise : SweepDirection::kCounterclockwise,
      std::move(scan));
  scan.time_increment_s = std::abs(mirror_turn_s / increments_per_turn);
  return scan;
}

}  // namespace ram_slam
