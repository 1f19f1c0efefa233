// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/laser_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/Dense>

#include "ram_slam/scan_matching/pose_hypotheses.hpp"

namespace ram_slam {
namespace {

/// A covariance of (x, y, yaw) turned into the axes of a frame that the first one is rotated in.
Eigen::Matrix3d rotate(const Eigen::Matrix3d& covariance, double yaw_rad) {
  const Eigen::Matrix3d rotation = Pose2{0.0, 0.0, yaw_rad}.axesRotation();
  return rotation * covariance * rotation.transpose();
}

/// The covariance of (x, y, yaw) of one point of a rigid body, from that of another `lever` away.
Eigen::Matrix3d shiftCovariance(const Eigen::Matrix3d& covariance, const Eigen::Vector2d& lever) {
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
  jacobian(0, 2) = -lever.y();
  jacobian(1, 2) = lever.x();
  return jacobian * covariance * jacobian.transpose();
}

}  // namespace

LaserOdometry::LaserOdometry(const LaserOdometryParameters& parameters)
    : parameters_(parameters),
      hypotheses_{parameters.matcher,          parameters.pose_likelihood,
                  parameters.pose_search,      parameters.slip.probability,
                  parameters.slip.probability, parameters.slip.contradiction,
                  parameters.search_distance_m},
      wheel_bias_(parameters.wheel_bias),
      wheel_scatter_(parameters.wheel_scatter),
      lidar_calibration_(parameters.lidar_calibration) {
  parameters_.validate();
}

LaserOdometryEstimate LaserOdometry::update(const LaserScan& scan,
                                            const Pose2& base_from_laser,
                                            const std::optional<Pose2>& odom_from_base) {
  if (!base_from_laser.isFinite() || (odom_from_base && !odom_from_base->isFinite())) {
    throw std::invalid_argument("pose not finite");
  }
  if (key_scans_.empty()) return begin(scan, base_from_laser, odom_from_base);
  if (scan.stamp_ns <= last_.stamp_ns) {
    throw std::invalid_argument("scan of stamp " + std::to_string(scan.stamp_ns) +
                                " ns, not later than the last one, " +
                                std::to_string(last_.stamp_ns) + " ns");
  }

  Prediction prediction = predict(scan.stamp_ns, odom_from_base);
  const Pose2 laser_motion = base_from_laser.inverse() * prediction.motion * base_from_laser;
  SurfaceScan surfaces =
      extractSurfaces(scan, parameters_.surfaces,
                      continued(laser_motion, scan.stamp_ns - last_.stamp_ns, scan.duration_ns()));
  wheels_repeat_ = odom_from_base && repeatsReading(*odom_from_base);
  LaserOdometryEstimate estimate;
  estimate.stamp_ns = scan.stamp_ns;
  ScanMatch found = match(surfaces, base_from_laser, prediction, estimate);
  estimate.inlier_ratio = found.inlier_ratio;
  const bool has_wheels = odom_from_base && last_wheels_;
  estimate.jumped = has_wheels && isJump(found.map_from_laser * base_from_laser.inverse(),
                                         prediction, scan.stamp_ns);
  if (estimate.jumped) {
    // Whatever walls the scan was matched with, the robot cannot have got there: it continues from
    // where the wheels lead.
    found.map_from_laser = last_.odom_from_base.pose * prediction.motion * base_from_laser;
    found.information.setZero();
  }
  const double interval_s = 1e-9 * static_cast<double>(scan.stamp_ns - last_.stamp_ns);
  contradicting_count_ = estimate.contradicts ? contradicting_count_ + 1 : 0;
  estimate.jumped |= contradicting_count_ >= parameters_.slip.contradicting_scans;
  fuse(found, base_from_laser, prediction, estimate);
  if (estimate.jumped) key_scans_.clear();
  if (estimate.jumped || !estimate.contradicts) {
    contradicting_count_ = 0;
    placed_ns_ = scan.stamp_ns;
    KeyScan key{
        std::move(surfaces), found.map_from_laser, {}, lidar_calibration_.addedMirrorTurn_s()};
    if (!estimate.jumped && interval_s <= parameters_.lidar_calibration.max_interval_s) {
      const Pose2 motion = base_from_laser.inverse() * estimate.motion.pose * base_from_laser;
      key.velocity = logarithm(motion) / interval_s;
      key.timing = {interval_s, mirrorTurn_s(scan)};
      // Without wheels the scans would be corrected by the motion that they show themselves.
      if (has_wheels && found.inlier_ratio >= parameters_.key_scan_inlier_ratio) learnLidar(key);
    }
    keepIfKeyScan(std::move(key), found.inlier_ratio);
  }
  learnWheels(estimate, odom_from_base);
  estimate.wheels_stuck = areStuck(odom_from_base, estimate.odom_from_base.pose);
  last_interval_s_ = interval_s;
  last_wheels_ = odom_from_base;
  last_ = estimate;
  return estimate;
}

void LaserOdometry::replaceWheels(const std::optional<Pose2>& odom_from_base) {
  last_wheels_ = odom_from_base;
  interval_.reset();
  standing_.reset();
}

LaserOdometryEstimate LaserOdometry::begin(const LaserScan& scan,
                                           const Pose2& base_from_laser,
                                           const std::optional<Pose2>& odom_from_base) {
  SurfaceScan surfaces = extractSurfaces(scan, parameters_.surfaces);
  last_.stamp_ns = scan.stamp_ns;
  last_.odom_from_base.pose = odom_from_base.value_or(Pose2{});
  last_.inlier_ratio = 1.0;
  placed_ns_ = scan.stamp_ns;
  key_scans_.push_back({std::move(surfaces), last_.odom_from_base.pose * base_from_laser});
  last_wheels_ = odom_from_base;
  return last_;
}

LaserOdometry::Prediction LaserOdometry::predict(std::int64_t stamp_ns,
                                                 const std::optional<Pose2>& odom_from_base) const {
  Prediction prediction;
  const double interval_s = 1e-9 * static_cast<double>(stamp_ns - last_.stamp_ns);
  double deviation_m = 0.0;
  double deviation_rad = 0.0;
  std::optional<double> believed_rad;
  // Of wheels that were stuck the next motion may be that of all the time: constant speed is the
  // better guess, but not over a gap.
  const double longest_s = parameters_.constant_speed.max_interval_ratio * last_interval_s_;
  const bool were_stuck = last_.wheels_stuck && interval_s <= longest_s;
  if (odom_from_base && last_wheels_ && !were_stuck) {
    prediction.motion = wheel_bias_.corrected(last_wheels_->inverse() * *odom_from_base);
    const Eigen::Vector3d deviations = wheelNoise().deviations(prediction.motion);
    deviation_m = deviations.x();
    deviation_rad = deviations.z();
    believed_rad = wheel_scatter_.of(wheelNoise()).deviations(prediction.motion).z();
  } else {
    const ConstantSpeedParameters& constant = parameters_.constant_speed;
    const double ratio = last_interval_s_ > 0.0
                             ? std::min(interval_s / last_interval_s_, constant.max_interval_ratio)
                             : 0.0;
    prediction.motion = exponential(ratio * logarithm(last_.motion.pose));
    deviation_m = constant.rest_deviation_m +
                  parameters_.acceleration_deviation_m_per_s2 * interval_s * interval_s;
    deviation_rad = constant.rest_deviation_rad +
                    parameters_.yaw_acceleration_deviation_rad_per_s2 * interval_s * interval_s;
  }
  prediction.covariance.diagonal() << deviation_m * deviation_m, deviation_m * deviation_m,
      deviation_rad * deviation_rad;
  prediction.believed = prediction.covariance;
  if (believed_rad) prediction.believed(2, 2) = *believed_rad * *believed_rad;
  return prediction;
}

MotionNoise LaserOdometry::wheelNoise() const {
  return {parameters_.wheel_rest_deviation_m, parameters_.wheel_rest_deviation_rad,
          parameters_.wheel_distance_deviation_m_per_m, parameters_.wheel_yaw_deviation_rad_per_m,
          parameters_.wheel_yaw_deviation_rad_per_rad};
}

ScanMatch LaserOdometry::match(const SurfaceScan& surfaces,
                               const Pose2& base_from_laser,
                               Prediction& prediction,
                               LaserOdometryEstimate& estimate) const {
  std::vector<ReferenceScan> reference_scans;
  for (const KeyScan* key : references())
    reference_scans.push_back({&key->surfaces, key->odom_from_laser});
  const Pose2& before = last_.odom_from_base.pose;
  const Pose2 predicted = before * prediction.motion * base_from_laser;
  const Eigen::Vector2d lever =
      (before * prediction.motion).translation() - predicted.translation();
  const auto priorOf = [&](const Eigen::Matrix3d& covariance) {
    return PosePrior{predicted,
                     shiftCovariance(rotate(covariance, before.yaw_rad), -lever).inverse()};
  };
  const auto contradicts = [&](const PosePrior& wheels, double most_deviations, const Pose2& pose) {
    const Eigen::Vector3d correction = componentDifference(pose, predicted);
    return correction.dot(wheels.information * correction) > most_deviations * most_deviations;
  };
  const PosePrior prior = priorOf(prediction.covariance);
  const PosePrior believed = priorOf(prediction.believed);
  ScanMatch first = matchScan(surfaces, reference_scans, believed, predicted, parameters_.matcher);
  if (contradicts(believed, parameters_.wheel_scatter.max_deviations, first.map_from_laser)) {
    prediction.believed = prediction.covariance;
    first = matchScan(surfaces, reference_scans, prior, predicted, parameters_.matcher);
  }
  estimate.wheels_slipped = contradicts(prior, parameters_.slip.deviations, first.map_from_laser);
  if (!estimate.wheels_slipped && !last_.wheels_slipped &&
      first.inlier_ratio >= parameters_.lost_inlier_ratio)
    return first;

  PoseHypotheses::Settings settings = hypotheses_;
  if (last_.wheels_slipped || wheels_repeat_)
    settings.slip_probability = parameters_.slip.continued_probability;
  // All of a motion of the wheels may be a slip.
  settings.search_distance_m =
      std::max(settings.search_distance_m, prediction.motion.translation().norm());
  const PosePrior weak{predicted, prior.information / parameters_.slip.prior_variance_factor};
  PoseHypotheses hypotheses(surfaces, reference_scans, {believed, weak.information}, settings);
  hypotheses.add(first);
  for (const Pose2& guess : {first.map_from_laser, before * base_from_laser,
                             before * last_.motion.pose * base_from_laser})
    hypotheses.alignFrom(guess, weak);
  for (const double angle_rad :
       {parameters_.search_angle_rad, parameters_.pose_search.wide_angle_rad}) {
    if (hypotheses.best().match.inlier_ratio >= parameters_.lost_inlier_ratio) break;
    hypotheses.search(angle_rad);
  }
  ScanMatch best = hypotheses.best().match;
  estimate.wheels_slipped = contradicts(prior, parameters_.slip.deviations, best.map_from_laser);
  estimate.searched = hypotheses.best().searched;
  estimate.contradicts = hypotheses.best().contradiction > parameters_.slip.contradiction;
  if (estimate.searched) best.information /= parameters_.slip.prior_variance_factor;
  return best;
}

bool LaserOdometry::isJump(const Pose2& odom_from_base,
                           const Prediction& prediction,
                           std::int64_t stamp_ns) const {
  const SlipParameters& slip = parameters_.slip;
  const double since_s = 1e-9 * static_cast<double>(stamp_ns - placed_ns_);
  const MotionGate reach{slip.jump.distance_m + slip.max_speed_mps * since_s,
                         slip.jump.angle_rad + slip.max_turn_speed_radps * since_s};
  const Pose2 motion = last_.odom_from_base.pose.inverse() * odom_from_base;
  return reach.isExceededBy(motion) && reach.isExceededBy(prediction.motion.inverse() * motion);
}

void LaserOdometry::fuse(const ScanMatch& found,
                         const Pose2& base_from_laser,
                         const Prediction& prediction,
                         LaserOdometryEstimate& estimate) const {
  // Covariance of the laser in the odometry axes, then of the base in the axes of the base before.
  const Pose2& before = last_.odom_from_base.pose;
  const Pose2 odom_from_base = found.map_from_laser * base_from_laser.inverse();
  const double variance_factor =
      estimate.wheels_slipped || estimate.jumped ? parameters_.slip.prior_variance_factor : 1.0;
  const Eigen::Matrix3d prior_covariance =
      variance_factor * rotate(prediction.believed, before.yaw_rad);
  const Eigen::Vector2d lever = odom_from_base.translation() - found.map_from_laser.translation();
  const Eigen::Matrix3d laser_prior = shiftCovariance(prior_covariance, -lever);
  if (found.information.determinant() > 0.0) {
    const Eigen::Matrix3d by_scan = rotate(found.information.inverse(), -odom_from_base.yaw_rad);
    if (by_scan(0, 0) > 0.0) estimate.scan_deviation_m = std::sqrt(by_scan(0, 0));
    if (by_scan(2, 2) > 0.0) estimate.scan_deviation_rad = std::sqrt(by_scan(2, 2));
  }
  const Eigen::Matrix3d laser_covariance = (found.information + laser_prior.inverse()).inverse();
  estimate.motion.pose = before.inverse() * odom_from_base;
  estimate.motion.covariance = rotate(shiftCovariance(laser_covariance, lever), -before.yaw_rad);
  estimate.odom_from_base = last_.odom_from_base * estimate.motion;
}

void LaserOdometry::learnLidar(const KeyScan& scan) {
  if (key_scans_.empty()) return;
  const bool is_key_scan = isKeyScan(scan.odom_from_laser, 1.0);
  PairingLimits limits = parameters_.matcher.firstPairing();
  limits.max_distance_m = parameters_.matcher.last_gate_m;
  for (const KeyScan* key : references()) {
    if (!key->velocity || key->added_mirror_turn_s != scan.added_mirror_turn_s) continue;
    const double difference_radps = std::abs(scan.velocity->z() - key->velocity->z());
    if (!is_key_scan && difference_radps < parameters_.lidar_calibration.min_turn_rate_radps)
      continue;
    lidar_calibration_.add(
        sumScanPair({key->surfaces, *key->velocity}, {scan.surfaces, *scan.velocity},
                    key->odom_from_laser.inverse() * scan.odom_from_laser, limits),
        scan.timing);
  }
}

void LaserOdometry::keepIfKeyScan(KeyScan scan, double inlier_ratio) {
  if (!key_scans_.empty() && !isKeyScan(scan.odom_from_laser, inlier_ratio)) return;
  lidar_calibration_.endBlock();
  key_scans_.push_back(std::move(scan));
  if (key_scans_.size() > static_cast<std::size_t>(parameters_.key_scan_count))
    key_scans_.pop_front();
}

void LaserOdometry::learnWheels(const LaserOdometryEstimate& estimate,
                                const std::optional<Pose2>& wheels) {
  const bool trusted = wheels && !estimate.wheels_slipped && !estimate.jumped &&
                       estimate.inlier_ratio >= parameters_.lost_inlier_ratio;
  if (trusted && interval_) {
    const Pose2 wheel_motion = interval_->wheels.inverse() * *wheels;
    if (!parameters_.wheel_bias.interval.isReachedBy(wheel_motion)) return;
    const Pose2 observed = interval_->observed.inverse() * estimate.odom_from_base.pose;
    wheel_scatter_.add(wheel_bias_.corrected(wheel_motion), observed.yaw_rad, wheelNoise(),
                       estimate.scan_deviation_rad);
    const double wheels_m2 = std::pow(wheelNoise().deviations(wheel_motion).x(), 2);
    const double scans_m2 = std::pow(estimate.scan_deviation_m, 2);
    wheel_bias_.add(wheel_motion, observed, wheels_m2 / (wheels_m2 + scans_m2));
  } else if (wheels && estimate.wheels_slipped) {
    wheel_scatter_.addSlip();
  }
  interval_.reset();
  if (trusted) interval_ = Interval{*wheels, estimate.odom_from_base.pose};
}

bool LaserOdometry::repeatsReading(const Pose2& odom_from_base) const {
  const MotionGate& standing = parameters_.slip.standing;
  if (!last_wheels_ || standing.isExceededBy(last_wheels_->inverse() * odom_from_base))
    return false;
  return wheels_repeat_ || standing.isExceededBy(last_.motion.pose);
}

bool LaserOdometry::areStuck(const std::optional<Pose2>& wheels, const Pose2& odom_from_base) {
  if (!wheels) {
    standing_.reset();
    return false;
  }
  const SlipParameters& slip = parameters_.slip;
  if (!standing_ || slip.standing.isExceededBy(standing_->wheels.inverse() * *wheels))
    standing_ = Interval{*wheels, odom_from_base};
  return slip.stuck.isExceededBy(standing_->observed.inverse() * odom_from_base);
}

std::vector<const LaserOdometry::KeyScan*> LaserOdometry::references() const {
  // The last, and others ever farther back: near enough to overlap, far enough apart to hold the
  // drift.
  std::vector<const KeyScan*> chosen;
  std::size_t back = 1;
  for (int i = 0; i < parameters_.reference_count && back <= key_scans_.size(); ++i) {
    const KeyScan& key = key_scans_[key_scans_.size() - back];
    const Eigen::Vector2d away_m =
        key.odom_from_laser.translation() - key_scans_.back().odom_from_laser.translation();
    // Beyond a jump of the odometry: no overlap, and grids of that extent would fill the memory.
    if (away_m.norm() <= parameters_.max_reference_distance_m) chosen.push_back(&key);
    back += static_cast<std::size_t>(i + 1);
  }
  return chosen;
}

bool LaserOdometry::isKeyScan(const Pose2& odom_from_laser, double inlier_ratio) const {
  const Pose2 motion = key_scans_.back().odom_from_laser.inverse() * odom_from_laser;
  const MotionGate gate{parameters_.key_scan_distance_m, parameters_.key_scan_angle_rad};
  return gate.isReachedBy(motion) || inlier_ratio < parameters_.key_scan_inlier_ratio;
}

}  // namespace ram_slam
