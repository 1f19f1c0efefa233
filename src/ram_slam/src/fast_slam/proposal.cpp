// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/proposal.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ram_slam {

std::vector<PoseWithCovariance2> FastSlam1Proposal::predict(const std::vector<Particle>& particles,
                                                            const MotionStep& step,
                                                            const PoseWithCovariance2&,
                                                            std::uint64_t seed) const {
  std::vector<Pose2> poses;
  for (const Particle& particle : particles) poses.push_back(particle.map_from_base);
  if (step.from_ns != 0 && step.to_ns != step.from_ns)
    poses = step.model->sample(poses, step.from_ns, step.to_ns, seed);
  const bool finite =
      std::all_of(poses.begin(), poses.end(), [](const Pose2& pose) { return pose.isFinite(); });
  if (poses.size() != particles.size() || !finite) {
    throw std::invalid_argument("the motion model gives too few poses or some that are not finite");
  }
  std::vector<PoseWithCovariance2> predicted;
  for (const Pose2& pose : poses) predicted.push_back({pose, Eigen::Matrix3d::Zero()});
  return predicted;
}

Evidence FastSlam1Proposal::associate(const std::vector<Observation>& observations,
                                      const Particle& particle,
                                      Random) const {
  return associateByDistance(observations, particle.landmarks, particle.proposal.pose, parameters_);
}

std::vector<PoseWithCovariance2> FastSlam2Proposal::predict(const std::vector<Particle>& particles,
                                                            const MotionStep&,
                                                            const PoseWithCovariance2& since_update,
                                                            std::uint64_t) const {
  std::vector<PoseWithCovariance2> predicted;
  predicted.reserve(particles.size());
  for (const Particle& particle : particles) {
    predicted.push_back(PoseWithCovariance2{particle.map_from_base, Eigen::Matrix3d::Zero()} *
                        since_update);
  }
  return predicted;
}

Evidence FastSlam2Proposal::associate(const std::vector<Observation>& observations,
                                      const Particle& particle,
                                      Random random) const {
  return ram_slam::associate(observations, particle.landmarks, particle.proposal, parameters_,
                             random);
}

bool FastSlam2Proposal::isUpdateDue(const FeatureList& list,
                                    const Pose2& since_update,
                                    bool is_at_last_update) const {
  return !list.features.empty() &&
         (is_at_last_update || since_update.translation().norm() >= parameters_.update_distance ||
          std::abs(since_update.yaw_rad) >= parameters_.update_angle);
}

bool FastSlam2Proposal::isResamplingDue(double effective_count, std::size_t particle_count) const {
  return !(effective_count >= parameters_.resample_threshold * static_cast<double>(particle_count));
}

std::shared_ptr<const Proposal> makeProposal(const FastSlamParameters& parameters) {
  if (parameters.mode == FastSlamMode::kFastSlam1)
    return std::make_shared<const FastSlam1Proposal>(parameters);
  return std::make_shared<const FastSlam2Proposal>(parameters);
}

}  // namespace ram_slam
