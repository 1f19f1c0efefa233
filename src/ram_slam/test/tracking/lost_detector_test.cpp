// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/lost_detector.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

#include "rooms.hpp"

namespace ram_slam {
namespace {

/// Four known landmarks in the corners of the room, a particle in the middle.
class LostDetection : public testing::Test {
protected:
  LostDetection() {
    for (const Eigen::Vector2d& place_m : kCorners) {
      Feature feature;
      feature.type = "corner";
      LandmarkRecord& record = registry_.create(feature, nullptr);
      record.existence_log_odds = 5.0;
      record.seen_from = 0xffff;
      record.seen_within_m = 20.0;
      particle_.landmarks.set(record.id, {place_m, Eigen::Matrix2d::Identity() * 1e-4});
    }
    detector_.trustMap(0.0);
  }

  FeatureList seeing(const std::vector<Eigen::Vector2d>& places_m) {
    FeatureList list;
    list.stamp_ns = 1'000'000'000;
    for (const Eigen::Vector2d& place_m : places_m) {
      Feature feature;
      feature.type = "corner";
      feature.position_m = place_m;
      list.features.push_back(feature);
    }
    return list;
  }

  void look(const FeatureList& list, double path_m = 0.0) {
    detector_.add({list, view_.get(), particle_, registry_}, path_m);
  }

  const std::vector<Eigen::Vector2d> kCorners{{4.8, 2.8}, {4.8, -2.8}, {-4.8, 2.8}, {-4.8, -2.8}};
  LandmarkRegistry registry_;
  Particle particle_;
  std::shared_ptr<const LaserView> view_ = viewIn(rectangle(-5.0, -3.0, 5.0, 3.0), {});
  LostDetector detector_{LostDetectorParameters{}, 2.0};
};

TEST_F(LostDetection, IsContentWhereTheMapIsRight) {
  look(seeing(kCorners));
  EXPECT_EQ(detector_.agreement().found_count, 4);
  EXPECT_EQ(detector_.agreement().quality(), 1.0);
  EXPECT_FALSE(detector_.lost());
}

TEST_F(LostDetection, TakesOverlookedLandmarksAloneForNoProof) {
  particle_.proposal.pose = {};
  look(seeing({}));
  EXPECT_EQ(detector_.agreement().found_count, 0);
  EXPECT_FALSE(detector_.lost());
}

TEST_F(LostDetection, TakesNewFeaturesAloneForNoProof) {
  look(seeing({kCorners[0],
               kCorners[1],
               kCorners[2],
               kCorners[3],
               {1.0, 1.0},
               {2.0, -2.0},
               {-2.0, 0.0},
               {0.0, 2.0}}));
  EXPECT_EQ(detector_.agreement().unexplained_count, 4);
  EXPECT_FALSE(detector_.lost());
}

TEST_F(LostDetection, IsLostWhenNothingIsWhereItShouldBe) {
  particle_.landmarks = {};
  for (LandmarkId id = 0; id < 4; ++id)  // where the view shows empty space
    particle_.landmarks.set(id, {0.6 * kCorners[id], Eigen::Matrix2d::Identity() * 1e-4});
  look(seeing(kCorners));
  EXPECT_EQ(detector_.agreement().looked_through_count, 4);
  EXPECT_TRUE(detector_.lost());
}

TEST_F(LostDetection, ExpectsNothingOfLandmarksNotSeenForALongWay) {
  particle_.landmarks = {};
  for (LandmarkId id = 0; id < 4; ++id)
    particle_.landmarks.set(id, {0.6 * kCorners[id], Eigen::Matrix2d::Identity() * 1e-4});
  look(seeing(kCorners), 100.0);
  EXPECT_EQ(detector_.agreement().expected_count, 0);
  EXPECT_FALSE(detector_.lost());
}

TEST_F(LostDetection, ForgetsAfterItsWindow) {
  look(seeing(kCorners));
  FeatureList later = seeing({});
  later.stamp_ns += 3'000'000'000;
  detector_.add({later, nullptr, particle_, registry_}, 0.0);
  EXPECT_EQ(detector_.agreement().expected_count, 0);
}

TEST_F(LostDetection, NeedsLessEvidenceWhenSuspicious) {
  particle_.landmarks = {};
  for (LandmarkId id = 0; id < 2; ++id)
    particle_.landmarks.set(id, {0.6 * kCorners[id], Eigen::Matrix2d::Identity() * 1e-4});
  look(seeing({kCorners[0], kCorners[1]}));
  EXPECT_EQ(detector_.agreement().looked_through_count, 2);
  EXPECT_FALSE(detector_.lost());
  EXPECT_TRUE(detector_.lost(true));
}

TEST_F(LostDetection, CountsAFeatureThatNoLandmarkExplainsOncePerCell) {
  look(seeing({{1.1, 1.1}, {1.3, 1.4}, {1.6, 1.1}}));
  EXPECT_EQ(detector_.agreement().unexplained_count, 2);
}

TEST_F(LostDetection, MissesNoLandmarkWithoutAView) {
  detector_.add({seeing({}), nullptr, particle_, registry_}, 0.0);
  EXPECT_EQ(detector_.agreement().expected_count, 0);
}

TEST(MapAgreement, IsPerfectWhereNothingIsExpected) {
  EXPECT_EQ(MapAgreement{}.quality(), 1.0);
  MapAgreement agreement;
  agreement.expected_count = 4;
  agreement.found_count = 1;
  EXPECT_EQ(agreement.quality(), 0.25);
}

TEST(LostDetectorParameters, RefuseAShareAboveOne) {
  LostDetectorParameters parameters;
  parameters.lost_below = 1.1;
  EXPECT_THROW(LostDetector(parameters, 2.0), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
