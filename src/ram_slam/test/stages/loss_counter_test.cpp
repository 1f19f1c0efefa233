// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/loss_counter.hpp"

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

TEST(LossCounter, CountsMessagesThatAQueueLost) {
  LossCounter messages;
  for (const std::uint32_t number : {7u, 8u, 9u, 15u, 16u}) messages.add("/lidar", number);
  EXPECT_EQ(messages.received(), 5u);
  EXPECT_EQ(messages.lost(), 5u);
}

TEST(LossCounter, EachPublisherHasItsOwnNumbersAndMayBeginAgain) {
  LossCounter messages;
  messages.add("/a", 100);
  messages.add("/b", 3);
  messages.add("/a", 101);
  messages.add("/a", 0);  // was started again
  messages.add("/a", 0);  // does not count
  messages.add("/b", 0xffffffff);
  EXPECT_EQ(messages.lost(), 0u);
}

TEST(DropShare, IsThatOfTheTimeSinceTheCallBefore) {
  DropShare drops;
  drops.update(100, 0, 0);
  EXPECT_EQ(drops.share(), 0.0);
  drops.update(130, 10, 20);  // 40 were sent, 10 lost, 20 dropped
  EXPECT_DOUBLE_EQ(drops.share(), 0.75);
  drops.update(170, 10, 20);
  EXPECT_EQ(drops.share(), 0.0);
  drops.update(170, 10, 21);  // one that had waited
  EXPECT_EQ(drops.share(), 1.0);
}

}  // namespace
}  // namespace ram_slam
