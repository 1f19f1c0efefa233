// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/landmarks/constellation.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

constexpr double kRounding = 1e-9;

/// Points scattered over a square from the origin.
Constellation scattered(std::size_t count, double side_m, std::uint64_t seed) {
  Random random(seed);
  Constellation points(count);
  for (ConstellationPoint& point : points) {
    point.type = "pole";
    point.position_m = {side_m * random.uniform(), side_m * random.uniform()};
    point.covariance_m2 = 1e-4 * Eigen::Matrix2d::Identity();
  }
  return points;
}

Constellation seenFrom(const Pose2& map_from_base, const Constellation& map, double range_m) {
  Constellation seen;
  for (ConstellationPoint point : map) {
    point.position_m = map_from_base.inverse() * point.position_m;
    if (point.position_m.norm() < range_m) seen.push_back(point);
  }
  return seen;
}

void addNoise(Constellation& points, double sigma_m, std::uint64_t seed) {
  Random random(seed);
  for (ConstellationPoint& point : points)
    point.position_m += sigma_m * Eigen::Vector2d(random.gaussian(), random.gaussian());
}

const PoseHypothesis* accepted(const std::vector<PoseHypothesis>& hypotheses,
                               const Constellation& map,
                               const Constellation& seen,
                               const ConstellationParameters& parameters) {
  return uniqueHypothesis(hypotheses, seen.size(), chanceScore(map, parameters), parameters);
}

/// The classifier is a number; equal numbers are alike, different ones are not.
class NumberMatcher : public FeatureMatcher {
public:
  struct Number : Descriptor {
    explicit Number(int the_value) : value(the_value) {}
    int value;
  };
  std::shared_ptr<const Descriptor> parse(const std::string& classifier) const override {
    return std::make_shared<Number>(std::stoi(classifier));
  }
  double logLikelihoodRatio(const Descriptor& a, const Descriptor& b) const override {
    return static_cast<const Number&>(a).value == static_cast<const Number&>(b).value ? 2.0 : -2.0;
  }
};

TEST(AlignPoints, RecoversTheTransformOfExactPoints) {
  const Pose2 truth{3.0, -2.0, 2.5};
  const std::vector<Eigen::Vector2d> sources{{0.0, 0.0}, {1.0, 0.5}, {-2.0, 3.0}};
  std::vector<Eigen::Vector2d> targets;
  for (const Eigen::Vector2d& source : sources) targets.push_back(truth * source);
  const Pose2 found = alignPoints(targets, sources, {1.0, 2.0, 0.5});
  EXPECT_NEAR(found.x_m, truth.x_m, kRounding);
  EXPECT_NEAR(found.y_m, truth.y_m, kRounding);
  EXPECT_NEAR(found.yaw_rad, truth.yaw_rad, kRounding);
}

TEST(AlignPoints, RefusesOnePair) {
  EXPECT_THROW(alignPoints({{0.0, 0.0}}, {{0.0, 0.0}}, {1.0}), std::invalid_argument);
}

TEST(MatchConstellations, FindsExactPointsAmongAsManyOthers) {
  const ConstellationParameters parameters;
  const Constellation map = scattered(60, 30.0, 1);
  const Pose2 truth{14.0, 17.0, -2.0};
  Constellation seen = seenFrom(truth, map, 8.0);
  const std::size_t true_count = seen.size();
  ASSERT_GE(true_count, 8U);
  for (const ConstellationPoint& other : scattered(true_count, 8.0, 99)) seen.push_back(other);
  const auto hypotheses = matchConstellations(map, seen, {}, parameters);
  const PoseHypothesis* best = accepted(hypotheses, map, seen, parameters);
  ASSERT_NE(best, nullptr);
  const Pose2 error = truth.inverse() * best->target_from_source.pose;
  EXPECT_GE(best->pairs.size(), true_count);
  // An outlier may lie close enough to a landmark to pull at the fit, but not far.
  EXPECT_LT(error.translation().norm(), 0.1);
  EXPECT_LT(std::abs(error.yaw_rad), 0.02);
}

TEST(MatchConstellations, GivesTheExactPoseForExactPoints) {
  const ConstellationParameters parameters;
  const Constellation map = scattered(60, 30.0, 1);
  const Pose2 truth{14.0, 17.0, -2.0};
  const Constellation seen = seenFrom(truth, map, 8.0);
  const auto hypotheses = matchConstellations(map, seen, {}, parameters);
  const PoseHypothesis* best = accepted(hypotheses, map, seen, parameters);
  ASSERT_NE(best, nullptr);
  EXPECT_EQ(best->pairs.size(), seen.size());
  const Pose2 error = truth.inverse() * best->target_from_source.pose;
  EXPECT_NEAR(error.translation().norm(), 0.0, kRounding);
  EXPECT_NEAR(error.yaw_rad, 0.0, kRounding);
}

