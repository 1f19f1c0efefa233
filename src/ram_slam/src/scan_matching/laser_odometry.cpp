// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/laser_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/Dense>

#include "ram_parameters/require.hpp"
#include "ram_slam/scan_matching/correlative_search.hpp"

namespace ram_slam {
namespace {

constexpr double kSlipDeviations = 4.0;  // beyond so many deviations the wheels are not believed
constexpr double kSearchResolutionM = 0.05;
constexpr double kSearchDeviationM = 0.06;
constexpr int kSearchLevels = 4;
constexpr std::size_t kSearchPoints = 150;
constexpr double kMinSearchScore = 0.35;
constexpr double kWideSearchAngleRad =
    3.2;                            // all round, when a search about the prediction has failed
constexpr double kIntervalM = 0.3;  // over which the bias of the wheels shows
constexpr double kIntervalRad = 0.3;
constexpr double kWeakPriorFactor = 100.0;  // by which the variance of disbelieved wheels grows
// A motion that scans tell and wheels do not, farther than this plus the time at these speeds: the
// robot was carried away, or the scan laid over the wrong walls.
constexpr double kReachM = 0.05;
constexpr double kReachRad = 0.05;
constexpr double kFastestMps = 2.0;
constexpr double kFastestRadps = 4.0;
// Wheels that move less stand still; they are stuck if the robot has moved that far meanwhile.
constexpr double kStandingM = 0.001;
constexpr double kStandingRad = 0.001;
constexpr double kStuckM = 0.15;
constexpr double kStuckRad = 0.15;

using ram_parameters::require;
using ram_parameters::requirePositive;

/// A covariance of (x, y, yaw) turned into the axes of a frame that the first one is rotated in.
Eigen::Matrix3d rotate(const Eigen::Matrix3d& covariance, double yaw_rad) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  rotation.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(yaw_rad).toRotationMatrix();
  return rotation * covariance * rotation.transpose();
}

/// The covariance of (x, y, yaw) of one point of a rigid body, from that of another `lever` away.
Eigen::Matrix3d shiftCovariance(const Eigen::Matrix3d& covariance, const Eigen::Vector2d& lever) {
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
  jacobian(0, 2) = -lever.y();
  jacobian(1, 2) = lever.x();
  return jacobian * covariance * jacobian.transpose();
}

Eigen::Vector3d difference(const Pose2& a, const Pose2& b) {
  return {a.x_m - b.x_m, a.y_m - b.y_m, wrapAngle(a.yaw_rad - b.yaw_rad)};
}

/// Whether no robot gets so far in that time.
bool isOutOfReach(const Pose2& motion, double interval_s) {
  return motion.translation().norm() > kReachM + kFastestMps * interval_s ||
         std::abs(motion.yaw_rad) > kReachRad + kFastestRadps * interval_s;
}

std::vector<Eigen::Vector2f> spread(const std::vector<SurfacePoint>& points,
                                    std::size_t max_count) {
  const std::size_t stride = std::max<std::size_t>(1, (points.size() + max_count - 1) / max_count);
  std::vector<Eigen::Vector2f> some;
  for (std::size_t i = 0; i < points.size(); i += stride)
    some.emplace_back(points[i].x_m, points[i].y_m);
  return some;
}

}  // namespace

void LaserOdometryParameters::validate() const {
  surfaces.validate();
  matcher.validate();
  requirePositive("key_scan_distance_m", key_scan_distance_m);
  requirePositive("key_scan_angle_rad", key_scan_angle_rad);
  require(key_scan_inlier_ratio >= 0.0 && key_scan_inlier_ratio <= 1.0, "key_scan_inlier_ratio",
          key_scan_inlier_ratio, "in [0, 1]");
  require(key_scan_count >= 1, "key_scan_count", key_scan_count, ">= 1");
  require(reference_count >= 1 && reference_count <= key_scan_count, "reference_count",
          reference_count, "in [1, key_scan_count]");
  requirePositive("wheel_rest_deviation_m", wheel_rest_deviation_m);
  requirePositive("wheel_rest_deviation_rad", wheel_rest_deviation_rad);
  requirePositive("wheel_distance_deviation_m_per_m", wheel_distance_deviation_m_per_m);
  requirePositive("wheel_yaw_deviation_rad_per_m", wheel_yaw_deviation_rad_per_m);
  requirePositive("wheel_yaw_deviation_rad_per_rad", wheel_yaw_deviation_rad_per_rad);
  require(max_stamp_offset_s >= 0.0 && max_stamp_offset_s <= 1.0, "max_stamp_offset_s",
          max_stamp_offset_s, "in [0, 1]");
  requirePositive("acceleration_deviation_m_per_s2", acceleration_deviation_m_per_s2);
  requirePositive("yaw_acceleration_deviation_rad_per_s2", yaw_acceleration_deviation_rad_per_s2);
  require(lost_inlier_ratio >= 0.0 && lost_inlier_ratio <= 1.0, "lost_inlier_ratio",
          lost_inlier_ratio, "in [0, 1]");
  requirePositive("search_distance_m", search_distance_m);
  requirePositive("search_angle_rad", search_angle_rad);
}

