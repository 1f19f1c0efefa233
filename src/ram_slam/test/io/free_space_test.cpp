// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/io/free_space.hpp"

#include <limits>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

TEST(FreeSpace, AFolderWithEnoughSpaceIsNoProblem) {
  EXPECT_EQ(freeSpaceProblem("/", 1), "");
}

TEST(FreeSpace, TooLittleIsReportedWithTheFolder) {
  EXPECT_THAT(
      freeSpaceProblem("/", std::numeric_limits<std::uint64_t>::max()),
      testing::AllOf(testing::HasSubstr("disk of / is full"), testing::HasSubstr("remove")));
}

TEST(FreeSpace, OfAFolderThatDoesNotExistYetIsThatAboveIt) {
  EXPECT_NE(freeSpaceProblem("/no/such/folder", std::numeric_limits<std::uint64_t>::max()), "");
}

}  // namespace
}  // namespace ram_slam
