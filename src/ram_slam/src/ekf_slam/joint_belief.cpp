// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ekf_slam/joint_belief.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace ram_slam {
namespace {

/// J v: v turned by 90 degrees.
Eigen::Vector2d quarterTurn(const Eigen::Vector2d& v) {
  return {-v.y(), v.x()};
}

/// L L^T of a covariance, which may be singular.
Eigen::Matrix3d squareRoot(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace

Eigen::Matrix2d JointBelief::block(Eigen::Index row, Eigen::Index column) const {
  if (row > column) return storage_.block<2, 2>(row, column);
  if (row < column) return storage_.block<2, 2>(column, row).transpose();
  return storage_.block<2, 2>(row, row).selfadjointView<Eigen::Lower>();
}

Eigen::MatrixX2d JointBelief::columns(Eigen::Index first) const {
  Eigen::MatrixX2d columns(dimension_, 2);
  const Eigen::Index below = dimension_ - first - 2;
  columns.topRows(first) = storage_.block(first, 0, 2, first).transpose();
  columns.middleRows<2>(first) = block(first, first);
  columns.bottomRows(below) = storage_.block(first + 2, first, below, 2);
  return columns;
}

void JointBelief::resize(Eigen::Index dimension) {
  if (dimension > storage_.rows()) {
    const Eigen::Index capacity = dimension + dimension / 2;
    Eigen::MatrixXd larger = Eigen::MatrixXd::Zero(capacity, capacity);
    larger.topLeftCorner(dimension_, dimension_) = covariance();
    storage_ = std::move(larger);
  }
  dimension_ = dimension;
}

Eigen::Matrix2d JointBelief::plain(Eigen::Index row_a,
                                   const Eigen::Vector2d& a_m,
                                   Eigen::Index row_b,
                                   const Eigen::Vector2d& b_m) const {
  const Eigen::Vector2d turned_a = quarterTurn(a_m);
  const Eigen::Vector2d turned_b = quarterTurn(b_m);
  const Eigen::Vector2d yaw_a = storage_.block<2, 1>(row_a, 0);
  const Eigen::Vector2d yaw_b = storage_.block<2, 1>(row_b, 0);
  return block(row_a, row_b) + turned_a * yaw_b.transpose() + yaw_a * turned_b.transpose() +
         storage_(0, 0) * turned_a * turned_b.transpose();
}

PoseWithCovariance2 JointBelief::poseWithCovariance() const {
  PoseWithCovariance2 result{pose_, {}};
  const Eigen::Vector2d position_m = pose_.translation();
  const Eigen::Vector2d with_yaw =
      storage_.block<2, 1>(kPositionRow, 0) + storage_(0, 0) * quarterTurn(position_m);
  result.covariance.topLeftCorner<2, 2>() =
      plain(kPositionRow, position_m, kPositionRow, position_m);
  result.covariance.topRightCorner<2, 1>() = with_yaw;
  result.covariance.bottomLeftCorner<1, 2>() = with_yaw.transpose();
  result.covariance(2, 2) = storage_(0, 0);
  return result;
}

Landmark JointBelief::landmark(std::size_t i) const {
  return {points_m_[i], crossCovariance(i, i)};
}

Eigen::Matrix2d JointBelief::crossCovariance(std::size_t i, std::size_t j) const {
  return plain(row(i), points_m_[i], row(j), points_m_[j]);
}

Eigen::Matrix2d JointBelief::differenceCovariance(std::size_t i, std::size_t j) const {
  return block(row(i), row(i)) + block(row(j), row(j)) - block(row(i), row(j)) -
         block(row(j), row(i));
}

Eigen::Matrix2d JointBelief::covarianceFromPose(std::size_t i) const {
  return block(row(i), row(i)) + block(kPositionRow, kPositionRow) - block(row(i), kPositionRow) -
         block(kPositionRow, row(i));
}

JointBelief JointBelief::part(const std::vector<std::size_t>& landmarks) const {
  JointBelief part;
  part.pose_ = pose_;
  part.resize(row(landmarks.size()));
  std::vector<Eigen::Index> rows{0, 1, 2};
  for (const std::size_t i : landmarks) {
    part.points_m_.push_back(points_m_[i]);
    rows.insert(rows.end(), {row(i), row(i) + 1});
  }
  for (std::size_t a = 0; a < rows.size(); ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      part.storage_(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) =
          storage_(std::max(rows[a], rows[b]), std::min(rows[a], rows[b]));
    }
  }
  return part;
}

void JointBelief::move(const PoseWithCovariance2& motion) {
  const Pose2 before = pose_;
  pose_ = pose_ * motion.pose;
  Eigen::MatrixXd by_motion = Eigen::MatrixXd::Zero(dimension_, 3);
  by_motion(0, 2) = 1.0;
  by_motion.col(2) -= turned();
  by_motion.block<2, 2>(kPositionRow, 0) = before.rotation();
  covariance().selfadjointView<Eigen::Lower>().rankUpdate(by_motion *
                                                          squareRoot(motion.covariance));
}

Innovation JointBelief::innovation(const Sighting& sighting) const {
  const Eigen::Matrix2d base_from_map = pose_.rotation().transpose();
  Innovation found;
  found.residual_m = sighting.measured.position_m -
                     base_from_map * (points_m_[sighting.landmark] - pose_.translation());
  found.covariance_m2 =
      base_from_map * covarianceFromPose(sighting.landmark) * base_from_map.transpose() +
      sighting.measured.covariance_m2;
  return found;
}

JointBelief::Gain JointBelief::gain(const std::vector<Sighting>& sightings) const {
  const auto size = 2 * static_cast<Eigen::Index>(sightings.size());
  const Eigen::Matrix2d rotation = pose_.rotation();
  const Eigen::MatrixX2d of_position = columns(kPositionRow);
  Gain gain{Eigen::MatrixXd(dimension_, size), Eigen::MatrixXd(size, size)};
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    gain.cross.middleCols<2>(2 * static_cast<Eigen::Index>(k)) =
        (columns(row(sightings[k].landmark)) - of_position) * rotation;
  }
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    const Eigen::Index at = 2 * static_cast<Eigen::Index>(k);
    gain.covariance.middleRows<2>(at) =
        rotation.transpose() * (gain.cross.middleRows<2>(row(sightings[k].landmark)) -
                                gain.cross.middleRows<2>(kPositionRow));
    gain.covariance.block<2, 2>(at, at) += sightings[k].measured.covariance_m2;
  }
  return gain;
}