LaserOdometryParameters readLaserOdometryParameters(ram_parameters::ParameterReader& reader) {
  LaserOdometryParameters parameters;
  reader.read("odom_frame", parameters.odom_frame);
  reader.read("base_frame", parameters.base_frame);
  reader.read("use_wheels", parameters.use_wheels);
  readScanMatching(reader, parameters.surfaces, parameters.matcher);
  reader.read("key_scan_distance_m", parameters.key_scan_distance_m);
  reader.read("key_scan_angle_rad", parameters.key_scan_angle_rad);
  reader.read("key_scan_inlier_ratio", parameters.key_scan_inlier_ratio);
  reader.read("key_scan_count", parameters.key_scan_count);
  reader.read("reference_count", parameters.reference_count);
  reader.read("wheel_rest_deviation_m", parameters.wheel_rest_deviation_m);
  reader.read("wheel_rest_deviation_rad", parameters.wheel_rest_deviation_rad);
  reader.read("wheel_distance_deviation_m_per_m", parameters.wheel_distance_deviation_m_per_m);
  reader.read("wheel_yaw_deviation_rad_per_m", parameters.wheel_yaw_deviation_rad_per_m);
  reader.read("wheel_yaw_deviation_rad_per_rad", parameters.wheel_yaw_deviation_rad_per_rad);
  reader.read("max_stamp_offset_s", parameters.max_stamp_offset_s);
  reader.read("acceleration_deviation_m_per_s2", parameters.acceleration_deviation_m_per_s2);
  reader.read("yaw_acceleration_deviation_rad_per_s2",
              parameters.yaw_acceleration_deviation_rad_per_s2);
  reader.read("lost_inlier_ratio", parameters.lost_inlier_ratio);
  reader.read("search_distance_m", parameters.search_distance_m);
  reader.read("search_angle_rad", parameters.search_angle_rad);
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
}

LaserOdometry::LaserOdometry(const LaserOdometryParameters& parameters) : parameters_(parameters) {
  parameters_.validate();
}

LaserOdometryEstimate LaserOdometry::update(const LaserScan& scan,
                                            const Pose2& base_from_laser,
                                            const std::optional<Pose2>& odom_from_base) {
  if (!base_from_laser.isFinite() || (odom_from_base && !odom_from_base->isFinite())) {
    throw std::invalid_argument("pose not finite");
  }
  if (key_scans_.empty()) {
    SurfaceScan surfaces = extractSurfaces(scan, parameters_.surfaces);
    last_.stamp_ns = scan.stamp_ns;
    last_.odom_from_base.pose = odom_from_base.value_or(Pose2{});
    last_.inlier_ratio = 1.0;
    key_scans_.push_back({std::move(surfaces), last_.odom_from_base.pose * base_from_laser});
    last_wheels_ = odom_from_base;
    return last_;
  }
  if (scan.stamp_ns <= last_.stamp_ns) {
    throw std::invalid_argument("scan of stamp " + std::to_string(scan.stamp_ns) +
                                " ns, not later than the last one, " +
                                std::to_string(last_.stamp_ns) + " ns");
  }

  const Prediction prediction = predict(scan.stamp_ns, odom_from_base);
  const Pose2 laser_motion = base_from_laser.inverse() * prediction.motion * base_from_laser;
  SurfaceScan surfaces =
      extractSurfaces(scan, parameters_.surfaces,
                      continued(laser_motion, scan.stamp_ns - last_.stamp_ns, scan.duration_ns()));
  LaserOdometryEstimate estimate;
  estimate.stamp_ns = scan.stamp_ns;
  ScanMatch found = match(surfaces, base_from_laser, prediction, estimate.wheels_slipped);
  estimate.inlier_ratio = found.inlier_ratio;
  const Pose2& before = last_.odom_from_base.pose;
  const double interval_s = 1e-9 * static_cast<double>(scan.stamp_ns - last_.stamp_ns);
  const Pose2 told = before.inverse() * found.map_from_laser * base_from_laser.inverse();
  estimate.jumped = odom_from_base && last_wheels_ && isOutOfReach(told, interval_s) &&
                    isOutOfReach(prediction.motion.inverse() * told, interval_s);
  if (estimate.jumped) {
    // Whatever walls the scan was laid over, the robot cannot have got there: it goes on from where
    // the wheels lead.
    found.map_from_laser = before * prediction.motion * base_from_laser;
    found.information.setZero();
    key_scans_.clear();
  }

  // Covariance of the laser in the odometry axes, then of the base in the axes of the base before.
  const Pose2 odom_from_base_now = found.map_from_laser * base_from_laser.inverse();
  const double variance_factor =
      estimate.wheels_slipped || estimate.jumped ? kWeakPriorFactor : 1.0;
  const Eigen::Matrix3d prior_covariance =
      variance_factor * rotate(prediction.covariance, before.yaw_rad);
  const Eigen::Vector2d lever =
      odom_from_base_now.translation() - found.map_from_laser.translation();
  const Eigen::Matrix3d laser_prior = shiftCovariance(prior_covariance, -lever);
  const Eigen::Matrix3d laser_covariance = (found.information + laser_prior.inverse()).inverse();
  estimate.motion.pose = before.inverse() * odom_from_base_now;
  estimate.motion.covariance = rotate(shiftCovariance(laser_covariance, lever), -before.yaw_rad);
  estimate.odom_from_base = last_.odom_from_base * estimate.motion;

  if (key_scans_.empty() || isKeyScan(found.map_from_laser, found.inlier_ratio)) {
    key_scans_.push_back({std::move(surfaces), found.map_from_laser});
    if (key_scans_.size() > static_cast<std::size_t>(parameters_.key_scan_count))
      key_scans_.pop_front();
  }
  learnBias(estimate, odom_from_base);
  estimate.wheels_stuck = areStuck(odom_from_base, estimate.odom_from_base.pose);
  last_interval_s_ = interval_s;
  last_wheels_ = odom_from_base;
  last_ = estimate;
  return estimate;
}

