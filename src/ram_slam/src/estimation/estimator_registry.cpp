// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/estimation/estimator_registry.hpp"

#include <stdexcept>
#include <utility>

#include "ram_slam/ekf_slam/ekf_slam.hpp"
#include "ram_slam/estimation/tracked_estimator.hpp"
#include "ram_slam/fast_slam/fast_slam.hpp"
#include "ram_slam/ukf_localiser/ukf_localiser.hpp"

namespace ram_slam {
namespace {

using ram_parameters::ParameterReader;

/// The filter with recovery.
EstimatorReader tracked(const FilterEntry& filter) {
  return [&filter](ParameterReader& reader, const FeatureMatchers& matchers) -> EstimatorFactory {
    const RecoveryParameters recovery = readRecoveryParameters(reader);
    return [make = filter.read(reader, matchers), recovery, matchers] {
      return std::make_unique<TrackedEstimator>(make, recovery, matchers);
    };
  };
}

std::map<std::string, EstimatorReader>& estimators() {
  static std::map<std::string, EstimatorReader> all = [] {
    std::map<std::string, EstimatorReader> readers;
    for (const auto& [name, filter] : filters()) readers[name] = tracked(filter);
    return readers;
  }();
  return all;
}

}  // namespace

/// One line per filter.
const std::map<std::string, FilterEntry>& filters() {
  static const std::map<std::string, FilterEntry> all{
      {"ekf_slam", ekfSlamEntry()},
      {"fast_slam", fastSlamEntry()},
      {"ukf_localiser", ukfLocaliserEntry()},
  };
  return all;
}

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
