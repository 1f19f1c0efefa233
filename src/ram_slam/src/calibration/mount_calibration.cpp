// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/mount_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

namespace ram_slam {
namespace {

// A motion ends when the robot has moved this far, or turned by so much.
constexpr double kIntervalM = 0.5;
constexpr double kIntervalRad = 0.3;
constexpr std::int64_t kLongestIntervalNs = 5'000'000'000;
constexpr std::size_t kLeastIntervals = 20;
constexpr std::size_t kLeastTurns = 10;
constexpr double kTurnRad = 0.1;  // from here on a motion is a turn
constexpr double kMostOffsetS = 0.5;
constexpr double kOffsetStepS = 0.02;
constexpr double kOutlier = 4.0;      // robust standard deviations
constexpr double kLeastScale = 1e-4;  // of an error [m, rad]: what agrees exactly is no outlier
constexpr int kRounds = 3;

/// The same stretch of the drive by both.
struct Interval {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
  Pose2 laser;     ///< laser_from_laser
  Pose2 odometry;  ///< base_from_base
  bool used = true;
};

std::vector<Interval> cutIntoIntervals(const Trajectory& map_from_laser) {
  std::vector<Interval> intervals;
  std::size_t first = 0;
  for (std::size_t i = 1; i < map_from_laser.size(); ++i) {
    const std::int64_t from_ns = map_from_laser[first].stamp_ns;
    if (map_from_laser[i].stamp_ns - from_ns > kLongestIntervalNs) {
      first = i;
      continue;
    }
    const Pose2 motion = map_from_laser[first].pose.inverse() * map_from_laser[i].pose;
    if (motion.translation().norm() < kIntervalM && std::abs(motion.yaw_rad) < kIntervalRad)
      continue;
    intervals.push_back({from_ns, map_from_laser[i].stamp_ns, motion, {}, true});
    first = i;
  }
  return intervals;
}

/// Fills in what the odometry says; intervals that it does not cover are dropped.
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

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool isTurn(const Interval& interval) {
  return std::abs(interval.laser.yaw_rad) >= kTurnRad;
}

/// Leaves out the intervals whose errors are far beyond those of the others of their kind: turns
/// agree less well than straight ways, and are not to be lost for it.
void markOutliers(std::vector<Interval>& intervals, const std::vector<double>& errors) {
  for (const bool turn : {false, true}) {
    std::vector<double> of_kind;
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      if (isTurn(intervals[i]) == turn) of_kind.push_back(errors[i]);
    }
    if (of_kind.empty()) continue;
    const double limit = kOutlier * std::max(kLeastScale, 1.4826 * median(of_kind));
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      if (isTurn(intervals[i]) == turn) intervals[i].used = errors[i] <= limit;
    }
  }
}

struct Turns {
  double ratio = 1.0;
  double ratio_sigma = 0.0;
  double error = 0.0;  ///< median absolute error [rad]
};

/// By the turns among some intervals; nothing if there are too few.
std::optional<Turns> compareTurns(std::vector<Interval> intervals) {
  intervals.erase(std::remove_if(intervals.begin(), intervals.end(),
                                 [](const Interval& interval) { return !isTurn(interval); }),
                  intervals.end());
  if (intervals.size() < kLeastTurns) return std::nullopt;
  Turns turns;
  std::vector<double> errors(intervals.size(), 0.0);
  for (int round = 0; round < kRounds; ++round) {
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
    markOutliers(intervals, errors);
  }
  return turns;
}

/// The offset at which the yaws agree best, between the steps by a parabola.
double findOffset(const std::vector<Interval>& intervals, const Trajectory& odom_from_base) {
  const int steps = static_cast<int>(std::lround(kMostOffsetS / kOffsetStepS));
  std::vector<double> errors;
  for (int i = -steps; i <= steps; ++i) {
    const auto shifted = withOdometry(intervals, odom_from_base, i * kOffsetStepS);
    const auto turns = compareTurns(shifted);
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
  return (static_cast<double>(best) - steps + fraction) * kOffsetStepS;
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

}  // namespace

std::optional<MountCalibration> calibrateMount(const Trajectory& odom_from_base,
                                               const Trajectory& map_from_laser) {
  validate(odom_from_base);
  validate(map_from_laser);
  const std::vector<Interval> cut = cutIntoIntervals(map_from_laser);
  if (cut.size() < kLeastIntervals) return std::nullopt;
  MountCalibration calibration;
  calibration.stamp_offset_s = findOffset(cut, odom_from_base);
  std::vector<Interval> intervals = withOdometry(cut, odom_from_base, calibration.stamp_offset_s);
  if (intervals.size() < kLeastIntervals) return std::nullopt;
  const auto turns = compareTurns(intervals);
  if (!turns) return std::nullopt;
  calibration.turn_ratio = turns->ratio;
  calibration.turn_ratio_sigma = turns->ratio_sigma;

  Unknowns unknowns = Unknowns::Zero();
  Normal normal = Normal::Zero();
  double squares = 0.0;
  std::size_t used = 0;
  for (int round = 0; round < kRounds; ++round) {
    normal.setZero();
    for (const Interval& interval : intervals) {
      if (interval.used) normal += equation(interval).transpose() * equation(interval);
    }
    const auto solution = solve(normal);
    if (!solution) return std::nullopt;
    unknowns = *solution;
    std::vector<double> errors;
    squares = 0.0;
    used = 0;
    for (const Interval& interval : intervals) {
      errors.push_back((equation(interval) * unknowns).norm());
      if (!interval.used) continue;
      squares += errors.back() * errors.back();
      ++used;
    }
    if (round + 1 < kRounds) markOutliers(intervals, errors);
  }
  const double yaw_rad = std::atan2(unknowns[4], unknowns[3]);
  calibration.base_from_laser = {unknowns[0], unknowns[1], yaw_rad};
  calibration.distance_ratio = unknowns[2];
  calibration.interval_count = intervals.size();
  calibration.slip_count = intervals.size() - used;

  // In (t_x, t_y, d, yaw): the derivative of (c, s) by the yaw is (-s, c).
  Eigen::Matrix<double, 5, 4> tangent = Eigen::Matrix<double, 5, 4>::Zero();
  tangent.topLeftCorner<3, 3>().setIdentity();
  tangent.bottomRightCorner<2, 1>() << -unknowns[4], unknowns[3];
  const Eigen::Matrix4d information = tangent.transpose() * normal * tangent;
  const double variance = squares / static_cast<double>(std::max<std::size_t>(2 * used, 5) - 4);
  const Eigen::Vector4d sigma =
      (variance * information.inverse()).diagonal().cwiseMax(0.0).cwiseSqrt();
  calibration.mount_sigma << sigma[0], sigma[1], sigma[3];
  calibration.distance_ratio_sigma = sigma[2];
  return calibration;
}

}  // namespace ram_slam
