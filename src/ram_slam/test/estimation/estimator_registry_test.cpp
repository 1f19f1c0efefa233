// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/estimation/estimator_registry.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

#include "../dummy_estimator.hpp"

namespace ram_slam {
namespace {

using testing::Contains;
using testing::HasSubstr;

TEST(EstimatorRegistry, KnowsFastSlam) {
  EXPECT_THAT(estimatorNames(), Contains("fast_slam"));
}

TEST(EstimatorRegistry, MakesWhatAnotherPackageAdded) {
  registerEstimator("dummy", [](ram_parameters::ParameterReader&, FeatureMatchers) {
    return []() -> std::unique_ptr<Estimator> { return std::make_unique<DummyEstimator>(); };
  });
  ram_parameters::ParameterReader reader(YAML::Node(), "test");
  const EstimatorFactory make = findEstimator("dummy")(reader, {});
  EXPECT_FALSE(make()->started());
  EXPECT_THAT(estimatorNames(), Contains("dummy"));
}

/// The one line of a filter in the registry is enough: its estimator, its parameters' file and the
/// recovery follow from it.
TEST(EstimatorRegistry, MakesAnEstimatorOfEachFilter) {
  for (const auto& [name, filter] : filters()) {
    ram_parameters::ParameterReader reader(
        ram_parameters::readYamlFile(CONFIG_FOLDER "/" + name + ".yaml"), name);
    const EstimatorFactory make = findEstimator(name)(reader, {});
    EXPECT_FALSE(make()->started()) << name;
    EXPECT_FALSE(make()->isLost()) << name;
    ram_parameters::ParameterReader nothing(YAML::Node(), name);
    EXPECT_THROW(startingIn(findEstimator(name)(nothing, {}), {}, {}, false), std::invalid_argument)
        << name << " cannot be lost without a landmark";
  }
}

TEST(EstimatorRegistry, NamesTheKnownOnesWhenAskedForAnother) {
  try {
    findEstimator("fast_slma");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("no estimator 'fast_slma'"));
    EXPECT_THAT(error.what(), HasSubstr("fast_slam"));
  }
}

TEST(EstimatorRegistry, MakesEstimatorsThatBeginInAMap) {
  const EstimatorFactory dummy = [] { return std::make_unique<DummyEstimator>(); };
  EXPECT_TRUE(startingIn(dummy, {}, {}, false)()->isLost());
  EXPECT_THROW(startingIn(dummy, {}, {}, true), std::invalid_argument);  // it cannot fix a map
}

TEST(EstimatorRegistry, RefusesAMapInWhichNoRobotCanBeFound) {
  ram_parameters::ParameterReader reader(YAML::Node(), "test");
  EXPECT_THROW(startingIn(findEstimator("fast_slam")(reader, {}), {}, {}, false),
               std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
