// SPDX-License-Identifier: BSD-3-Clause
// Runs an estimator on a data set of the UTIAS Multi-Robot Cooperative Localization and Mapping
// collection (Leung et al., IJRR 2011) and compares with its ground truth: once with known
// association, once without.
//
//   evaluate_mrclam FOLDER [SEEDS] [PARTICLES] [fast_slam | ekf_slam]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "ram_slam/ekf_slam/ekf_slam.hpp"
#include "ram_slam/fast_slam/fast_slam.hpp"
#include "ram_slam/smoothing/landmark_smoother.hpp"

namespace {

using namespace ram_slam;

constexpr int kRobots = 5;
// One set for all robots, from comparing all of them with the truth: the range's error grows with
// the range, and both errors hardly change from reading to reading (correlation 0.9 within 1 s, 0.6
// after 3 s), for which the standard deviations are half as large again as those found.
constexpr double kRangeSigma_m = 0.02;
constexpr double kRangeSigma_m_per_m = 0.07;
constexpr double kBearingSigma_rad = 0.015;
constexpr double kDriveVariance_m2_per_m = 2e-3;
constexpr double kTurnVariance_rad2_per_rad = 1e-2;
constexpr double kTurnVariance_rad2_per_m = 5e-3;
constexpr double kTurnVariance_rad2_per_s = 1e-4;
// The recorded velocities are commands: they take effect later, and motions come out smaller.
constexpr double kCommandDelay_s = 0.2;
constexpr double kMotionScale = 0.935;
// Pictures are stamped when they have been worked out: their bearings lag while a robot turns.
constexpr double kCameraDelay_s = 0.04;
// Where a third of the landmarks are found in a picture, counted with the truth.
constexpr double kHalfViewAngle_rad = 0.4;
constexpr double kViewFrom_m = 1.0;
constexpr double kViewTo_m = 5.0;
constexpr double kDetectionProbability = 0.3;

std::vector<std::vector<double>> readTable(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream values(line);
    rows.emplace_back();
    for (double value = 0.0; values >> value;) rows.back().push_back(value);
  }
  return rows;
}

std::int64_t toStamp(double time_s) {
  return static_cast<std::int64_t>(time_s * 1e3 + 0.5) * 1'000'000;
}

/// Integrates velocities that hold until the next one.
class VelocityOdometry : public MotionModel {
public:
  explicit VelocityOdometry(const std::vector<std::vector<double>>& rows) {
    for (const auto& row : rows)
      samples_.push_back(
          {toStamp(row[0] + kCommandDelay_s), kMotionScale * row[1], kMotionScale * row[2]});
  }

  PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const override {
    PoseWithCovariance2 sum;
    auto sample =
        std::upper_bound(samples_.begin(), samples_.end(), from_ns,
                         [](std::int64_t stamp, const Sample& s) { return stamp < s.stamp_ns; });
    if (sample == samples_.begin()) throw std::out_of_range("no odometry yet");
    for (--sample; from_ns < to_ns; ++sample) {
      const auto next = sample + 1;
      const std::int64_t until_ns =
          next == samples_.end() ? to_ns : std::min(next->stamp_ns, to_ns);
      const double duration_s = static_cast<double>(until_ns - from_ns) * 1e-9;
      const double length_m = sample->velocity_mps * duration_s;
      const double turn_rad = sample->turn_radps * duration_s;
      PoseWithCovariance2 step;
      step.pose = exponential({length_m, 0.0, turn_rad});
      step.covariance.diagonal() << kDriveVariance_m2_per_m * std::abs(length_m),
          0.1 * kDriveVariance_m2_per_m * std::abs(length_m),
          kTurnVariance_rad2_per_rad * std::abs(turn_rad) +
              kTurnVariance_rad2_per_m * std::abs(length_m) + kTurnVariance_rad2_per_s * duration_s;
      sum = sum * step;
      from_ns = until_ns;
    }
    return sum;
  }

private:
  struct Sample {
    std::int64_t stamp_ns = 0;
    double velocity_mps = 0.0;
    double turn_radps = 0.0;
  };
  std::vector<Sample> samples_;
};

