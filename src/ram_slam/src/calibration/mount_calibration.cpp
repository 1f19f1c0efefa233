// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/mount_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "ram_slam/geometry/median.hpp"

namespace ram_slam {
namespace {

using Parameters = MountCalibrationParameters;

/// The same stretch of the drive by both.
struct Interval {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
  Pose2 laser;     ///< laser_from_laser
  Pose2 odometry;  ///< base_from_base
  bool used = true;
};

std::vector<Interval> cutIntoIntervals(const Trajectory& map_from_laser,
                                       const Parameters& parameters) {
  const auto max_interval_ns =
      static_cast<std::int64_t>(std::llround(parameters.max_interval_s * 1e9));
  std::vector<Interval> intervals;
  std::size_t first = 0;
  for (std::size_t i = 1; i < map_from_laser.size(); ++i) {
    const std::int64_t from_ns = map_from_laser[first].stamp_ns;
    if (map_from_laser[i].stamp_ns - from_ns > max_interval_ns) {
      first = i;
      continue;
    }
    const Pose2 motion = map_from_laser[first].pose.inverse() * map_from_laser[i].pose;
    if (!parameters.interval.isReachedBy(motion)) continue;
    intervals.push_back({from_ns, map_from_laser[i].stamp_ns, motion, {}, true});
    first = i;
  }
  return intervals;
}

/// Fills in the motions of the odometry; intervals that it does not cover are dropped.
std::vector<Interval> withOdometry(const std::vector<Interval>& intervals,
                                   const Trajectory& odom_from_base,
                                   double offset_s) {
  const auto offset_ns = static_cast<std::int64_t>(std::llround(offset_s * 1e9));
  std::vector<Interval> complete;
  for (Interval interval : intervals) {
    const auto before = poseAt(odom_from_base, interval.from_ns + offset_ns);
    const auto after = poseAt(odom_from_base, interval.to_ns + offset_ns);
    if (!before || !after) continue;
    interval.odometry = before->inverse() * *after;
    complete.push_back(interval);
  }
  return complete;
}

bool isTurn(const Interval& interval, const Parameters& parameters) {
  return std::abs(interval.laser.yaw_rad) >= parameters.turn_rad;
}

/// Leaves out the intervals whose errors are far beyond those of the others of their kind: turns
/// agree less well than straight ways, and are not to be lost for it.
void markOutliers(std::vector<Interval>& intervals,
                  const std::vector<double>& errors,
                  const Parameters& parameters) {
  for (const bool turn : {false, true}) {
    std::vector<double> of_kind;
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      if (isTurn(intervals[i], parameters) == turn) of_kind.push_back(errors[i]);
    }
    if (of_kind.empty()) continue;
    const double limit = parameters.outlier_deviations *
                         std::max(parameters.min_deviation, kDeviationPerMedian * median(of_kind));
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      if (isTurn(intervals[i], parameters) == turn) intervals[i].used = errors[i] <= limit;
    }
  }
}

struct Turns {
  double ratio = 1.0;
  double ratio_sigma = 0.0;
  double error = 0.0;  ///< median absolute error [rad]
};

/// By the turns among some intervals; nothing if there are too few.
std::optional<Turns> compareTurns(std::vector<Interval> intervals, const Parameters& parameters) {
  intervals.erase(
      std::remove_if(intervals.begin(), intervals.end(),
                     [&](const Interval& interval) { return !isTurn(interval, parameters); }),
      intervals.end());
  if (intervals.size() < static_cast<std::size_t>(parameters.min_turns)) return std::nullopt;
  Turns turns;
  std::vector<double> errors(intervals.size(), 0.0);
  for (int round = 0; round < parameters.rounds; ++round) {
    double products = 0.0;
    double squares = 1e-12;
    double residuals = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      if (!intervals[i].used) continue;
      products += intervals[i].laser.yaw_rad * intervals[i].odometry.yaw_rad;
      squares += intervals[i].odometry.yaw_rad * intervals[i].odometry.yaw_rad;
      residuals += errors[i] * errors[i];
      ++count;
    }
    turns.ratio = products / squares;
    turns.ratio_sigma = std::sqrt(residuals / static_cast<double>(count) / squares);
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      errors[i] = std::abs(
          wrapAngle(intervals[i].laser.yaw_rad - turns.ratio * intervals[i].odometry.yaw_rad));
    }
    turns.error = median(errors);
    markOutliers(intervals, errors, parameters);
  }
  return turns;
}

