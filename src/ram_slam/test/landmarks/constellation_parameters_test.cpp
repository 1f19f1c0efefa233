// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "ram_slam/landmarks/constellation.hpp"

namespace ram_slam {
namespace {

void expectRefused(const ConstellationParameters& parameters, const std::string& key) {
  try {
    ConstellationParameters::table().check(parameters);
    ADD_FAILURE() << key << " was accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::StartsWith(key));
  }
}

TEST(ConstellationParameters, AreAcceptedByDefault) {
  EXPECT_NO_THROW(ConstellationParameters::table().check(ConstellationParameters{}));
}

TEST(ConstellationParameters, RefuseFewerThanTwoPairsSinceOneGivesNoDirection) {
  ConstellationParameters parameters;
  parameters.minimum_pairs = 2;
  EXPECT_NO_THROW(ConstellationParameters::table().check(parameters));
  parameters.minimum_pairs = 1;
  expectRefused(parameters, "minimum_pairs");
}

TEST(ConstellationParameters, RefuseAShareBeyondOne) {
  ConstellationParameters parameters;
  parameters.minimum_overlap = 1.01;
  expectRefused(parameters, "minimum_overlap");
}

TEST(ConstellationParameters, RefuseALikenessThatIsNotFinite) {
  ConstellationParameters parameters;
  parameters.minimum_likeness = -std::numeric_limits<double>::infinity();
  expectRefused(parameters, "minimum_likeness");
}

TEST(ConstellationParameters, CheckTheSearchInItsSection) {
  ConstellationParameters parameters;
  parameters.search.vote_cell_m = 0.0;
  expectRefused(parameters, "constellation_search/vote_cell_m");
}

}  // namespace
}  // namespace ram_slam
