// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/sensing/no_return.hpp"

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

TEST(NoReturnDetector, FindsTheReadingThatIsFarCommonerThanAnyOtherFarOne) {
  NoReturnDetector detector;
  for (int i = 0; i < 100; ++i)
    detector.add({1.0F, 2.0F, 6.0F + 0.02F * static_cast<float>(i), 81.83F, 81.83F});
  ASSERT_TRUE(detector.code_m());
  EXPECT_FLOAT_EQ(*detector.code_m(), 81.83F);
  EXPECT_LT(NoReturnDetector::limit_m(81.83F), 81.83F);
}

TEST(NoReturnDetector, FarWallThatScattersIsNoCode) {
  NoReturnDetector detector;
  for (int i = 0; i < 100; ++i) detector.add({1.0F, 20.0F + 0.01F * static_cast<float>(i % 7)});
  EXPECT_FALSE(detector.code_m());
}

TEST(NoReturnDetector, WithoutFarReadingsThereIsNoCode) {
  NoReturnDetector detector;
  detector.add({1.0F, 2.0F, 4.0F});
  EXPECT_FALSE(detector.code_m());
  EXPECT_FALSE(NoReturnDetector().code_m());
}

}  // namespace
}  // namespace ram_slam
