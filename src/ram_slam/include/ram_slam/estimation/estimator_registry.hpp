// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/estimation/estimator.hpp"
#include "ram_slam/fast_slam/landmark_filter.hpp"
#include "ram_slam/landmarks/feature_matcher.hpp"

namespace ram_slam {

/// Makes an estimator that knows nothing yet; called again when the clock is set back or a user
/// asks for a reset.
using EstimatorFactory = std::function<std::unique_ptr<Estimator>()>;

/// Makes estimators that begin, lost, with a map made before.
/// \param is_fixed  they only estimate the pose
/// \throws std::invalid_argument if the estimator cannot be lost in that map: it has no landmarks,
/// or the search for a lost robot is disabled; or as Estimator::setMap() and fixMap()
EstimatorFactory startingIn(EstimatorFactory make,
                            LandmarkMap map,
                            std::vector<PlacedView> views,
                            bool is_fixed);

/// Reads the estimator's own parameters, once. \throws std::invalid_argument if one is refused
using EstimatorReader =
    std::function<EstimatorFactory(ram_parameters::ParameterReader& reader, FeatureMatchers)>;

/// Adds an estimator under a name; one of that name is replaced.
void registerEstimator(const std::string& name, EstimatorReader read);

/// \throws std::invalid_argument naming the known ones if there is none of that name
const EstimatorReader& findEstimator(const std::string& name);

/// In alphabetical order.
std::vector<std::string> estimatorNames();

/// The filters of this package, by name: the estimator of that name is the filter with recovery
/// (Tracker), and reads config/<name>.yaml.
const std::map<std::string, FilterEntry>& filters();

}  // namespace ram_slam