/// What a camera sees; it does not know what stands in between.
class CameraView : public FieldOfView {
public:
  Sight look(const Eigen::Vector2d& point_in_base_m) const override {
    const double range_m = point_in_base_m.norm();
    const double bearing_rad = std::atan2(point_in_base_m.y(), point_in_base_m.x());
    const bool in_view =
        range_m > kViewFrom_m && range_m < kViewTo_m && std::abs(bearing_rad) < kHalfViewAngle_rad;
    return in_view ? Sight::kVisible : Sight::kHidden;
  }
  double range_m() const override { return kViewTo_m; }
  bool showsEverySide() const override { return true; }  // barcodes around a cylinder
  const std::vector<Eigen::Vector2d>& surface_m() const override { return no_surface_m_; }

private:
  std::vector<Eigen::Vector2d> no_surface_m_;
};

struct World {
  std::map<int, int> subject_of_barcode;
  std::map<int, Eigen::Vector2d> landmarks_m;
};

struct Recording {
  std::vector<FeatureList> lists;  ///< the type of a feature is its landmark's number
  std::vector<StampedPose2> truth;
};

Recording readRecording(const std::string& folder, int robot, const World& world) {
  const std::string prefix = folder + "/Robot" + std::to_string(robot) + "_";
  Recording recording;
  for (const auto& row : readTable(prefix + "Groundtruth.dat")) {
    recording.truth.push_back({toStamp(row[0]), {row[1], row[2], row[3]}});
  }
  for (const auto& row : readTable(prefix + "Measurement.dat")) {
    const std::int64_t stamp_ns = toStamp(row[0] - kCameraDelay_s);
    const auto subject = world.subject_of_barcode.find(static_cast<int>(row[1]));
    const bool covered =
        recording.truth.front().stamp_ns <= stamp_ns && stamp_ns <= recording.truth.back().stamp_ns;
    if (!covered || subject == world.subject_of_barcode.end() ||
        world.landmarks_m.count(subject->second) == 0)
      continue;
    if (recording.lists.empty() || recording.lists.back().stamp_ns != stamp_ns) {
      recording.lists.emplace_back();
      recording.lists.back().stamp_ns = stamp_ns;
    }
    Feature feature;
    feature.type = std::to_string(subject->second);
    const Eigen::Rotation2Dd bearing(row[3]);
    feature.position_m = bearing * Eigen::Vector2d(row[2], 0.0);
    const Eigen::Vector2d sigma_m(std::hypot(kRangeSigma_m, kRangeSigma_m_per_m * row[2]),
                                  kBearingSigma_rad * row[2]);
    feature.covariance_m2 = bearing.toRotationMatrix() * sigma_m.cwiseAbs2().asDiagonal() *
                            bearing.toRotationMatrix().transpose();
    feature.covariance_m2(0, 1) = feature.covariance_m2(1, 0);
    recording.lists.back().features.push_back(feature);
  }
  return recording;
}

Pose2 truthAt(const std::vector<StampedPose2>& truth, std::int64_t stamp_ns) {
  auto after = std::lower_bound(
      truth.begin(), truth.end(), stamp_ns,
      [](const StampedPose2& pose, std::int64_t stamp) { return pose.stamp_ns < stamp; });
  if (after == truth.begin()) return after->pose;
  const auto before = after - 1;
  const double fraction = static_cast<double>(stamp_ns - before->stamp_ns) /
                          static_cast<double>(after->stamp_ns - before->stamp_ns);
  return interpolate(before->pose, after->pose, fraction);
}

struct Score {
  double ate_m = 0.0;  ///< of the final trajectory, aligned to the truth
  double landmark_m =
      0.0;  ///< RMSE of landmarks after the same alignment, each to the nearest true one
  std::size_t landmark_count = 0;
};

