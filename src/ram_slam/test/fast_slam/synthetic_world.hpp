// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <vector>

#include "ram_slam/geometry/random.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/motion/motion_model.hpp"

namespace ram_slam {

/// A made-up drive with noisy odometry and features, of which the truth is known.
struct SyntheticNoise {
  double drive_m2_per_m = 4e-4;     ///< variance of the distance, per metre driven
  double side_m2_per_m = 1e-4;      ///< sideways
  double turn_rad2_per_m = 2e-4;    ///< of the yaw, per metre driven
  double turn_rad2_per_rad = 1e-3;  ///< of the yaw, per radian turned
  double feature_m = 0.03;          ///< standard deviation per axis
};

/// The odometry of a drive: motions between stamps as an encoder would measure them, with the
/// right covariance.
class SyntheticOdometry : public MotionModel {
public:
  void add(std::int64_t stamp_ns,
           const Pose2& true_motion,
           const SyntheticNoise& noise,
           Random& random) {
    const double length_m = true_motion.translation().norm();
    Step step;
    step.motion.covariance.diagonal() << noise.drive_m2_per_m * length_m,
        noise.side_m2_per_m * length_m,
        noise.turn_rad2_per_m * length_m + noise.turn_rad2_per_rad * std::abs(true_motion.yaw_rad);
    const Eigen::Vector3d error = random.gaussian(step.motion.covariance);
    step.motion.pose = {true_motion.x_m + error.x(), true_motion.y_m + error.y(),
                        wrapAngle(true_motion.yaw_rad + error.z())};
    step.from_ns = last_ns_;
    if (last_ns_ != 0) steps_[stamp_ns] = step;
    last_ns_ = stamp_ns;
  }

  PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const override {
    if (to_ns < from_ns) throw std::invalid_argument("backwards");
    PoseWithCovariance2 sum;
    std::int64_t at_ns = from_ns;
    for (auto step = steps_.upper_bound(from_ns); step != steps_.end() && at_ns < to_ns; ++step) {
      if (step->second.from_ns != at_ns) throw std::out_of_range("no odometry");
      sum = sum * step->second.motion;
      at_ns = step->first;
    }
    if (at_ns != to_ns) throw std::out_of_range("no odometry");
    return sum;
  }

private:
  struct Step {
    std::int64_t from_ns = 0;
    PoseWithCovariance2 motion;
  };
  std::map<std::int64_t, Step> steps_;
  std::int64_t last_ns_ = 0;
};

struct SyntheticDrive {
  std::vector<Eigen::Vector2d>
      landmarks_m;           ///< in the map frame, which is the base frame at the start
  std::vector<Pose2> truth;  ///< one per list
  std::vector<FeatureList> lists;
  SyntheticOdometry odometry;
};

/// Rounds of a rectangle with rounded corners, width x height, at 0.1 m per reading, starting at
/// the origin along x.
inline std::vector<Pose2> rectangleTour(double width_m, double height_m, int rounds) {
  constexpr double kStep_m = 0.1;
  constexpr int kTurnSteps = 15;
  std::vector<Pose2> poses{Pose2{}};
  const auto drive = [&poses](const Pose2& step, int count) {
    for (int i = 0; i < count; ++i) poses.push_back(poses.back() * step);
  };
  for (int side = 0; side < 4 * rounds; ++side) {
    drive({kStep_m, 0.0, 0.0}, static_cast<int>((side % 2 == 0 ? width_m : height_m) / kStep_m));
    drive({kStep_m, 0.0, M_PI_2 / kTurnSteps}, kTurnSteps);
  }
  return poses;
}

/// Features within `range_m` and 135 degrees to either side, each seen with a probability of 0.7.
inline SyntheticDrive syntheticDrive(const std::vector<Pose2>& tour,
                                     const std::vector<Eigen::Vector2d>& landmarks_m,
                                     double range_m,
                                     const SyntheticNoise& noise,
                                     std::uint64_t seed) {
  constexpr std::int64_t kPeriodNs = 100'000'000;
  SyntheticDrive drive;
  drive.landmarks_m = landmarks_m;
  drive.truth = tour;
  Random random(seed);
  for (std::size_t i = 0; i < tour.size(); ++i) {
    FeatureList list;
    list.stamp_ns = static_cast<std::int64_t>(i + 1) * kPeriodNs;
    drive.odometry.add(list.stamp_ns, i == 0 ? Pose2{} : tour[i - 1].inverse() * tour[i], noise,
                       random);
    for (const Eigen::Vector2d& landmark_m : landmarks_m) {
      const Eigen::Vector2d seen = tour[i].inverse() * landmark_m;
      if (seen.norm() > range_m || std::abs(std::atan2(seen.y(), seen.x())) > 0.75 * M_PI) continue;
      if (random.uniform() > 0.7) continue;
      Feature feature;
      feature.type = "pole";
      feature.position_m =
          seen + noise.feature_m * Eigen::Vector2d(random.gaussian(), random.gaussian());
      feature.covariance_m2 = noise.feature_m * noise.feature_m * Eigen::Matrix2d::Identity();
      list.features.push_back(feature);
    }
    drive.lists.push_back(list);
  }
  return drive;
}

/// Landmarks scattered over the box around a tour, at least `apart_m` from each other.
inline std::vector<Eigen::Vector2d> scatteredLandmarks(const Eigen::Vector2d& lowest_m,
                                                       const Eigen::Vector2d& highest_m,
                                                       std::size_t count,
                                                       double apart_m,
                                                       std::uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Vector2d> landmarks_m;
  while (landmarks_m.size() < count) {
    const Eigen::Vector2d draw(random.uniform(), random.uniform());
    const Eigen::Vector2d place_m = lowest_m + draw.cwiseProduct(highest_m - lowest_m);
    bool free = true;
    for (const Eigen::Vector2d& other_m : landmarks_m)
      free = free && (other_m - place_m).norm() >= apart_m;
    if (free) landmarks_m.push_back(place_m);
  }
  return landmarks_m;
}

}  // namespace ram_slam
