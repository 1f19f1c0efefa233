// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/landmark_registry.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

struct NumberedDescriptor : FeatureMatcher::Descriptor {
  explicit NumberedDescriptor(double value) : number(value) {}
  double number;
};

/// Descriptors are numbers; the farther apart, the less alike.
class NumberMatcher : public FeatureMatcher {
public:
  std::shared_ptr<const Descriptor> parse(const std::string& classifier) const override {
    return std::make_shared<const NumberedDescriptor>(std::stod(classifier));
  }
  double logLikelihoodRatio(const Descriptor& a, const Descriptor& b) const override {
    return 3.0 - std::abs(dynamic_cast<const NumberedDescriptor&>(a).number -
                          dynamic_cast<const NumberedDescriptor&>(b).number);
  }
};

Feature pole() {
  Feature feature;
  feature.type = "pole";
  feature.classifier = "7";
  return feature;
}

TEST(LandmarkRegistry, NeverUsesAnIdentifierAgain) {
  LandmarkRegistry registry;
  EXPECT_EQ(registry.create(pole(), nullptr).id, 0U);
  EXPECT_EQ(registry.create(pole(), nullptr).id, 1U);
  registry.remove(1);
  registry.remove(1);  // no effect
  EXPECT_EQ(registry.find(1), nullptr);
  EXPECT_EQ(registry.create(pole(), nullptr).id, 2U);
  registry.skip(10);
  EXPECT_EQ(registry.create(pole(), nullptr).id, 13U);
  EXPECT_EQ(registry.records().size(), 3U);
}

TEST(LandmarkRegistry, KeepsTypeClassifierAndDescriptorOfTheFeature) {
  LandmarkRegistry registry;
  const NumberMatcher matcher;
  registry.create(pole(), matcher.parse("7"));
  const LandmarkRecord& record = *registry.find(0);
  EXPECT_EQ(record.type, "pole");
  EXPECT_EQ(*record.classifier, "7");
  EXPECT_EQ(record.descriptors.size(), 1U);
  EXPECT_TRUE(record.bounds_m.isEmpty());
}

TEST(LandmarkRegistry, RefusesARestoredRecordOutOfOrder) {
  LandmarkRegistry registry;
  LandmarkRecord record;
  record.id = 5;
  registry.restore(record);
  EXPECT_THROW(registry.restore(record), std::invalid_argument);
  record.id = 4;
  EXPECT_THROW(registry.restore(record), std::invalid_argument);
  EXPECT_EQ(registry.create(pole(), nullptr).id, 6U);
}

TEST(AddSighting, KeepsADescriptorThatIsUnlikeThoseKnownUpToTheMost) {
  const NumberMatcher matcher;
  AppearanceParameters parameters;  // kept below 1 nat
  parameters.maximum_descriptors = 3;
  LandmarkRecord record;
  const auto add = [&](const char* classifier) {
    addSighting(record, {1.0, 0.0}, &matcher, matcher.parse(classifier), parameters);
    return record.descriptors.size();
  };
  EXPECT_EQ(add("0"), 1U);
  EXPECT_EQ(add("1.9"), 1U) << "1.1 nat: known";
  EXPECT_EQ(add("2.1"), 2U) << "0.9 nat: new";
  EXPECT_EQ(add("10"), 3U);
  EXPECT_EQ(add("20"), 3U) << "no more than three are kept";
}

TEST(KnownFrom, HoldsInTheDirectionAndDistanceOfASighting) {
  LandmarkRecord record;
  addSighting(record, {3.0, 0.1}, nullptr, nullptr, {});
  EXPECT_TRUE(knownFrom(record, {3.0, 0.1}));
  EXPECT_TRUE(knownFrom(record, {1.0, -0.1})) << "nearer, in the sector beside";
  EXPECT_FALSE(knownFrom(record, {3.1, 0.1})) << "farther than it was ever seen";
  EXPECT_FALSE(knownFrom(record, {-1.0, 0.1})) << "from behind";
  EXPECT_FALSE(knownFrom(record, {0.0, 1.0})) << "from the side";
}

TEST(KnownFrom, WrapsFromTheLastSectorToTheFirst) {
  LandmarkRecord record;
  addSighting(record, {-3.0, 0.1}, nullptr, nullptr, {});
  EXPECT_TRUE(knownFrom(record, {-2.0, -0.1}));
}

TEST(AddOrientation, IsAKalmanFilterOfTheAngle) {
  AppearanceParameters parameters;
  parameters.sighting_sigma_rad = 0.1;
  LandmarkRecord record;
  record.orientation_rad = M_PI - 0.1;
  record.orientation_variance_rad2 = 0.04;
  addOrientation(record, -M_PI + 0.1, 0.01, parameters);  // 0.2 rad farther
  const double gain = 0.04 / (0.04 + 0.01 + 0.01);
  EXPECT_NEAR(wrapAngle(record.orientation_rad - (M_PI - 0.1)), gain * 0.2, 1e-12);
  EXPECT_NEAR(record.orientation_variance_rad2, (1.0 - gain) * 0.04, 1e-12);
}

TEST(AddOrientation, IgnoresAnOrientationThatWasNotObserved) {
  LandmarkRecord record;
  addOrientation(record, 1.0, 1e6, {});
  EXPECT_EQ(record.orientation_rad, 0.0);
  EXPECT_EQ(record.orientation_variance_rad2, 1e6);
}

}  // namespace
}  // namespace ram_slam
