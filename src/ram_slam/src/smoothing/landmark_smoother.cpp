// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/landmark_smoother.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <ceres/ceres.h>

#include "ram_parameters/require.hpp"
#include "ram_slam/geometry/random.hpp"
#include "ram_slam/landmarks/assignment.hpp"
#include "ram_slam/landmarks/landmark.hpp"

#include "least_squares.hpp"

namespace ram_slam {
namespace {

constexpr int kRoundsBetweenRevisions = 5;
constexpr int kMostIterations = 10;
constexpr double kPrecision = 1e-5;  // relative change of the cost
constexpr double kRest_m = 1e-3;     // standard deviation added to the odometry's,
constexpr double kRest_rad = 1e-3;   // which may be 0 for a robot at rest
constexpr double kShift_m = 0.2;     // standard deviation, per axis
constexpr double kLeavingOut = 0.3;  // share of the attempts
constexpr int kRoundsAfterVarying = 3;
constexpr double kLeastGain = 0.1;  // [nat]
constexpr std::size_t kNone = static_cast<std::size_t>(-1);

template <typename T>
using Vector2 = Eigen::Matrix<T, 2, 1>;

/// A point or translation of the map, seen from the pose.
template <typename T>
Vector2<T> fromPose(const T* pose, const Vector2<T>& difference) {
  return Eigen::Rotation2D<T>(-pose[2]) * difference;
}

template <typename Matrix>
Matrix rootOfInverse(const Matrix& covariance) {
  return Matrix(covariance.inverse()).llt().matrixU();
}

/// Measured motion between two poses.
class MotionError {
public:
  explicit MotionError(const PoseWithCovariance2& motion)
      : motion_(motion.pose), root_(rootOfInverse(motion.covariance)) {}

  template <typename T>
  bool operator()(const T* from, const T* to, T* residual) const {
    const Vector2<T> moved = fromPose(from, Vector2<T>(to[0] - from[0], to[1] - from[1]));
    const T turn = to[2] - from[2] - motion_.yaw_rad;
    const Eigen::Matrix<T, 3, 1> error(moved.x() - motion_.x_m, moved.y() - motion_.y_m,
                                       atan2(sin(turn), cos(turn)));
    Eigen::Map<Eigen::Matrix<T, 3, 1>>{residual} = root_.cast<T>() * error;
    return true;
  }

private:
  Pose2 motion_;
  Eigen::Matrix3d root_;
};

/// A landmark measured from a pose.
class FeatureError {
public:
  explicit FeatureError(const PointMeasurement& measured)
      : position_m_(measured.position_m), root_(rootOfInverse(measured.covariance_m2)) {}

  template <typename T>
  bool operator()(const T* pose, const T* landmark, T* residual) const {
    const Vector2<T> seen =
        fromPose(pose, Vector2<T>(landmark[0] - pose[0], landmark[1] - pose[1]));
    Eigen::Map<Vector2<T>>{residual} = root_.cast<T>() * (seen - position_m_.cast<T>());
    return true;
  }

private:
  Eigen::Vector2d position_m_;
  Eigen::Matrix2d root_;
};

/// A feature, and the landmark that it is paired with.
struct Reading {
  std::size_t pose = 0;
  const Feature* feature = nullptr;
  PointMeasurement measured;
  std::size_t landmark = kNone;
  double score = 0.0;   ///< [nat] that the pair is better than none, per independent reading
  double second = 0.0;  ///< the same of the next best landmark that its list leaves free, or 0
};

class Smoother {
public:
  Smoother(const std::vector<FeatureStep>& steps,
           const Trajectory& trajectory,
           const std::vector<LandmarkEstimate>& landmarks,
           const LandmarkSmootherParameters& parameters)
      : parameters_(parameters), landmarks_(landmarks) {
    for (const FeatureStep& step : steps) {
      if (stamps_ns_.empty() || step.list.stamp_ns != stamps_ns_.back()) addPose(step, trajectory);
      for (const Feature& feature : step.list.features) addReading(feature);
    }
    for (const LandmarkEstimate& landmark : landmarks_)
      next_id_ = std::max(next_id_, landmark.id + 1);
  }

