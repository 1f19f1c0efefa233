// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ram_slam/smoothing/landmark_problem.hpp"

namespace ram_slam {

inline Feature pole(const Eigen::Vector2d& position_m, double deviation_m) {
  Feature feature;
  feature.type = "pole";
  feature.position_m = position_m;
  feature.covariance_m2 = deviation_m * deviation_m * Eigen::Matrix2d::Identity();
  return feature;
}

inline LandmarkEstimate poleAt(LandmarkId id, const Eigen::Vector2d& place_m) {
  LandmarkEstimate landmark;
  landmark.id = id;
  landmark.type = "pole";
  landmark.mean_m = place_m;
  return landmark;
}

/// A robot that stays at the origin of the map, and what it sees at 1, 2, .. ns.
struct RestProblem {
  std::vector<FeatureStep> steps;
  std::vector<LandmarkEstimate> landmarks;
  LandmarkSmootherParameters parameters;

  /// \param features  one list per step
  explicit RestProblem(const std::vector<std::vector<Feature>>& features) {
    for (const std::vector<Feature>& list : features) {
      FeatureStep step;
      step.list.stamp_ns = static_cast<std::int64_t>(steps.size() + 1);
      step.list.features = list;
      step.motion.covariance.setZero();
      steps.push_back(step);
    }
  }

  LandmarkProblem make() const {
    Trajectory trajectory;
    for (const FeatureStep& step : steps) trajectory.push_back({step.list.stamp_ns, {}});
    return makeLandmarkProblem(steps, trajectory, landmarks, parameters);
  }
};

}  // namespace ram_slam
