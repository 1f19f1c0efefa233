// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/fast_slam_node_parameters.hpp"

#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "../parameter_text.hpp"

namespace ram_slam {
namespace {

FastSlamNodeParameters read(const std::string& yaml) {
  return readText(readFastSlamNodeParameters, yaml);
}

std::string refusalOf(const std::string& yaml) {
  return refusalOfText(readFastSlamNodeParameters, yaml);
}

TEST(FastSlamNodeParameters, AreTheDefaultsInTheShippedFile) {
  expectDefaultsIn("fast_slam.yaml", readFastSlamNodeParameters);
}

TEST(FastSlamNodeParameters, AreReadFromTheSectionNode) {
  const FastSlamNodeParameters p = read(
      "{node: {estimator: other, map_frame: world, odom_frame: wheels, base_frame: robot, "
      "feature_topics: [a, b], use_scan: false, initial_map: office.world, "
      "checkpoint_period: 3.0, gap_bridge: {drift_mps: 0.5}}}");
  EXPECT_EQ(p.estimator, "other");
  EXPECT_EQ(p.frames.map, "world");
  EXPECT_EQ(p.frames.odom, "wheels");
  EXPECT_EQ(p.frames.base, "robot");
  EXPECT_THAT(p.feature_topics, testing::ElementsAre("a", "b"));
  EXPECT_FALSE(p.use_scan);
  EXPECT_EQ(p.initial_map, "office.world");
  EXPECT_EQ(p.checkpoint_period, 3.0);
  EXPECT_EQ(p.readings.gap_bridge.drift_mps, 0.5);
}

TEST(FastSlamNodeParameters, NameTheSectionOfWhatIsRefused) {
  EXPECT_THAT(refusalOf("{node: {feature_topics: []}}"),
              testing::HasSubstr("node/feature_topics must be"));
  EXPECT_THAT(refusalOf("{node: {output_period: -1.0}}"),
              testing::HasSubstr("node/output_period must be"));
  EXPECT_THAT(refusalOf("{node: {checkpoint_period: 0.0}}"),
              testing::HasSubstr("node/checkpoint_period must be"));
  EXPECT_THAT(refusalOf("{node: {odom_frame: map}}"),
              testing::HasSubstr("node/odom_frame must be another frame than map_frame"));
  EXPECT_THAT(refusalOf("{node: {base_frame: odom}}"),
              testing::HasSubstr("node/base_frame must be another frame"));
  EXPECT_THAT(refusalOf("{node: {map_fram: map}}"), testing::HasSubstr("map_frame"));
}

TEST(FastSlamNodeParameters, OfExpertsAreInSections) {
  const FastSlamNodeParameters p = read(
      "{node: {logged_correction_distance_m: 0.5, waiting: {queue_size: 7, motion_s: 2.0}, "
      "map_to_odom: {period_s: 0.02}, markers: {height_m: 0.1}}}");
  EXPECT_EQ(p.logged_correction.distance_m, 0.5);
  EXPECT_EQ(p.waiting.queue_size, 7);
  EXPECT_EQ(p.waiting.motion_s, 2.0);
  EXPECT_EQ(p.map_to_odom.period_s, 0.02);
  EXPECT_EQ(p.markers.height_m, 0.1);
  EXPECT_THAT(refusalOf("{node: {waiting: {queue_size: 0}}}"),
              testing::HasSubstr("node/waiting/queue_size must be"));
}

}  // namespace
}  // namespace ram_slam
