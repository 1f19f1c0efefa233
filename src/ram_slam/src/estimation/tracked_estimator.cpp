// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/estimation/tracked_estimator.hpp"

namespace ram_slam {

std::vector<Pose2> TrackedEstimator::hypotheses() const {
  if (slam_.lost()) return {};
  return slam_.filter().hypotheses();
}

std::string TrackedEstimator::state() const {
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

std::vector<std::pair<std::string, double>> TrackedEstimator::health() const {
  const MapAgreement& agreement = slam_.agreement();
  std::vector<std::pair<std::string, double>> figures{
      {"quality: landmarks found of those expected", agreement.quality()},
      {"landmarks expected", agreement.expected_count},
      {"landmarks found", agreement.found_count},
      {"places with features unknown to the map", agreement.unexplained_count},
      {"landmarks", static_cast<double>(slam_.filter().registry().records().size())}};
  for (auto& figure : slam_.filter().health()) figures.push_back(std::move(figure));
  return figures;
}

}  // namespace ram_slam
