// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ros/conversions.hpp"

#include <limits>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

namespace ram_slam_ros {
namespace {

ram_slam::Feature exampleFeature() {
  ram_slam::Feature feature;
  feature.type = "corner";
  feature.classifier = "pg1:abc";
  feature.position_m = {1.5, -2.25};
  feature.covariance_m2 << 0.01, 0.002, 0.002, 0.03;
  feature.orientation_rad = 0.5;
  feature.orientation_variance_rad2 = 0.04;
  return feature;
}

TEST(Conversions, TimeRoundTripIsExact) {
  const std::int64_t stamp_ns = 1700000000123456789;
  EXPECT_EQ(toNanoseconds(toTime(stamp_ns)), stamp_ns);
  EXPECT_TRUE(toTime(-1).isZero());
}

TEST(Conversions, PoseRoundTrip) {
  const ram_slam::Pose2 pose{1.0, -2.0, 3.0};
  const ram_slam::Pose2 back = toPose2(toPoseMessage(pose));
  EXPECT_DOUBLE_EQ(back.x_m, pose.x_m);
  EXPECT_DOUBLE_EQ(back.y_m, pose.y_m);
  EXPECT_NEAR(back.yaw_rad, pose.yaw_rad, 1e-15);
}

TEST(Conversions, CovarianceKeepsItsPlaces) {
  ram_slam::PoseWithCovariance2 pose;
  pose.covariance << 1, 2, 3, 2, 4, 5, 3, 5, 6;
  const auto message = toPoseWithCovarianceMessage(pose);
  EXPECT_EQ(message.covariance[0], 1.0);
  EXPECT_EQ(message.covariance[5], 3.0);
  EXPECT_EQ(message.covariance[35], 6.0);
  EXPECT_EQ(message.covariance[14], 1e6);
  EXPECT_EQ(toPoseWithCovariance2(message).covariance, pose.covariance);
}

TEST(Conversions, LidarCalibrationIsSentAndChecked) {
  ram_slam_msgs::LidarCalibration message = toLidarMessage(ram_slam::LidarCalibration());
  EXPECT_EQ(toAddedMirrorTurn_s(message), 0.0);
  message.turn_time = -0.04;
  EXPECT_EQ(toAddedMirrorTurn_s(message), -0.04);
  for (const double impossible : {2.0, -2.0, std::numeric_limits<double>::quiet_NaN()}) {
    message.turn_time = impossible;
    EXPECT_THROW(toAddedMirrorTurn_s(message), std::invalid_argument);
  }
}

TEST(Conversions, FeatureListRoundTrip) {
  ram_slam::FeatureList list;
  list.stamp_ns = 42;
  list.features = {exampleFeature(), exampleFeature()};
  const CheckedFeatures back = toFeatureList(toFeatureListMessage(list, "base_link"), "base_link");
  ASSERT_EQ(back.list.features.size(), 2u);
  EXPECT_EQ(back.rejected_count, 0);
  EXPECT_EQ(back.list.stamp_ns, 42);
  EXPECT_EQ(back.list.features[1].classifier, "pg1:abc");
  EXPECT_EQ(back.list.features[1].covariance_m2, exampleFeature().covariance_m2);
}

TEST(Conversions, AFeatureKeepsTheStampOfItsOwn) {
  ram_slam::FeatureList list;
  list.stamp_ns = 5'000'000'000;
  list.features = {exampleFeature(), exampleFeature(), exampleFeature()};
  list.features[0].delay_ns = 7'000'000;
  auto message = toFeatureListMessage(list, "base_link");
  EXPECT_EQ(toNanoseconds(message.features[0].header.stamp), 5'007'000'000);
  message.features[1].header.stamp = ros::Time();  // then the list's counts
  message.features[2].header.stamp = ros::Time(7, 0);
  const CheckedFeatures back = toFeatureList(message, "base_link");
  ASSERT_EQ(back.list.features.size(), 2u);
  EXPECT_EQ(back.list.features[0].delay_ns, 7'000'000);
  EXPECT_EQ(back.list.features[1].delay_ns, 0);
  EXPECT_EQ(back.rejected_count, 1);
}

TEST(Features, SeenLaterAreMovedToTheStampOfTheirList) {
  const ram_slam::Pose2 motion = ram_slam::exponential({0.1, 0.0, 0.2});  // in 0.1 s
  const ram_slam::Pose2 later = ram_slam::exponential({0.02, 0.0, 0.04});
  ram_slam::FeatureList list;
  list.stamp_ns = 1;
  list.features = {exampleFeature()};
  const Eigen::Vector2d deskewed_m = later * exampleFeature().position_m;
  list.features[0].delay_ns = 20'000'000;
  const ram_slam::Feature moved = ram_slam::deskew(list, motion, 100'000'000).features.front();
  EXPECT_LT((moved.position_m - deskewed_m).norm(), 1e-12);
  EXPECT_NEAR(moved.orientation_rad, exampleFeature().orientation_rad + 0.04, 1e-12);
  EXPECT_EQ(moved.delay_ns, 0);
  const ram_slam::Feature kept = ram_slam::deskew(list, motion, 0).features.front();
  EXPECT_EQ(kept.position_m, exampleFeature().position_m);
}

TEST(Conversions, BadFeaturesAreLeftOutAndCounted) {
  ram_slam::FeatureList list;
  list.stamp_ns = 42;
  list.features = std::vector<ram_slam::Feature>(7, exampleFeature());
  auto message = toFeatureListMessage(list, "base_link");
  message.features[0].pose.pose.position.x = std::numeric_limits<double>::quiet_NaN();
  message.features[1].pose.pose.orientation.w = 0.0;
  message.features[1].pose.pose.orientation.z = 0.0;
  message.features[2].pose.covariance.fill(0.0);
  message.features[3].pose.covariance[1] = 0.5;
  message.features[4].pose.covariance[35] = -1e-3;
  message.features[5].pose.covariance[35] = 0.0;
  const CheckedFeatures checked = toFeatureList(message, "base_link");
  EXPECT_EQ(checked.list.features.size(), 1u);
  EXPECT_EQ(checked.rejected_count, 6);
}

TEST(Conversions, FeaturesAsFarOffAsStarsOrAsUncertainAreLeftOutAndCounted) {
  ram_slam::FeatureList list;
  list.stamp_ns = 42;
  list.features = std::vector<ram_slam::Feature>(5, exampleFeature());
  auto message = toFeatureListMessage(list, "base_link");
  message.features[0].pose.pose.position.x = 1e160;
  message.features[1].pose.pose.position.y = -5000.0;
  message.features[2].pose.covariance[0] = message.features[2].pose.covariance[7] = 1e150;
  message.features[3].pose.covariance[35] = 1e200;
  const CheckedFeatures checked = toFeatureList(message, "base_link");
  EXPECT_EQ(checked.list.features.size(), 1u);
  EXPECT_EQ(checked.rejected_count, 4);
}

TEST(Conversions, APoseBeyondAllMapsOrOfMonstrousUncertaintyIsRefused) {
  EXPECT_NO_THROW(toPose2(toPoseMessage({5e5, 6e6, 0.5})));  // of UTM
  EXPECT_THROW(toPose2(toPoseMessage({1e300, 0.0, 0.0})), std::invalid_argument);
  EXPECT_THROW(toPose2(toPoseMessage({0.0, -1e9, 0.0})), std::invalid_argument);
  auto uncertain = toPoseWithCovarianceMessage({});
  uncertain.covariance[0] = 1e150;
  EXPECT_THROW(toPoseWithCovariance2(uncertain), std::invalid_argument);
}

TEST(Conversions, FeaturesBeyondTheMostThatAreTakenAreCounted) {  // fault F122
  ram_slam::FeatureList list;
  list.stamp_ns = 42;
  list.features = std::vector<ram_slam::Feature>(100'000, exampleFeature());
  const CheckedFeatures checked =
      toFeatureList(toFeatureListMessage(list, "base_link"), "base_link");
  EXPECT_GT(checked.list.features.size(), 100U);
  EXPECT_EQ(checked.list.features.size() + static_cast<std::size_t>(checked.rejected_count),
            100'000U);
  EXPECT_GT(checked.rejected_count, 0);
}

TEST(Conversions, AClassifierThatIsTooLongIsTakenForNone) {  // fault F124
  ram_slam_msgs::Feature message = toFeatureMessage(exampleFeature(), std_msgs::Header());
  message.classifier = std::string(1'000'000, 'x');
  EXPECT_EQ(toFeature(message).classifier, "");
  message.classifier = std::string("\xff\xfe\0\x80", 4);  // no UTF-8: bytes like others
  EXPECT_EQ(toFeature(message).classifier, message.classifier);
}

TEST(Conversions, AListWithoutAStampIsRefusedWhateverStampsItsFeaturesHave) {  // fault F125
  ram_slam::FeatureList list;
  list.stamp_ns = 42;
  list.features = {exampleFeature()};
  ram_slam_msgs::FeatureList message = toFeatureListMessage(list, "base_link");
  message.header.stamp = ros::Time();
  EXPECT_FALSE(message.features[0].header.stamp.isZero());
  EXPECT_THROW(toFeatureList(message, "base_link"), std::invalid_argument);
}

TEST(Conversions, FeaturesOfAnotherFrameAreRefused) {
  ram_slam::FeatureList list;
  list.stamp_ns = 42;
  EXPECT_THROW(toFeatureList(toFeatureListMessage(list, "laser"), "base_link"),
               std::invalid_argument);
}

TEST(Conversions, ScanThatIsOfNoUseIsRefused) {
  sensor_msgs::LaserScan good;
  good.header.stamp = ros::Time(1, 0);
  good.angle_increment = 0.01F;
  good.range_max = 10.0F;
  good.ranges.resize(10, 1.0F);
  good.time_increment = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(toLaserScan(good).time_increment_s, 0.0);

  sensor_msgs::LaserScan bad = good;
  bad.header.stamp = ros::Time();
  EXPECT_THROW(toLaserScan(bad), std::invalid_argument);
  bad = good;
  bad.ranges.clear();
  EXPECT_THROW(toLaserScan(bad), std::invalid_argument);
  bad = good;
  bad.angle_increment = 0.0F;
  EXPECT_THROW(toLaserScan(bad), std::invalid_argument);
  bad.ranges.resize(1);
  for (const float increment_rad : {1e30F, -1e30F, 100.0F}) {
    bad.angle_increment = increment_rad;
    EXPECT_THROW(toLaserScan(bad), std::invalid_argument) << increment_rad;
  }
  bad.angle_increment = 0.01F;
  bad.angle_min = 1e30F;
  EXPECT_THROW(toLaserScan(bad), std::invalid_argument);
  bad = good;
  bad.range_min = 20.0F;
  EXPECT_THROW(toLaserScan(bad), std::invalid_argument);
  bad.range_min = -1.0F;
  EXPECT_THROW(toLaserScan(bad), std::invalid_argument);
  bad = good;
  bad.ranges.resize(1000000);
  EXPECT_THROW(toLaserScan(bad), std::invalid_argument);
}

sensor_msgs::LaserScan exampleScan() {
  sensor_msgs::LaserScan message;
  message.header.stamp = ros::Time(1, 5);
  message.angle_min = -1.5F;
  message.angle_increment = 0.25F;
  message.time_increment = 0.001F;
  message.range_min = 0.1F;
  message.range_max = 10.0F;
  message.ranges = {1.0F, 5.0F, 9.999F, 10.0F, 12.0F};
  return message;
}

TEST(Conversions, AScanKeepsItsGeometryAndItsReadings) {
  const ram_slam::LaserScan scan = toLaserScan(exampleScan());
  EXPECT_EQ(scan.stamp_ns, 1'000'000'005);
  EXPECT_EQ(scan.angle_min_rad, -1.5);
  EXPECT_EQ(scan.angle_increment_rad, 0.25);
  EXPECT_FLOAT_EQ(static_cast<float>(scan.time_increment_s), 0.001F);
  EXPECT_EQ(scan.range_min_m, 0.1F);
  EXPECT_EQ(scan.ranges_m[1], 5.0F);
}

TEST(Conversions, ReadingsAtTheLimitMeanThatNothingCameBack) {
  const ram_slam::LaserScan scan = toLaserScan(exampleScan());
  EXPECT_EQ(scan.at(1), ram_slam::Return::kHit);
  for (const std::size_t beam : {2u, 3u, 4u})  // 9.999 m is the limit in millimetres
    EXPECT_EQ(scan.at(beam), ram_slam::Return::kNothing) << beam;
  EXPECT_EQ(countAtLimit(exampleScan()), 3u);
}

TEST(Conversions, ADriverThatNamesNoLimitHasNone) {
  for (const float limit_m : {0.0F, 1e6F, std::numeric_limits<float>::infinity()}) {
    sensor_msgs::LaserScan message = exampleScan();
    message.range_max = limit_m;
    const ram_slam::LaserScan scan = toLaserScan(message);
    EXPECT_EQ(scan.range_max_m, ram_slam::LaserScan::kUnlimitedRangeM) << limit_m;
    EXPECT_EQ(scan.at(4), ram_slam::Return::kHit);
    EXPECT_EQ(countAtLimit(message), 0u);
  }
}

TEST(Conversions, AReadingOfZeroIsNoHit) {
  sensor_msgs::LaserScan message = exampleScan();
  message.range_min = 0.0F;
  message.ranges[0] = 0.0F;
  EXPECT_NE(toLaserScan(message).at(0), ram_slam::Return::kHit);
}

TEST(Conversions, ASweepIsPlausibleUpToASecond) {
  EXPECT_FALSE(isPlausibleSweep(0.0));
  EXPECT_FALSE(isPlausibleSweep(-0.1));
  EXPECT_TRUE(isPlausibleSweep(1.0));
  EXPECT_FALSE(isPlausibleSweep(1.001));
  sensor_msgs::LaserScan message = exampleScan();
  message.time_increment = 0.3F;  // 1.5 s for all five
  EXPECT_EQ(toLaserScan(message).time_increment_s, 0.0);
}

TEST(Conversions, PosesThatAreNoPosesAreRefused) {
  geometry_msgs::Pose pose = toPoseMessage({1.0, 2.0, 0.5});
  pose.orientation.w *= 2.0;
  EXPECT_THROW(toPose2(pose), std::invalid_argument);
  pose = toPoseMessage({std::numeric_limits<double>::infinity(), 2.0, 0.5});
  EXPECT_THROW(toPose2(pose), std::invalid_argument);
  geometry_msgs::PoseWithCovariance uncertain;
  uncertain.pose = toPoseMessage({});
  uncertain.covariance[35] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(toPoseWithCovariance2(uncertain), std::invalid_argument);
  uncertain.covariance[35] = 0.0;
  uncertain.covariance[14] = std::numeric_limits<double>::quiet_NaN();  // of z: not planar
  EXPECT_NO_THROW(toPoseWithCovariance2(uncertain));
}

TEST(Conversions, OdometryOfOtherFramesIsRefusedWithTheNamesOfAll) {
  nav_msgs::Odometry odometry;
  EXPECT_NO_THROW(requireFrames(odometry, "odom", "base_link")) << "without names";
  odometry.header.frame_id = "odom";
  odometry.child_frame_id = "base_link";
  EXPECT_NO_THROW(requireFrames(odometry, "odom", "base_link"));
  odometry.header.frame_id = "odom_combined";
  EXPECT_THAT([&] { requireFrames(odometry, "odom", "base_link"); },
              testing::ThrowsMessage<std::invalid_argument>(
                  testing::AllOf(testing::HasSubstr("'base_link' in 'odom_combined', wanted "),
                                 testing::HasSubstr("set odom_frame"))));
  odometry.header.frame_id = "odom";
  odometry.child_frame_id = "base_footprint";
  EXPECT_THROW(requireFrames(odometry, "odom", "base_link"), std::invalid_argument);
}

TEST(Conversions, TheYawOfATiltedPoseIsThatOfItsAxisInThePlane) {
  // Yaw 0.6 after a roll of 0.2: x is turned by the yaw alone.
  const Eigen::Quaterniond q = Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX());
  geometry_msgs::Transform transform;
  transform.rotation.x = q.x();
  transform.rotation.y = q.y();
  transform.rotation.z = q.z();
  transform.rotation.w = q.w();
  EXPECT_NEAR(toPose2(transform).yaw_rad, 0.6, 1e-12);
}

TEST(Conversions, TransformRoundTrip) {
  const ram_slam::Pose2 pose{-4.0, 0.25, -2.5};
  const ram_slam::Pose2 back = toPose2(toTransformMessage(pose));
  EXPECT_EQ(back.x_m, -4.0);
  EXPECT_EQ(back.y_m, 0.25);
  EXPECT_NEAR(back.yaw_rad, -2.5, 1e-15);
}

}  // namespace
}  // namespace ram_slam_ros