  SmoothedLandmarks run() {
    if (stamps_ns_.empty()) return {};
    const double shrink = std::pow(parameters_.last_deviation_m / parameters_.first_deviation_m,
                                   1.0 / std::max(1, parameters_.round_count - 1));
    deviation_m_ = parameters_.first_deviation_m;
    for (int round = 1; round <= parameters_.round_count; ++round) {
      pair();
      solve();
      if (round % kRoundsBetweenRevisions == 0 && round < parameters_.round_count) revise();
      if (round < parameters_.round_count) deviation_m_ *= shrink;
    }
    pair();
    solve();
    for (int attempt = 0; attempt < parameters_.attempt_count; ++attempt) vary(Random(0, attempt));
    return result();
  }

private:
  void addPose(const FeatureStep& step, const Trajectory& trajectory) {
    const std::int64_t stamp_ns = step.list.stamp_ns;
    if (!stamps_ns_.empty() && stamp_ns < stamps_ns_.back()) {
      throw std::invalid_argument("features of " + std::to_string(stamp_ns) +
                                  " ns come after those of " + std::to_string(stamps_ns_.back()) +
                                  " ns");
    }
    const std::optional<Pose2> pose = poseAt(trajectory, stamp_ns);
    if (!pose) {
      throw std::invalid_argument("features of " + std::to_string(stamp_ns) +
                                  " ns are outside the trajectory");
    }
    if (!stamps_ns_.empty()) {
      if (!step.motion.pose.isFinite() || !step.motion.covariance.allFinite())
        throw std::invalid_argument("a motion is not finite");
      motions_.push_back(step.motion);
      motions_.back().covariance.diagonal() +=
          Eigen::Vector3d(kRest_m, kRest_m, kRest_rad).cwiseAbs2();
    }
    stamps_ns_.push_back(stamp_ns);
    poses_.push_back({pose->x_m, pose->y_m, pose->yaw_rad});
  }

  void addReading(const Feature& feature) {
    const Eigen::Matrix2d& c = feature.covariance_m2;
    if (!feature.position_m.allFinite() || !c.allFinite() || !(c(0, 0) > 0.0) ||
        !(c.determinant() > 0.0)) {
      throw std::invalid_argument(
          "a feature's position and covariance must be finite, the covariance positive definite");
    }
    Reading reading;
    reading.pose = poses_.size() - 1;
    reading.feature = &feature;
    reading.measured = {feature.position_m, c};
    readings_.push_back(reading);
  }

  Pose2 poseOf(const Reading& reading) const {
    const std::array<double, 3>& pose = poses_[reading.pose];
    return {pose[0], pose[1], pose[2]};
  }

  /// [nat] that a feature shows a landmark there rather than nothing known, >= 0.
  double scoreAt(const Reading& reading, const Eigen::Vector2d& landmark_m) const {
    const Pose2 map_from_base = poseOf(reading);
    const double noise_m2 =
        reading.measured.covariance_m2.trace() + 2.0 * deviation_m_ * deviation_m_;
    const double distance_m2 =
        (map_from_base * reading.measured.position_m - landmark_m).squaredNorm();
    if (distance_m2 > parameters_.association_gate * noise_m2) return 0.0;
    const Landmark there{landmark_m, deviation_m_ * deviation_m_ * Eigen::Matrix2d::Identity()};
    const double chi2 = innovation(map_from_base, there, reading.measured).squaredMahalanobis();
    return 0.5 * std::max(0.0, parameters_.association_gate - chi2);
  }

  /// Pairs every list's features with landmarks, each landmark at most once per list.
  void pair() {
    for (std::size_t first = 0; first < readings_.size();) {
      std::size_t end = first;
      std::vector<Candidate> candidates;
      for (; end < readings_.size() && readings_[end].pose == readings_[first].pose; ++end) {
        Reading& reading = readings_[end];
        reading.landmark = kNone;
        reading.score = reading.second = 0.0;
        for (std::size_t j = 0; j < landmarks_.size(); ++j) {
          if (landmarks_[j].type != reading.feature->type) continue;
          const double score = scoreAt(reading, landmarks_[j].mean_m);
          if (score > 0.0) candidates.push_back({end, j, score});
        }
      }
      std::vector<std::size_t> used;
      for (const Choice& choice : bestAssignment(candidates)) {
        const Candidate& pair = candidates[choice.candidate];
        readings_[pair.row].landmark = pair.column;
        readings_[pair.row].score = pair.score;
        used.push_back(pair.column);
      }
      for (const Candidate& other : candidates) {
        if (std::find(used.begin(), used.end(), other.column) != used.end()) continue;
        readings_[other.row].second = std::max(readings_[other.row].second, other.score);
      }
      first = end;
    }
  }