LaserOdometry::Prediction LaserOdometry::predict(std::int64_t stamp_ns,
                                                 const std::optional<Pose2>& odom_from_base) const {
  Prediction prediction;
  const double interval_s = 1e-9 * static_cast<double>(stamp_ns - last_.stamp_ns);
  double deviation_m = 0.0;
  double deviation_rad = 0.0;
  if (odom_from_base && last_wheels_) {
    prediction.motion = wheel_bias_.corrected(last_wheels_->inverse() * *odom_from_base);
    const double distance_m = prediction.motion.translation().norm();
    deviation_m = parameters_.wheel_rest_deviation_m +
                  parameters_.wheel_distance_deviation_m_per_m * distance_m;
    deviation_rad =
        parameters_.wheel_rest_deviation_rad +
        parameters_.wheel_yaw_deviation_rad_per_m * distance_m +
        parameters_.wheel_yaw_deviation_rad_per_rad * std::abs(prediction.motion.yaw_rad);
  } else {
    const double ratio =
        last_interval_s_ > 0.0 ? std::min(interval_s / last_interval_s_, 3.0) : 0.0;
    prediction.motion = exponential(ratio * logarithm(last_.motion.pose));
    deviation_m = 0.01 + parameters_.acceleration_deviation_m_per_s2 * interval_s * interval_s;
    deviation_rad =
        0.01 + parameters_.yaw_acceleration_deviation_rad_per_s2 * interval_s * interval_s;
  }
  prediction.covariance.diagonal() << deviation_m * deviation_m, deviation_m * deviation_m,
      deviation_rad * deviation_rad;
  return prediction;
}

ScanMatch LaserOdometry::match(const SurfaceScan& surfaces,
                               const Pose2& base_from_laser,
                               const Prediction& prediction,
                               bool& slipped) const {
  const std::vector<ReferenceScan> reference_scans = references();
  const Pose2& before = last_.odom_from_base.pose;
  const Pose2 predicted = before * prediction.motion * base_from_laser;
  const Eigen::Vector2d lever =
      (before * prediction.motion).translation() - predicted.translation();
  const Eigen::Matrix3d covariance =
      shiftCovariance(rotate(prediction.covariance, before.yaw_rad), -lever);
  PosePrior prior{predicted, covariance.inverse()};

  ScanMatch best = matchScan(surfaces, reference_scans, prior, predicted, parameters_.matcher);
  const Eigen::Vector3d correction = difference(best.map_from_laser, predicted);
  const double deviations2 = correction.dot(prior.information * correction);
  slipped = deviations2 > kSlipDeviations * kSlipDeviations;
  if (!slipped && best.inlier_ratio >= parameters_.lost_inlier_ratio) return best;

  prior.information /= kWeakPriorFactor;
  const auto tryFrom = [&](const Pose2& guess) {
    const ScanMatch other = matchScan(surfaces, reference_scans, prior, guess, parameters_.matcher);
    if (other.inlier_ratio > best.inlier_ratio) best = other;
  };
  tryFrom(best.map_from_laser);
  tryFrom(before * base_from_laser);
  tryFrom(before * last_.motion.pose * base_from_laser);
  for (const double angle_rad : {parameters_.search_angle_rad, kWideSearchAngleRad}) {
    if (best.inlier_ratio >= parameters_.lost_inlier_ratio) break;
    if (const auto found = search(surfaces, predicted, angle_rad)) {
      prior = {*found, Eigen::Matrix3d::Identity()};
      tryFrom(*found);
    }
  }
  return best;
}

