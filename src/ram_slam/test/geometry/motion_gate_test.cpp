// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/geometry/motion_gate.hpp"

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

constexpr MotionGate kGate{0.5, 0.25};

TEST(MotionGate, IsReachedByDistanceOrAngleAlone) {
  EXPECT_TRUE(kGate.isReachedBy({0.3, 0.4, 0.0}));  // 0.5 m in both axes together
  EXPECT_TRUE(kGate.isReachedBy({0.0, 0.0, -0.25}));
  EXPECT_FALSE(kGate.isReachedBy({0.4, 0.0, 0.2}));
}

TEST(MotionGate, IsExceededOnlyBeyondItsBounds) {
  EXPECT_FALSE(kGate.isExceededBy({0.3, 0.4, -0.25}));
  EXPECT_TRUE(kGate.isExceededBy({0.0, -0.51, 0.0}));
  EXPECT_TRUE(kGate.isExceededBy({0.0, 0.0, 0.26}));
}

TEST(MotionGate, OfZeroIsReachedByRestButNotExceeded) {
  EXPECT_TRUE(MotionGate{}.isReachedBy({}));
  EXPECT_FALSE(MotionGate{}.isExceededBy({}));
}

TEST(MotionGateTable, RowsTakeThePrefixOfTheirOwner) {
  struct Owner {
    MotionGate gate{0.5, 0.25};
  };
  const auto table = ram_parameters::ParameterTable<Owner>().include(
      &Owner::gate, motionGateTable("Between two scans."), "key_");
  const auto rows = table.rows();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].key, "key_distance_m");
  EXPECT_EQ(rows[0].value, "0.5");
  EXPECT_EQ(rows[1].key, "key_angle_rad");
  Owner owner;
  owner.gate.angle_rad = 0.0;
  EXPECT_THROW(table.check(owner), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
