// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/landmark_problem.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

namespace ram_slam {
namespace {

void addPose(LandmarkProblem& problem,
             const FeatureStep& step,
             const Trajectory& trajectory,
             const LandmarkSmootherParameters& parameters) {
  std::vector<std::int64_t>& stamps_ns = problem.stamps_ns;
  const std::int64_t stamp_ns = step.list.stamp_ns;
  if (!stamps_ns.empty() && stamp_ns < stamps_ns.back()) {
    throw std::invalid_argument("features of " + std::to_string(stamp_ns) +
                                " ns come after those of " + std::to_string(stamps_ns.back()) +
                                " ns");
  }
  const std::optional<Pose2> pose = poseAt(trajectory, stamp_ns);
  if (!pose) {
    throw std::invalid_argument("features of " + std::to_string(stamp_ns) +
                                " ns are outside the trajectory");
  }
  if (!stamps_ns.empty()) {
    if (!step.motion.pose.isFinite() || !step.motion.covariance.allFinite())
      throw std::invalid_argument("a motion is not finite");
    problem.motions.push_back(step.motion);
    problem.motions.back().covariance.diagonal() +=
        Eigen::Vector3d(parameters.rest_deviation_m, parameters.rest_deviation_m,
                        parameters.rest_deviation_rad)
            .cwiseAbs2();
  }
  stamps_ns.push_back(stamp_ns);
  problem.poses.push_back({pose->x_m, pose->y_m, pose->yaw_rad});
}

void addReading(LandmarkProblem& problem, const Feature& feature) {
  const Eigen::Matrix2d& c = feature.covariance_m2;
  if (!feature.position_m.allFinite() || !c.allFinite() || !(c(0, 0) > 0.0) ||
      !(c.determinant() > 0.0)) {
    throw std::invalid_argument(
        "a feature's position and covariance must be finite, the covariance positive definite");
  }
  FeatureReading reading;
  reading.pose = problem.poses.size() - 1;
  reading.feature = &feature;
  reading.measured = {feature.position_m, c};
  problem.readings.push_back(reading);
}

}  // namespace

LandmarkProblem makeLandmarkProblem(const std::vector<FeatureStep>& steps,
                                    const Trajectory& trajectory,
                                    const std::vector<LandmarkEstimate>& landmarks,
                                    const LandmarkSmootherParameters& parameters) {
  LandmarkProblem problem;
  problem.landmarks = landmarks;
  for (const FeatureStep& step : steps) {
    if (problem.stamps_ns.empty() || step.list.stamp_ns != problem.stamps_ns.back())
      addPose(problem, step, trajectory, parameters);
    for (const Feature& feature : step.list.features) addReading(problem, feature);
  }
  for (const LandmarkEstimate& landmark : landmarks)
    problem.next_id = std::max(problem.next_id, landmark.id + 1);
  return problem;
}

}  // namespace ram_slam
