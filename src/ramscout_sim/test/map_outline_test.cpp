// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "ramscout_sim/map_image.hpp"

namespace ramscout_sim {
namespace {

MapImage drawn(const std::vector<std::string>& rows_from_the_top, double resolution_m) {
  MapImage map;
  map.width_cells = static_cast<int>(rows_from_the_top[0].size());
  map.height_cells = static_cast<int>(rows_from_the_top.size());
  map.resolution_m = resolution_m;
  for (auto row = rows_from_the_top.rbegin(); row != rows_from_the_top.rend(); ++row) {
    for (const char cell : *row) map.cells.push_back(cell == '#' ? Cell::kOccupied : Cell::kFree);
  }
  return map;
}

TEST(Outlines, OfARectangleAreItsFourCorners) {
  const auto outlines = outlinesOf(drawn({"......", ".####.", ".####.", "......"}, 0.5), 0.75);
  ASSERT_EQ(outlines.size(), 1u);
  EXPECT_THAT(outlines[0], ::testing::UnorderedElementsAre(
                               Eigen::Vector2d(0.5, 0.5), Eigen::Vector2d(2.5, 0.5),
                               Eigen::Vector2d(2.5, 1.5), Eigen::Vector2d(0.5, 1.5)));
}

TEST(Outlines, HaveOneLoopForEachHoleAndForCellsThatOnlyTouch) {
  EXPECT_EQ(outlinesOf(drawn({"#####", "#...#", "#####"}, 1.0), 0.75).size(), 2u);
  EXPECT_EQ(outlinesOf(drawn({"#.", ".#"}, 1.0), 0.75).size(), 2u);
  EXPECT_EQ(outlinesOf(drawn({"...", "..."}, 1.0), 0.75).size(), 0u);
}

TEST(Outlines, MakeOneLineOfAStaircaseAndStayWithinTheTolerance) {
  constexpr int kSide = 60;
  std::vector<std::string> rows(kSide, std::string(kSide, '.'));
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      if (x + 2 * y < 100 && x > 3 && y > 3)
        rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = '#';
    }
  }
  const MapImage map = drawn(rows, 1.0);
  const auto exact = outlinesOf(map, 0.0);
  const auto simple = outlinesOf(map, 1.0);
  ASSERT_EQ(simple.size(), 1u);
  EXPECT_GT(exact[0].size(), 50u);
  EXPECT_LE(simple[0].size(), 6u);
  for (const Eigen::Vector2d& corner : exact[0]) {
    double nearest = 1e9;
    for (std::size_t i = 0; i < simple[0].size(); ++i) {
      const Eigen::Vector2d& a = simple[0][i];
      const Eigen::Vector2d along = simple[0][(i + 1) % simple[0].size()] - a;
      const double share =
          std::max(0.0, std::min(1.0, (corner - a).dot(along) / along.squaredNorm()));
      nearest = std::min(nearest, (corner - a - share * along).norm());
    }
    EXPECT_LE(nearest, 1.0 + 1e-9);
  }
}

}  // namespace
}  // namespace ramscout_sim