/// The offset at which the yaws agree best, between the steps by a parabola.
double findOffset(const std::vector<Interval>& intervals,
                  const Trajectory& odom_from_base,
                  const Parameters& parameters) {
  const double step_s = parameters.offset_step_s;
  const int steps = static_cast<int>(std::lround(parameters.max_offset_s / step_s));
  std::vector<double> errors;
  for (int i = -steps; i <= steps; ++i) {
    const auto shifted = withOdometry(intervals, odom_from_base, i * step_s);
    const auto turns = compareTurns(shifted, parameters);
    errors.push_back(turns ? turns->error : std::numeric_limits<double>::infinity());
  }
  const auto best = std::min_element(errors.begin(), errors.end()) - errors.begin();
  double fraction = 0.0;
  if (best > 0 && best + 1 < static_cast<std::ptrdiff_t>(errors.size())) {
    const double before = errors[static_cast<std::size_t>(best - 1)];
    const double here = errors[static_cast<std::size_t>(best)];
    const double after = errors[static_cast<std::size_t>(best + 1)];
    const double curvature = before - 2.0 * here + after;
    if (std::isfinite(curvature) && curvature > 0.0) fraction = 0.5 * (before - after) / curvature;
  }
  return (static_cast<double>(best) - steps + fraction) * step_s;
}

using Rows = Eigen::Matrix<double, 2, 5>;

/// (R - 1) t + d p_odometry - [p_laser, p_laser turned by 90 deg] (c, s) = 0, where R is the
/// rotation of the base, in (t_x, t_y, d, c, s).
Rows equation(const Interval& interval) {
  Rows rows;
  rows.leftCols<2>() =
      Eigen::Rotation2Dd(interval.laser.yaw_rad).toRotationMatrix() - Eigen::Matrix2d::Identity();
  // Where the odometry turns too little or too much its way is bent by half of that.
  const double bend_rad = 0.5 * wrapAngle(interval.laser.yaw_rad - interval.odometry.yaw_rad);
  rows.col(2) = Eigen::Rotation2Dd(bend_rad) * interval.odometry.translation();
  rows.col(3) = -interval.laser.translation();
  rows.col(4) = -Eigen::Vector2d(-interval.laser.y_m, interval.laser.x_m);
  return rows;
}

using Unknowns = Eigen::Matrix<double, 5, 1>;
using Normal = Eigen::Matrix<double, 5, 5>;

/// Least squares under c^2 + s^2 = 1: what is left when the free unknowns are eliminated is a
/// quadratic form of (c, s).
std::optional<Unknowns> solve(const Normal& normal) {
  const Eigen::FullPivLU<Eigen::Matrix3d> free(normal.topLeftCorner<3, 3>());
  if (!free.isInvertible()) return std::nullopt;
  const Eigen::Matrix<double, 3, 2> eliminated = free.solve(normal.topRightCorner<3, 2>());
  const Eigen::Matrix2d rest =
      normal.bottomRightCorner<2, 2>() - normal.bottomLeftCorner<2, 3>() * eliminated;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(0.5 * (rest + rest.transpose()));
  Unknowns unknowns;
  unknowns.tail<2>() = eigen.eigenvectors().col(0);
  unknowns.head<3>() = -eliminated * unknowns.tail<2>();
  if (unknowns[2] < 0.0) unknowns = -unknowns;  // the odometry does not run backwards
  return unknowns;
}

struct Fit {
  Unknowns unknowns = Unknowns::Zero();
  Normal normal = Normal::Zero();
  double squares = 0.0;  ///< of the errors of the motions that are used
  std::size_t used = 0;
};

/// Least squares over several rounds, each without the outliers of the round before.
std::optional<Fit> fitMount(std::vector<Interval>& intervals, const Parameters& parameters) {
  Fit fit;
  for (int round = 0; round < parameters.rounds; ++round) {
    fit.normal.setZero();
    for (const Interval& interval : intervals) {
      if (interval.used) fit.normal += equation(interval).transpose() * equation(interval);
    }
    const auto solution = solve(fit.normal);
    if (!solution) return std::nullopt;
    fit.unknowns = *solution;
    std::vector<double> errors;
    fit.squares = 0.0;
    fit.used = 0;
    for (const Interval& interval : intervals) {
      errors.push_back((equation(interval) * fit.unknowns).norm());
      if (!interval.used) continue;
      fit.squares += errors.back() * errors.back();
      ++fit.used;
    }
    if (round + 1 < parameters.rounds) markOutliers(intervals, errors, parameters);
  }
  return fit;
}

