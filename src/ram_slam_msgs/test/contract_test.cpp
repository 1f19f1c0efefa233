// SPDX-License-Identifier: BSD-3-Clause
// The MD5 sums are the wire contract: a change here breaks every recorded bag. The first five are
// the report's.
#include <string>

#include <gtest/gtest.h>
#include <ram_slam_msgs/Feature.h>
#include <ram_slam_msgs/FeatureList.h>
#include <ram_slam_msgs/GetDrawnMap.h>
#include <ram_slam_msgs/KeyScan.h>
#include <ram_slam_msgs/LidarCalibration.h>
#include <ram_slam_msgs/PredictState.h>
#include <ram_slam_msgs/PredictStateWithCovariance.h>
#include <ram_slam_msgs/SampleState.h>
#include <ram_slam_msgs/Tracking.h>

namespace {

template <typename Message>
std::string md5() {
  return ros::message_traits::MD5Sum<Message>::value();
}

template <typename Service>
std::string serviceMd5() {
  return ros::service_traits::MD5Sum<Service>::value();
}

TEST(Contract, FeatureKeepsItsMd5Sum) {
  EXPECT_EQ(md5<ram_slam_msgs::Feature>(), "9941a1ecc4269eefab0095802b8620ef");
}

TEST(Contract, FeatureListKeepsItsMd5Sum) {
  EXPECT_EQ(md5<ram_slam_msgs::FeatureList>(), "b85dba6de7ee98b53d441be0ce2335d6");
}

TEST(Contract, PredictStateKeepsItsMd5Sum) {
  EXPECT_EQ(serviceMd5<ram_slam_msgs::PredictState>(), "a3589a915e54a61da00fe84456f6b822");
}

TEST(Contract, PredictStateWithCovarianceKeepsItsMd5Sum) {
  EXPECT_EQ(serviceMd5<ram_slam_msgs::PredictStateWithCovariance>(),
            "d68fe168d262488af6a274b8c28fd6d7");
}

TEST(Contract, SampleStateKeepsItsMd5Sum) {
  EXPECT_EQ(serviceMd5<ram_slam_msgs::SampleState>(), "a3589a915e54a61da00fe84456f6b822");
}

TEST(Contract, KeyScanKeepsItsMd5Sum) {
  EXPECT_EQ(md5<ram_slam_msgs::KeyScan>(), "fd667c3f904a987840977b4a10931c08");
}

TEST(Contract, TrackingKeepsItsMd5Sum) {
  EXPECT_EQ(md5<ram_slam_msgs::Tracking>(), "c093e8b98e5537d23768b2ef6ab13071");
}

TEST(Contract, GetDrawnMapKeepsItsMd5Sum) {
  EXPECT_EQ(serviceMd5<ram_slam_msgs::GetDrawnMap>(), "62933b88692252ff2d852e2ef2a8d9bf");
}

TEST(Contract, LidarCalibrationKeepsItsMd5Sum) {
  EXPECT_EQ(md5<ram_slam_msgs::LidarCalibration>(), "e56a68d1627ab812765f8f7c50ddde9c");
}

TEST(Contract, MessagesWithAHeaderSaySo) {
  EXPECT_TRUE(ros::message_traits::hasHeader<ram_slam_msgs::Feature>());
  EXPECT_TRUE(ros::message_traits::hasHeader<ram_slam_msgs::FeatureList>());
}

}  // namespace