  /// Motions, and features that are paired.
  void fill(ceres::Problem& problem) {
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<MotionError, 3, 3, 3>(new MotionError(motions_[i])),
          nullptr, poses_[i].data(), poses_[i + 1].data());
    }
    for (const Reading& reading : readings_) {
      if (reading.landmark == kNone) continue;
      auto* const kernel =
          new ceres::ScaledLoss(new ceres::CauchyLoss(std::sqrt(parameters_.robust_chi2)),
                                parameters_.reading_share, ceres::TAKE_OWNERSHIP);
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<FeatureError, 2, 3, 2>(
                                   new FeatureError(reading.measured)),
                               kernel, poses_[reading.pose].data(),
                               landmarks_[reading.landmark].mean_m.data());
    }
    problem.AddParameterBlock(poses_.front().data(), 3);
    problem.SetParameterBlockConstant(poses_.front().data());
  }

  void solve() {
    ceres::Problem problem;
    fill(problem);
    cost_ = solveLeastSquares(problem, kMostIterations, kPrecision, "landmarks not smoothed");
  }

  /// The landmarks' blocks of the inverse of J^T J; `seen` says which landmarks are paired.
  void computeCovariances(const std::vector<bool>& seen) {
    ceres::Problem problem;
    fill(problem);
    ceres::Problem::EvaluateOptions options;
    for (std::size_t i = 1; i < poses_.size(); ++i)
      options.parameter_blocks.push_back(poses_[i].data());
    for (std::size_t j = 0; j < landmarks_.size(); ++j) {
      if (seen[j]) options.parameter_blocks.push_back(landmarks_[j].mean_m.data());
    }
    ceres::CRSMatrix rows;
    problem.Evaluate(options, nullptr, nullptr, nullptr, &rows);
    const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> jacobian(
        rows.num_rows, rows.num_cols, static_cast<Eigen::Index>(rows.values.size()),
        rows.rows.data(), rows.cols.data(), rows.values.data());
    const Eigen::SparseMatrix<double> information = jacobian.transpose() * jacobian;
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(information);
    if (solver.info() != Eigen::Success)
      throw std::runtime_error("landmarks not smoothed: their covariance is singular");
    auto column = static_cast<Eigen::Index>(3 * (poses_.size() - 1));
    for (std::size_t j = 0; j < landmarks_.size(); ++j) {
      if (!seen[j]) continue;
      Eigen::MatrixX2d unit = Eigen::MatrixX2d::Zero(information.rows(), 2);
      unit.middleRows<2>(column).setIdentity();
      const Eigen::MatrixX2d inverse = solver.solve(unit);
      const Eigen::Matrix2d block = inverse.middleRows<2>(column);
      landmarks_[j].covariance_m2 = 0.5 * (block + block.transpose());
      column += 2;
    }
  }

  /// Leaves out a landmark, or shifts a part of the drive, pairs all anew, and keeps that if it
  /// agrees better: a landmark may be there twice, and what was seen on one visit may have been
  /// paired with the neighbours of what it was, all at once.
  void vary(Random random) {
    const std::vector<std::array<double, 3>> poses = poses_;
    const std::vector<LandmarkEstimate> landmarks = landmarks_;
    const std::vector<Reading> readings = readings_;
    const double cost = cost_;
    const double before = disagreement();
    if (random.uniform() < kLeavingOut && !landmarks_.empty()) {
      const double place = random.uniform() * static_cast<double>(landmarks_.size());
      landmarks_.erase(landmarks_.begin() + static_cast<std::ptrdiff_t>(place));
    } else {
      shift(random);
    }
    for (int round = 0; round < kRoundsAfterVarying; ++round) {
      pair();
      solve();
    }
    if (disagreement() < before - kLeastGain) return;
    poses_ = poses;
    landmarks_ = landmarks;
    readings_ = readings;
    cost_ = cost;
  }

  /// Parts of all lengths are as likely by order of magnitude; the first pose is fixed.
  void shift(Random& random) {
    const auto count = static_cast<double>(poses_.size());
    const auto begin = static_cast<std::size_t>(1.0 + random.uniform() * (count - 1.0));
    const auto length = static_cast<std::size_t>(std::pow(count, random.uniform()));
    const double x_m = kShift_m * random.gaussian();
    const double y_m = kShift_m * random.gaussian();
    for (std::size_t i = begin; i < std::min(poses_.size(), begin + length); ++i) {
      poses_[i][0] += x_m;
      poses_[i][1] += y_m;
    }
  }

  /// [nat] what pairing and least squares make small.
  double disagreement() const {
    const auto unpaired =
        std::count_if(readings_.begin(), readings_.end(),
                      [](const Reading& reading) { return reading.landmark == kNone; });
    return cost_ +
           0.5 * parameters_.reading_share * parameters_.association_gate *
               static_cast<double>(unpaired) +
           parameters_.least_evidence * static_cast<double>(landmarks_.size());
  }

  /// Removes what explains too little, the least first, and makes landmarks of what is left over.
  void revise() {
    pair();
    while (!landmarks_.empty()) {
      const std::vector<double> evidence = this->evidence();
      const auto least = std::min_element(evidence.begin(), evidence.end());
      if (*least >= parameters_.least_evidence) break;
      landmarks_.erase(landmarks_.begin() + (least - evidence.begin()));
      pair();
    }
    while (const std::optional<LandmarkEstimate> landmark = proposal()) {
      landmarks_.push_back(*landmark);
      landmarks_.back().id = next_id_++;
      pair();
    }
  }

  /// [nat] that would be lost without each landmark.
  std::vector<double> evidence() const {
    std::vector<double> sums(landmarks_.size(), 0.0);
    for (const Reading& reading : readings_) {
      if (reading.landmark == kNone) continue;
      sums[reading.landmark] +=
          parameters_.reading_share * std::max(0.0, reading.score - reading.second);
    }
    return sums;
  }

  /// A landmark where a feature without one is, if it explains enough; that which explains most.
  std::optional<LandmarkEstimate> proposal() const {
    std::vector<const Reading*> left;
    for (const Reading& reading : readings_) {
      if (reading.landmark == kNone) left.push_back(&reading);
    }
    std::optional<LandmarkEstimate> best;
    double most = parameters_.least_evidence;
    for (const Reading* reading : left) {
      const Eigen::Vector2d place_m = poseOf(*reading) * reading->measured.position_m;
      double sum = 0.0;
      for (const Reading* other : left) {
        if (other->feature->type == reading->feature->type)
          sum += parameters_.reading_share * scoreAt(*other, place_m);
      }
      if (sum <= most) continue;
      most = sum;
      best.emplace();
      best->type = reading->feature->type;
      best->classifier = reading->feature->classifier;
      best->mean_m = place_m;
      best->placed_ns = stamps_ns_[reading->pose];
    }
    return best;
  }

  SmoothedLandmarks result() {
    const std::vector<double> evidence = this->evidence();
    std::vector<bool> seen(landmarks_.size(), false);
    for (const Reading& reading : readings_) {
      if (reading.landmark != kNone) seen[reading.landmark] = true;
    }
    if (std::count(seen.begin(), seen.end(), true) > 0) computeCovariances(seen);
    SmoothedLandmarks result;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const std::array<double, 3>& pose = poses_[i];
      result.trajectory.push_back({stamps_ns_[i], {pose[0], pose[1], wrapAngle(pose[2])}});
    }
    result.map.stamp_ns = stamps_ns_.back();
    for (std::size_t j = 0; j < landmarks_.size(); ++j) {
      if (!seen[j] || evidence[j] < parameters_.least_evidence) continue;
      landmarks_[j].existence_log_odds = evidence[j];
      result.map.landmarks.push_back(landmarks_[j]);
    }
    return result;
  }

  LandmarkSmootherParameters parameters_;
  std::vector<LandmarkEstimate> landmarks_;
  LandmarkId next_id_ = 0;
  std::vector<std::int64_t> stamps_ns_;
  std::vector<std::array<double, 3>> poses_;  ///< x, y, yaw of map_from_base at the stamps
  std::vector<PoseWithCovariance2> motions_;  ///< from each pose to the next
  std::vector<Reading> readings_;
  double deviation_m_ = 0.0;  ///< of the landmarks in this round
  double cost_ = 0.0;         ///< of the last least squares [nat]
};

}  // namespace