void LaserOdometry::learnBias(const LaserOdometryEstimate& estimate,
                              const std::optional<Pose2>& wheels) {
  const bool trusted = wheels && !estimate.wheels_slipped && !estimate.jumped &&
                       estimate.inlier_ratio >= parameters_.lost_inlier_ratio;
  if (trusted && interval_) {
    const Pose2 told = interval_->wheels.inverse() * *wheels;
    if (told.translation().norm() < kIntervalM && std::abs(told.yaw_rad) < kIntervalRad) return;
    wheel_bias_.add(told, interval_->observed.inverse() * estimate.odom_from_base.pose);
  }
  interval_.reset();
  if (trusted) interval_ = Interval{*wheels, estimate.odom_from_base.pose};
}

bool LaserOdometry::areStuck(const std::optional<Pose2>& wheels, const Pose2& odom_from_base) {
  const auto moved = [](const Pose2& from, const Pose2& to, double distance_m, double angle_rad) {
    const Pose2 motion = from.inverse() * to;
    return motion.translation().norm() > distance_m || std::abs(motion.yaw_rad) > angle_rad;
  };
  if (!wheels) {
    standing_.reset();
    return false;
  }
  if (!standing_ || moved(standing_->wheels, *wheels, kStandingM, kStandingRad))
    standing_ = Interval{*wheels, odom_from_base};
  return moved(standing_->observed, odom_from_base, kStuckM, kStuckRad);
}

std::optional<Pose2> LaserOdometry::search(const SurfaceScan& surfaces,
                                           const Pose2& odom_from_laser,
                                           double angle_rad) const {
  std::vector<Eigen::Vector2f> points_in_odom;
  for (const ReferenceScan& reference : references()) {
    const Eigen::Matrix2f rotation = reference.map_from_laser.rotation().cast<float>();
    const Eigen::Vector2f shift = reference.map_from_laser.translation().cast<float>();
    for (const SurfacePoint& point : reference.surfaces->points) {
      points_in_odom.push_back(rotation * Eigen::Vector2f(point.x_m, point.y_m) + shift);
    }
  }
  if (points_in_odom.empty()) return std::nullopt;
  const LikelihoodPyramid pyramid(points_in_odom, kSearchResolutionM, kSearchDeviationM,
                                  kSearchLevels);
  SearchWindow window;
  window.distance_m = parameters_.search_distance_m;
  window.angle_rad = angle_rad;
  const auto found = searchPose(pyramid, spread(surfaces.points, kSearchPoints), odom_from_laser,
                                window, kMinSearchScore);
  if (!found) return std::nullopt;
  return found->map_from_laser;
}

std::vector<ReferenceScan> LaserOdometry::references() const {
  // The last, and others ever farther back: near enough to overlap, far enough apart to hold the
  // drift.
  std::vector<ReferenceScan> chosen;
  std::size_t back = 1;
  for (int i = 0; i < parameters_.reference_count && back <= key_scans_.size(); ++i) {
    const KeyScan& key = key_scans_[key_scans_.size() - back];
    chosen.push_back({&key.surfaces, key.odom_from_laser});
    back += static_cast<std::size_t>(i + 1);
  }
  return chosen;
}

bool LaserOdometry::isKeyScan(const Pose2& odom_from_laser, double inlier_ratio) const {
  const Pose2 motion = key_scans_.back().odom_from_laser.inverse() * odom_from_laser;
  return motion.translation().norm() >= parameters_.key_scan_distance_m ||
         std::abs(motion.yaw_rad) >= parameters_.key_scan_angle_rad ||
         inlier_ratio < parameters_.key_scan_inlier_ratio;
}

}  // namespace ram_slam
