// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/estimation/tracked_estimator.hpp"

#include <gmock/gmock.h>

#include "ram_slam/estimation/estimator_registry.hpp"

namespace ram_slam {
namespace {

/// Stands still, exactly.
class Standing : public MotionModel {
public:
  PoseWithCovariance2 motion(std::int64_t, std::int64_t) const override { return {}; }
};

FeatureList poles(std::int64_t stamp_ns) {
  FeatureList list;
  list.stamp_ns = stamp_ns;
  for (int i = 0; i < 4; ++i) {
    Feature feature;
    feature.type = "pole";
    feature.position_m = {1.0 + i, i % 2 == 0 ? 1.0 : -2.0};
    feature.covariance_m2 = 1e-4 * Eigen::Matrix2d::Identity();
    list.features.push_back(feature);
  }
  return list;
}

std::unique_ptr<Estimator> fastSlam(const char* yaml) {
  ram_parameters::ParameterReader reader(YAML::Load(yaml), "test");
  return findEstimator("fast_slam")(reader, {})();
}

TEST(TrackedEstimator, IsReadFromItsYamlAndMapsWhatItSees) {
  const Standing standing;
  const auto estimator = fastSlam("{particle_amount: 7}");
  for (std::int64_t stamp_ns = 1; stamp_ns <= 3; ++stamp_ns)
    estimator->update(poles(stamp_ns),
                      motionStep(standing, stamp_ns == 1 ? 0 : stamp_ns - 1, stamp_ns), nullptr);
  EXPECT_EQ(estimator->stamp_ns(), 3);
  EXPECT_EQ(estimator->hypotheses().size(), 7u);
  EXPECT_EQ(estimator->landmarks().landmarks.size(), 4u);
  EXPECT_EQ(estimator->state(), "tracking");
  EXPECT_FALSE(estimator->health().empty());
}

TEST(TrackedEstimator, StatesWhyItIsLostAndShowsNoHypotheses) {
  const Standing standing;
  const auto estimator = fastSlam("{}");
  estimator->update(poles(1), motionStep(standing, 0, 1), nullptr);
  estimator->forgetPose();
  EXPECT_TRUE(estimator->isLost());
  EXPECT_EQ(estimator->state(), "a global localisation was requested");
  EXPECT_TRUE(estimator->hypotheses().empty());
}

}  // namespace
}  // namespace ram_slam
