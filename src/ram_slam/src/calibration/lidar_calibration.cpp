// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/lidar_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace ram_slam {
namespace {

/// So that what no scan shows stays zero.
template <int kSize>
Eigen::Matrix<double, kSize, kSize> regularised(
    const Eigen::Matrix<double, kSize, kSize>& information) {
  return information + 1e-6 * Eigen::Matrix<double, kSize, kSize>::Identity();
}

Eigen::Array2d toArray(const LidarCorrection& correction) {
  return {correction.turn_s, correction.range_m};
}

LidarCorrection toCorrection(const Eigen::Array2d& values) {
  return {values(0), values(1)};
}

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
          .add("max_range_m", &P::max_range_m, "m", within(0.0, 0.5),
               "Greatest correction of the readings; 0: none is learned. Where scans are bent by "
               "something else false ones can appear.")
          .add("min_turn_s", &P::min_turn_s, "s", atLeast(0.0),
               "Smaller corrections of the turn are not used: no mirror is as fast.")
          .add("min_range_m", &P::min_range_m, "m", atLeast(0.0), "The same of the readings.")
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
               "A correction that is taken is at least so many of its standard deviations; one "
               "that is kept, half as many.");
  return table;
}

LidarCalibration::LidarCalibration(const LidarCalibrationParameters& parameters)
    : parameters_(parameters),
      least_(parameters.min_turn_s, parameters.min_range_m),
      most_(parameters.max_turn_s, parameters.max_range_m) {}

void LidarCalibration::add(const ScanPairSum& pair) {
  const auto pose = regularised<3>(pair.information.topLeftCorner<3, 3>());
  const Eigen::Matrix<double, 3, 2> cross = pair.information.topRightCorner<3, 2>();
  const Eigen::Matrix<double, 3, 2> eliminated = pose.ldlt().solve(cross);
  const Eigen::Matrix2d information =
      pair.information.bottomRightCorner<2, 2>() - cross.transpose() * eliminated;
  const Eigen::Vector2d gradient =
      pair.gradient.tail<2>() - eliminated.transpose() * pair.gradient.head<3>();
  block_.information += information;
  block_.weighted += information * toArray(correction_).matrix() - gradient;
}

void LidarCalibration::endBlock() {
  const Block block = std::exchange(block_, {});
  if (!(block.information.trace() > 0.0)) return;
  blocks_.push_back(block);
  if (blocks_.size() > static_cast<std::size_t>(parameters_.max_blocks)) blocks_.pop_front();
  if (blocks_.size() < static_cast<std::size_t>(parameters_.min_blocks)) return;

  Eigen::Vector2d used = (most_ > 0.0).cast<double>().matrix();
  Solution solution = solve(used);
  // Without the one that is not significant the other has other values.
  for (const Eigen::Index which : {1, 0, 1}) {
    if (used(which) == 0.0 || isSignificant(solution, which)) continue;
    used(which) = 0.0;
    solution = solve(used);
  }
  use(solution);
}

LidarCalibration::Solution LidarCalibration::solve(const Eigen::Vector2d& used) const {
  Block sum;
  for (const Block& block : blocks_) {
    sum.information += block.information;
    sum.weighted += block.weighted;
  }
  const auto mask = used.asDiagonal();
  const Eigen::Matrix2d inverse =
      mask * regularised<2>(mask * sum.information * mask).inverse() * mask;
  const Eigen::Vector2d values = inverse * sum.weighted;
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const Block& block : blocks_) {
    const Eigen::Vector2d residual = block.weighted - block.information * values;
    scatter += residual * residual.transpose();
  }
  return {values, (inverse * scatter * inverse).diagonal().array().max(0.0).sqrt()};
}

bool LidarCalibration::isSignificant(const Solution& solution, Eigen::Index which) const {
  const double size = std::abs(solution.values(which));
  // One that is in use is given up later than it was taken.
  const double deviations =
      (toArray(correction_)(which) == 0.0 ? 1.0 : 0.5) * parameters_.deviations;
  return size >= least_(which) && size <= most_(which) &&
         size >= deviations * solution.deviations(which);
}

void LidarCalibration::use(const Solution& solution) {
  const Eigen::Array2d before = toArray(correction_);
  const auto is_new = (solution.values == 0.0) != (before == 0.0);
  const auto has_moved = (solution.values - before).abs() > solution.deviations;
  if (!(is_new || has_moved).any()) return;
  correction_ = toCorrection(solution.values);
  deviation_ = toCorrection(solution.deviations);
}

std::string toText(const LidarCalibration& calibration) {
  const LidarCorrection& correction = calibration.correction();
  const LidarCorrection& deviation = calibration.deviation();
  std::ostringstream text;
  text << std::fixed << std::setprecision(1);
  if (correction.turn_s != 0.0) {
    text << "one turn of the mirror takes " << 1e3 * std::abs(correction.turn_s) << " ms (+- "
         << 1e3 * deviation.turn_s << " ms) "
         << (correction.turn_s > 0.0 ? "longer than stated" : "less than stated, or is clockwise");
  }
  if (correction == LidarCorrection{}) text << "as its driver states, as far as the scans show";
  if (correction.turn_s != 0.0 && correction.range_m != 0.0) text << "; ";
  if (correction.range_m != 0.0) {
    text << "readings are " << 1e3 * std::abs(correction.range_m) << " mm (+- "
         << 1e3 * deviation.range_m << " mm) too " << (correction.range_m > 0.0 ? "short" : "long");
  }
  return text.str();
}

LaserScan corrected(LaserScan scan, const LidarCorrection& correction) {
  if (correction.turn_s != 0.0) {
    const double increments_per_turn = 2.0 * M_PI / scan.angle_increment_rad;
    const double turn_s = scan.time_increment_s * increments_per_turn + correction.turn_s;
    scan = inSweepDirection(
        turn_s < 0.0 ? SweepDirection::kClockwise : SweepDirection::kCounterclockwise,
        std::move(scan));
    scan.time_increment_s = std::abs(turn_s / increments_per_turn);
  }
  if (correction.range_m == 0.0) return scan;
  const auto offset_m = static_cast<float>(correction.range_m);
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    if (scan.at(beam) != Return::kHit) continue;
    float& range_m = scan.ranges_m[beam];
    range_m = std::clamp(range_m + offset_m, scan.range_min_m, scan.range_max_m);
  }
  return scan;
}

}  // namespace ram_slam
