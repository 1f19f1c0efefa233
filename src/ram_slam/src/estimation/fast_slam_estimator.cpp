// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/estimation/fast_slam_estimator.hpp"

namespace ram_slam {

std::vector<Pose2> FastSlamEstimator::hypotheses() const {
  std::vector<Pose2> poses;
  if (slam_.lost()) return poses;
  for (const Particle& particle : slam_.filter().particles())
    poses.push_back(particle.proposal.pose);
  return poses;
}

std::string FastSlamEstimator::state() const {
  switch (slam_.reason()) {
    case LostReason::kTracking:
      return "tracking";
    case LostReason::kDiscontinuity:
      return "two successive readings show different places";
    case LostReason::kMapContradicts:
      return "the surroundings do not match the map";
    case LostReason::kRequested:
      return "a global localisation was requested";
  }
  return "";
}

std::vector<std::pair<std::string, double>> FastSlamEstimator::health() const {
  const MapAgreement& agreement = slam_.agreement();
  const FastSlamQuality& quality = slam_.filter().quality();
  return {{"quality: landmarks found of those expected", agreement.quality()},
          {"landmarks expected", agreement.expected_count},
          {"landmarks found", agreement.found_count},
          {"places with features unknown to the map", agreement.unexplained_count},
          {"features matched recently", quality.matched_fraction},
          {"normalised innovation", quality.normalised_innovation},
          {"effective particles", quality.effective_fraction},
          {"landmarks", static_cast<double>(slam_.filter().registry().records().size())}};
}

EstimatorFactory readFastSlamEstimator(ram_parameters::ParameterReader& reader,
                                       FeatureMatchers matchers) {
  const FastSlamParameters filter = readFastSlamParameters(reader);
  const RecoveryParameters recovery = readRecoveryParameters(reader);
  return [=]() -> std::unique_ptr<Estimator> {
    return std::make_unique<FastSlamEstimator>(filter, recovery, matchers);
  };
}

}  // namespace ram_slam