void LandmarkSmootherParameters::validate() const {
  using ram_parameters::require;
  using ram_parameters::requirePositive;
  require(reading_share > 0.0 && reading_share <= 1.0, "reading_share", reading_share, "in (0, 1]");
  requirePositive("robust_chi2", robust_chi2);
  requirePositive("association_gate", association_gate);
  requirePositive("last_deviation_m", last_deviation_m);
  require(first_deviation_m >= last_deviation_m, "first_deviation_m", first_deviation_m,
          ">= last_deviation_m");
  requirePositive("least_evidence", least_evidence);
  require(round_count >= 1, "round_count", round_count, ">= 1");
  require(attempt_count >= 0, "attempt_count", attempt_count, ">= 0");
}

LandmarkSmootherParameters readLandmarkSmootherParameters(ram_parameters::ParameterReader& reader) {
  LandmarkSmootherParameters parameters;
  reader.read("reading_share", parameters.reading_share);
  reader.read("robust_chi2", parameters.robust_chi2);
  reader.read("association_gate", parameters.association_gate);
  reader.read("first_deviation_m", parameters.first_deviation_m);
  reader.read("last_deviation_m", parameters.last_deviation_m);
  reader.read("least_evidence", parameters.least_evidence);
  reader.read("round_count", parameters.round_count);
  reader.read("attempt_count", parameters.attempt_count);
  parameters.validate();
  return parameters;
}

SmoothedLandmarks smoothLandmarks(const std::vector<FeatureStep>& steps,
                                  const Trajectory& trajectory,
                                  const std::vector<LandmarkEstimate>& landmarks,
                                  const LandmarkSmootherParameters& parameters) {
  parameters.validate();
  validate(trajectory);
  return Smoother(steps, trajectory, landmarks, parameters).run();
}

}  // namespace ram_slam