double rms(const std::vector<double>& squares) {
  double sum = 0.0;
  for (const double square : squares) sum += square;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

/// The rigid motion that brings the points nearest to the wanted ones, in the sense of least
/// squares.
Pose2 alignment(const Eigen::Matrix2Xd& points, const Eigen::Matrix2Xd& wanted) {
  const Eigen::Vector2d center = points.rowwise().mean();
  const Eigen::Vector2d wanted_center = wanted.rowwise().mean();
  double along = 0.0;
  double across = 0.0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector2d a = points.col(i) - center;
    const Eigen::Vector2d b = wanted.col(i) - wanted_center;
    along += a.dot(b);
    across += a.x() * b.y() - a.y() * b.x();
  }
  const Pose2 turn{0.0, 0.0, std::atan2(across, along)};
  const Eigen::Vector2d shift = wanted_center - turn * center;
  return {shift.x(), shift.y(), turn.yaw_rad};
}

/// Settings for a camera that never reports one landmark twice in a picture, nor one that is not
/// there, of landmarks 0.2 m apart, which single readings do not distinguish: every pair is
/// sampled.
FastSlamParameters cameraParameters() {
  FastSlamParameters parameters;
  parameters.particle_amount = 300;
  parameters.feature_noise_floor = 0.0;
  parameters.minimum_feature_separation = 0.1;
  parameters.creation_gate = 36.0;
  parameters.duplicate_gate = 0.0;
  parameters.ambiguity_margin = 50.0;
  parameters.draw_jointly = true;
  parameters.evidence_exponent = 0.5;
  parameters.detection_probability = kDetectionProbability;
  parameters.confirm_log_odds = 0.5;
  return parameters;
}

/// Compares a trajectory and the landmarks that go with it with the truth.
Score judge(const Trajectory& trajectory,
            const std::vector<LandmarkEstimate>& landmarks,
            const Recording& recording,
            const World& world) {
  Eigen::Matrix2Xd estimated(2, trajectory.size()), wanted(2, trajectory.size());
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    estimated.col(i) = trajectory[i].pose.translation();
    wanted.col(i) = truthAt(recording.truth, trajectory[i].stamp_ns).translation();
  }
  const Pose2 truth_from_map = alignment(estimated, wanted);
  std::vector<double> squares, landmark_squares;
  for (Eigen::Index i = 0; i < estimated.cols(); ++i) {
    squares.push_back(
        (truth_from_map * Eigen::Vector2d(estimated.col(i)) - wanted.col(i)).squaredNorm());
  }
  for (const LandmarkEstimate& landmark : landmarks) {
    double nearest = 1e9;
    for (const auto& [number, truth_m] : world.landmarks_m) {
      nearest = std::min(nearest, (truth_from_map * landmark.mean_m - truth_m).squaredNorm());
    }
    landmark_squares.push_back(nearest);
  }
  return {rms(squares), rms(landmark_squares), landmark_squares.size()};
}

struct Scores {
  double online_ate_m = 0.0;  ///< of the estimate as it was known then, in the frame of the start
  Score filter;
  Score smoothed;
};

LandmarkFilterFactory filterFactory(const std::string& name, const FastSlamParameters& parameters) {
  if (name == "fast_slam") return fastSlamFactory(parameters);
  if (name != "ekf_slam") throw std::invalid_argument("there is no estimator " + name);
  EkfSlamParameters ekf;
  ekf.common = parameters;
  return [ekf] { return std::make_unique<EkfSlam>(ekf); };
}