void JointBelief::correct(const std::vector<Sighting>& sightings) {
  if (sightings.empty()) return;
  const Gain gain = this->gain(sightings);
  Eigen::VectorXd residuals(gain.covariance.rows());
  for (std::size_t k = 0; k < sightings.size(); ++k)
    residuals.segment<2>(2 * static_cast<Eigen::Index>(k)) = innovation(sightings[k]).residual_m;
  const Eigen::LLT<Eigen::MatrixXd> factor(gain.covariance);
  // With S = L L^T: K S K^T = U U^T and K v = U L^-1 v, U = P H^T L^-T.
  const Eigen::MatrixXd u = factor.matrixL().solve(gain.cross.transpose()).transpose();
  covariance().selfadjointView<Eigen::Lower>().rankUpdate(u, -1.0);
  retract(u * factor.matrixL().solve(residuals));
}

void JointBelief::retract(const Eigen::VectorXd& error) {
  const Eigen::Matrix2d turn = Pose2{0.0, 0.0, error(0)}.rotation();
  const auto moved = [&](const Eigen::Vector2d& point_m, Eigen::Index at) {
    const Pose2 shift = exponential({error(at), error(at + 1), error(0)});
    return Eigen::Vector2d(turn * point_m + shift.translation());
  };
  const Eigen::Vector2d position_m = moved(pose_.translation(), kPositionRow);
  pose_ = {position_m.x(), position_m.y(), wrapAngle(pose_.yaw_rad + error(0))};
  for (std::size_t i = 0; i < points_m_.size(); ++i) points_m_[i] = moved(points_m_[i], row(i));
}

void JointBelief::add(const PointMeasurement& measured) {
  const Eigen::MatrixX2d of_position = columns(kPositionRow);
  const Eigen::Index at = row(size());
  points_m_.push_back(pose_ * measured.position_m);
  resize(at + 2);
  const Eigen::Matrix2d rotation = pose_.rotation();
  storage_.block(at, 0, 2, at) = of_position.transpose();
  storage_.block<2, 2>(at, at) =
      block(kPositionRow, kPositionRow) + rotation * measured.covariance_m2 * rotation.transpose();
}