TEST(MatchConstellations, StatesACovarianceThatItsErrorsHave) {
  const ConstellationParameters parameters;
  const Constellation map = scattered(60, 30.0, 1);
  const Pose2 truth{14.0, 17.0, 1.0};
  double sum = 0.0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    Constellation seen = seenFrom(truth, map, 8.0);
    // The noise that the parameters assume: of the point in the target and of that in the source.
    addNoise(seen, std::sqrt(2.0) * parameters.position_sigma, 1000 + run);
    const auto hypotheses = matchConstellations(map, seen, {}, parameters);
    ASSERT_FALSE(hypotheses.empty());
    const PoseWithCovariance2& found = hypotheses[0].target_from_source;
    const Eigen::Vector3d error(found.pose.x_m - truth.x_m, found.pose.y_m - truth.y_m,
                                wrapAngle(found.pose.yaw_rad - truth.yaw_rad));
    sum += error.dot(found.covariance.inverse() * error);
  }
  // Mean of a chi2 with 3 degrees of freedom; its standard error is sqrt(6 / 200) = 0.17.
  EXPECT_NEAR(sum / kRuns, 3.0, 0.7);
}

TEST(MatchConstellations, NeverFindsAnUnrelatedMap) {
  const ConstellationParameters parameters;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Constellation map = scattered(80, 40.0, 2 * seed);
    const Constellation seen = scattered(15, 14.0, 2 * seed + 1);
    const auto hypotheses = matchConstellations(map, seen, {}, parameters);
    EXPECT_EQ(accepted(hypotheses, map, seen, parameters), nullptr) << "seed " << seed;
  }
}

TEST(MatchConstellations, NeverFindsAMirrorImage) {
  const ConstellationParameters parameters;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Constellation map = scattered(60, 30.0, 100 + seed);
    Constellation seen = seenFrom({15.0, 15.0, 0.3}, map, 9.0);
    for (ConstellationPoint& point : seen) point.position_m.y() *= -1.0;
    const auto hypotheses = matchConstellations(map, seen, {}, parameters);
    EXPECT_EQ(accepted(hypotheses, map, seen, parameters), nullptr) << "seed " << seed;
  }
}

TEST(MatchConstellations, DoesNotChooseBetweenTwoEqualPlaces) {
  const ConstellationParameters parameters;
  Constellation map = scattered(12, 10.0, 5);
  const Constellation seen = map;
  for (std::size_t i = 0; i < 12; ++i) {
    map.push_back(map[i]);
    map.back().position_m.x() += 20.0;
  }
  const auto hypotheses = matchConstellations(map, seen, {}, parameters);
  ASSERT_GE(hypotheses.size(), 2U);
  EXPECT_NEAR(hypotheses[0].score, hypotheses[1].score, 1e-6);
  EXPECT_EQ(accepted(hypotheses, map, seen, parameters), nullptr);
}

TEST(MatchConstellations, ChoosesBetweenTwoEqualPlacesByAppearance) {
  const ConstellationParameters parameters;
  const FeatureMatchers matchers{{"pole", std::make_shared<const NumberMatcher>()}};
  Constellation map = scattered(12, 10.0, 5);
  for (ConstellationPoint& point : map) point.descriptors = {matchers.at("pole")->parse("1")};
  const Constellation seen = map;
  for (std::size_t i = 0; i < 12; ++i) {
    map.push_back(map[i]);
    map.back().position_m.x() += 20.0;
    map.back().descriptors = {matchers.at("pole")->parse("2")};
  }
  const auto hypotheses = matchConstellations(map, seen, matchers, parameters);
  const PoseHypothesis* best = accepted(hypotheses, map, seen, parameters);
  ASSERT_NE(best, nullptr);
  EXPECT_NEAR(best->target_from_source.pose.x_m, 0.0, kRounding);
}

TEST(MatchConstellations, PairsOnlyPointsOfOneType) {
  Constellation map = scattered(12, 10.0, 5);
  const Constellation seen = map;
  for (ConstellationPoint& point : map) point.type = "tree";
  EXPECT_TRUE(matchConstellations(map, seen, {}, {}).empty());
}

TEST(MatchConstellations, GivesNothingForOnePoint) {
  EXPECT_TRUE(matchConstellations(scattered(12, 10.0, 5), scattered(1, 10.0, 5), {}, {}).empty());
  EXPECT_TRUE(matchConstellations({}, scattered(12, 10.0, 5), {}, {}).empty());
}

TEST(MatchConstellations, RefusesWhatIsNotFinite) {
  Constellation seen = scattered(5, 10.0, 5);
  seen[2].position_m.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(matchConstellations(scattered(12, 10.0, 5), seen, {}, {}), std::invalid_argument);
}

TEST(MatchConstellations, GivesTheSameBitsTwice) {
  const Constellation map = scattered(60, 30.0, 1);
  Constellation seen = seenFrom({14.0, 17.0, -2.0}, map, 8.0);
  addNoise(seen, 0.05, 3);
  const auto first = matchConstellations(map, seen, {}, {});
  const auto second = matchConstellations(map, seen, {}, {});
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].score, second[i].score);
    EXPECT_EQ(first[i].target_from_source.pose.x_m, second[i].target_from_source.pose.x_m);
  }
}

TEST(ConstellationParameters, NameWhatIsOutOfBounds) {
  ConstellationParameters parameters;
  parameters.expected_overlap = 1.0;
  try {
    parameters.validate();
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("expected_overlap must be in (0, 1), got 1.0"));
  }
}

}  // namespace
}  // namespace ram_slam