Scores evaluate(const Recording& recording,
                const World& world,
                const LandmarkFilterFactory& make,
                const LandmarkSmootherParameters& smoothing,
                const MotionModel& odometry) {
  PoseWithCovariance2 start;
  start.pose = truthAt(recording.truth, recording.lists.front().stamp_ns);
  const std::unique_ptr<LandmarkFilter> made = make();
  LandmarkFilter& filter = *made;
  filter.setPose(start);
  const CameraView view;
  std::vector<double> online;
  std::vector<FeatureStep> steps;
  for (const FeatureList& list : recording.lists) {
    steps.push_back({list, {}});
    if (filter.started()) steps.back().motion = odometry.motion(filter.stamp_ns(), list.stamp_ns);
    filter.update(list, motionStep(odometry, filter.stamp_ns(), list.stamp_ns), &view);
    online.push_back((filter.estimate().pose.translation() -
                      truthAt(recording.truth, list.stamp_ns).translation())
                         .squaredNorm());
  }
  std::vector<LandmarkEstimate> landmarks;
  for (const LandmarkEstimate& landmark : filter.landmarks().landmarks) {
    if (landmark.existence_log_odds >= filter.confirm_log_odds()) landmarks.push_back(landmark);
  }
  const SmoothedLandmarks smoothed =
      smoothLandmarks(steps, filter.trajectory(), landmarks, smoothing);
  return {rms(online), judge(filter.trajectory(), landmarks, recording, world),
          judge(smoothed.trajectory, smoothed.map.landmarks, recording, world)};
}

void print(const char* association, int robot, const std::vector<Scores>& scores) {
  const double share = 1.0 / static_cast<double>(scores.size());
  Scores mean;
  double filter_count = 0.0;
  double smoothed_count = 0.0;
  for (const Scores& each : scores) {
    mean.online_ate_m += share * each.online_ate_m;
    mean.filter.ate_m += share * each.filter.ate_m;
    mean.filter.landmark_m += share * each.filter.landmark_m;
    mean.smoothed.ate_m += share * each.smoothed.ate_m;
    mean.smoothed.landmark_m += share * each.smoothed.landmark_m;
    filter_count += share * static_cast<double>(each.filter.landmark_count);
    smoothed_count += share * static_cast<double>(each.smoothed.landmark_count);
  }
  std::printf(
      "robot %d  %-8s  ATE %.3f m (online, not aligned %.3f m)  landmarks %.3f m (%.1f of them)  "
      "smoothed: ATE %.3f m  landmarks %.3f m (%.1f)\n",
      robot, association, mean.filter.ate_m, mean.online_ate_m, mean.filter.landmark_m,
      filter_count, mean.smoothed.ate_m, mean.smoothed.landmark_m, smoothed_count);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: evaluate_mrclam FOLDER [SEEDS] [PARTICLES] [ESTIMATOR]\n");
    return EXIT_FAILURE;
  }
  const std::string folder = argv[1];
  const int seeds = argc > 2 ? std::atoi(argv[2]) : 3;
  const std::string estimator = argc > 4 ? argv[4] : "fast_slam";
  World world;
  for (const auto& row : readTable(folder + "/Barcodes.dat"))
    world.subject_of_barcode[static_cast<int>(row[1])] = static_cast<int>(row[0]);
  for (const auto& row : readTable(folder + "/Landmark_Groundtruth.dat"))
    world.landmarks_m[static_cast<int>(row[0])] = {row[1], row[2]};
  for (int robot = 1; robot <= kRobots; ++robot) {
    Recording recording = readRecording(folder, robot, world);
    const VelocityOdometry odometry(
        readTable(folder + "/Robot" + std::to_string(robot) + "_Odometry.dat"));
    for (const char* association : {"known", "unknown"}) {
      const bool unknown = std::string(association) == "unknown";
      for (FeatureList& list : recording.lists) {
        for (Feature& feature : list.features) {
          if (unknown) feature.type = "landmark";
        }
      }
      std::vector<Scores> scores;
      for (int seed = 1; seed <= seeds; ++seed) {
        FastSlamParameters parameters = cameraParameters();
        LandmarkSmootherParameters smoothing;
        parameters.seed = seed;
        if (!unknown) {
          // Every landmark has a type of its own: whatever the distance, it is that one.
          parameters.association_gate = parameters.creation_gate = 1e6;
          smoothing.association_gate = 1e6;
          parameters.ambiguity_margin = 0.0;
          parameters.unknown_feature_density = 1e-300;
        }
        if (argc > 3) parameters.particle_amount = std::atoi(argv[3]);
        scores.push_back(
            evaluate(recording, world, filterFactory(estimator, parameters), smoothing, odometry));
      }
      print(association, robot, scores);
    }
  }
  return EXIT_SUCCESS;
}