void JointBelief::add(const std::vector<Eigen::Vector2d>& points_m,
                      const Eigen::MatrixXd& covariance_m2) {
  convert(1.0);
  const Eigen::Index at = dimension_;
  resize(at + covariance_m2.rows());
  storage_.block(at, 0, covariance_m2.rows(), at).setZero();
  storage_.block(at, at, covariance_m2.rows(), covariance_m2.cols()) = covariance_m2;
  points_m_.insert(points_m_.end(), points_m.begin(), points_m.end());
  convert(-1.0);
}

void JointBelief::remove(const std::vector<std::size_t>& landmarks) {
  if (landmarks.empty()) return;
  std::vector<std::size_t> kept;
  auto removed = landmarks.begin();
  for (std::size_t i = 0; i < size(); ++i) {
    if (removed != landmarks.end() && *removed == i) {
      ++removed;
    } else {
      kept.push_back(i);
    }
  }
  *this = part(kept);
}

Eigen::VectorXd JointBelief::turned() const {
  Eigen::VectorXd turned(dimension_);
  turned(0) = 0.0;
  turned.segment<2>(kPositionRow) = quarterTurn(pose_.translation());
  for (std::size_t i = 0; i < size(); ++i) turned.segment<2>(row(i)) = quarterTurn(points_m_[i]);
  return turned;
}

void JointBelief::convert(double sign) {
  const Eigen::VectorXd turned = sign * this->turned();
  const Eigen::VectorXd of_yaw = storage_.col(0).head(dimension_) + 0.5 * storage_(0, 0) * turned;
  covariance().selfadjointView<Eigen::Lower>().rankUpdate(turned, of_yaw);
}

void JointBelief::setPose(const PoseWithCovariance2& map_from_base) {
  convert(1.0);
  pose_ = map_from_base.pose;
  const Eigen::Matrix3d& c = map_from_base.covariance;
  storage_.block(0, 0, dimension_, 3).setZero();
  storage_(0, 0) = c(2, 2);
  storage_.block<2, 1>(kPositionRow, 0) = c.block<2, 1>(0, 2);
  storage_.block<2, 2>(kPositionRow, kPositionRow) = c.block<2, 2>(0, 0);
  convert(-1.0);
}

void JointBelief::movePose(const Pose2& new_from_old) {
  pose_ = new_from_old * pose_;
  // xi_p becomes R xi_p - J t xi_yaw.
  const Eigen::Matrix2d turn = new_from_old.rotation();
  const Eigen::Vector2d shift = quarterTurn(new_from_old.translation());
  const Eigen::MatrixX2d before = columns(kPositionRow);
  Eigen::MatrixX2d after = before * turn.transpose();
  after -= storage_.col(0).head(dimension_) * shift.transpose();
  const Eigen::Matrix2d on_diagonal =
      turn * after.middleRows<2>(kPositionRow) - shift * after.row(0);
  storage_.block<2, 1>(kPositionRow, 0) = after.row(0).transpose();
  storage_.block<2, 2>(kPositionRow, kPositionRow) = on_diagonal;
  storage_.block(3, kPositionRow, dimension_ - 3, 2) = after.bottomRows(dimension_ - 3);
}

void JointBelief::movePoints(const std::vector<Pose2>& new_from_old) {
  Eigen::MatrixXd all = covariance().selfadjointView<Eigen::Lower>();
  // As movePose(), first for the rows and then for the columns.
  for (int side = 0; side < 2; ++side) {
    for (std::size_t i = 0; i < size(); ++i) {
      const Eigen::Vector2d shift = quarterTurn(new_from_old[i].translation());
      all.middleRows<2>(row(i)) =
          (new_from_old[i].rotation() * all.middleRows<2>(row(i)) - shift * all.row(0)).eval();
    }
    all.transposeInPlace();
  }
  covariance() = all;
  for (std::size_t i = 0; i < size(); ++i) points_m_[i] = new_from_old[i] * points_m_[i];
}

}  // namespace ram_slam
