// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/estimation/estimator_registry.hpp"

#include <map>
#include <stdexcept>
#include <utility>

#include "ram_slam/estimation/fast_slam_estimator.hpp"

namespace ram_slam {
namespace {

/// One line per estimator.
std::map<std::string, EstimatorReader>& estimators() {
  static std::map<std::string, EstimatorReader> all{
      {"fast_slam", readFastSlamEstimator},
  };
  return all;
}

}  // namespace

void registerEstimator(const std::string& name, EstimatorReader read) {
  estimators()[name] = std::move(read);
}

const EstimatorReader& findEstimator(const std::string& name) {
  const auto found = estimators().find(name);
  if (found != estimators().end()) return found->second;
  std::string names;
  for (const std::string& known : estimatorNames()) names += (names.empty() ? "" : ", ") + known;
  throw std::invalid_argument("there is no estimator '" + name + "'; known are: " + names);
}

std::vector<std::string> estimatorNames() {
  std::vector<std::string> names;
  for (const auto& [name, read] : estimators()) names.push_back(name);
  return names;
}

EstimatorFactory startingIn(EstimatorFactory make,
                            LandmarkMap map,
                            std::vector<PlacedView> views,
                            bool is_fixed) {
  EstimatorFactory makeInMap = [make = std::move(make), map = std::move(map),
                                views = std::move(views), is_fixed] {
    std::unique_ptr<Estimator> estimator = make();
    estimator->setMap(map, views);
    if (is_fixed) estimator->fixMap();
    return estimator;
  };
  if (!makeInMap()->isLost()) {
    throw std::invalid_argument(
        "a robot cannot be found in this map: it has no landmarks, or the search for a lost robot "
        "is disabled");
  }
  return makeInMap;
}

}  // namespace ram_slam