/// Standard deviations of (t_x, t_y, d, yaw).
Eigen::Vector4d deviations(const Fit& fit) {
  // The derivative of (c, s) by the yaw is (-s, c).
  Eigen::Matrix<double, 5, 4> tangent = Eigen::Matrix<double, 5, 4>::Zero();
  tangent.topLeftCorner<3, 3>().setIdentity();
  tangent.bottomRightCorner<2, 1>() << -fit.unknowns[4], fit.unknowns[3];
  const Eigen::Matrix4d information = tangent.transpose() * fit.normal * tangent;
  const double variance =
      fit.squares / static_cast<double>(std::max<std::size_t>(2 * fit.used, 5) - 4);
  return (variance * information.inverse()).diagonal().cwiseMax(0.0).cwiseSqrt();
}

}  // namespace

const ram_parameters::ParameterTable<MountCalibrationParameters>&
MountCalibrationParameters::table() {
  using namespace ram_parameters;
  using P = MountCalibrationParameters;
  static const auto table =
      ParameterTable<P>()
          .include(&P::interval,
                   motionGateTable("Motion over which wheels and scans are compared."), "interval_")
          .add("max_interval_s", &P::max_interval_s, "s", positive(),
               "A motion that takes longer is not used.")
          .add("min_intervals", &P::min_intervals, "", atLeast(3),
               "Fewer motions give no calibration.")
          .add("min_turns", &P::min_turns, "", atLeast(1), "Fewer turns give no calibration.")
          .add("turn_rad", &P::turn_rad, "rad", positive(), "A motion with this angle is a turn.")
          .add("max_offset_s", &P::max_offset_s, "s", atLeast(0.0),
               "Greatest offset of the stamps, to each side.")
          .add("offset_step_s", &P::offset_step_s, "s", positive(),
               "Between the offsets that are tried.")
          .add("outlier_deviations", &P::outlier_deviations, "", positive(),
               "Motions whose error is beyond so many robust standard deviations are left out.")
          .add("min_deviation", &P::min_deviation, "m, rad", positive(),
               "Least robust standard deviation: motions that agree exactly have no outliers.")
          .add("rounds", &P::rounds, "", atLeast(1),
               "Fits by least squares, each without the outliers of the one before.");
  return table;
}

std::optional<MountCalibration> calibrateMount(const Trajectory& odom_from_base,
                                               const Trajectory& map_from_laser,
                                               const MountCalibrationParameters& parameters) {
  validate(odom_from_base);
  validate(map_from_laser);
  const auto min_intervals = static_cast<std::size_t>(parameters.min_intervals);
  const std::vector<Interval> cut = cutIntoIntervals(map_from_laser, parameters);
  if (cut.size() < min_intervals) return std::nullopt;
  MountCalibration calibration;
  calibration.stamp_offset_s = findOffset(cut, odom_from_base, parameters);
  std::vector<Interval> intervals = withOdometry(cut, odom_from_base, calibration.stamp_offset_s);
  if (intervals.size() < min_intervals) return std::nullopt;
  const auto turns = compareTurns(intervals, parameters);
  if (!turns) return std::nullopt;
  calibration.turn_ratio = turns->ratio;
  calibration.turn_ratio_sigma = turns->ratio_sigma;

  const auto fit = fitMount(intervals, parameters);
  if (!fit) return std::nullopt;
  const double yaw_rad = std::atan2(fit->unknowns[4], fit->unknowns[3]);
  calibration.base_from_laser = {fit->unknowns[0], fit->unknowns[1], yaw_rad};
  calibration.distance_ratio = fit->unknowns[2];
  calibration.interval_count = intervals.size();
  calibration.slip_count = intervals.size() - fit->used;
  const Eigen::Vector4d sigma = deviations(*fit);
  calibration.mount_sigma << sigma[0], sigma[1], sigma[3];
  calibration.distance_ratio_sigma = sigma[2];
  return calibration;
}

}  // namespace ram_slam
