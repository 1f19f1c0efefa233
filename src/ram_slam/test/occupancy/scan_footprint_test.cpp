// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/occupancy/scan_footprint.hpp"

#include <set>
#include <utility>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

using Cells = std::set<std::pair<int, int>>;

struct Traced {
  Cells free;
  Cells hit;
};

Traced trace(const Eigen::Vector2d& sensor, const std::vector<Beam>& beams) {
  const ScanFootprint footprint(sensor, beams, ScanFootprint::boxOf(sensor, beams));
  Traced traced;
  for (int y = footprint.box().begin.y; y < footprint.box().end.y; ++y) {
    for (int x = footprint.box().begin.x; x < footprint.box().end.x; ++x) {
      for (int cell = 0; cell < kTileCells * kTileCells; ++cell) {
        const int row = cell / kTileCells;
        const int column = cell % kTileCells;
        const std::pair<int, int> index(x * kTileCells + column, y * kTileCells + row);
        if (footprint.freeRow({x, y}, row) >> column & 1U) traced.free.insert(index);
        if (footprint.hitRow({x, y}, row) >> column & 1U) traced.hit.insert(index);
      }
    }
  }
  return traced;
}

Beam hitAt(double x, double y, double free_x, double free_y) {
  return {{x, y}, {free_x, free_y}, true};
}

TEST(ScanFootprint, ABeamAlongARowFreesTheCellsBeforeItsEnd) {
  const Traced traced = trace({0.5, 0.5}, {hitAt(4.5, 0.5, 4.1, 0.5)});
  EXPECT_EQ(traced.free, (Cells{{0, 0}, {1, 0}, {2, 0}, {3, 0}}));
  EXPECT_EQ(traced.hit, (Cells{{4, 0}}));
}

TEST(ScanFootprint, ABeamBackwardsFreesTheSameNumberOfCells) {
  const Traced traced = trace({0.5, 0.5}, {hitAt(-3.5, 0.5, -3.1, 0.5)});
  EXPECT_EQ(traced.free, (Cells{{0, 0}, {-1, 0}, {-2, 0}, {-3, 0}}));
  EXPECT_EQ(traced.hit, (Cells{{-4, 0}}));
}

TEST(ScanFootprint, ASteepBeamFreesEveryCellThatItCrosses) {
  // From (0.5, 0.5) to (1.5, 2.5): crosses x = 1 at y = 1.5.
  Beam beam;
  beam.free_end = {1.5, 2.5};
  EXPECT_EQ(trace({0.5, 0.5}, {beam}).free, (Cells{{0, 0}, {0, 1}, {1, 1}}));
}

TEST(ScanFootprint, BeamsCrossTheBordersOfTiles) {
  const Traced traced = trace({60.5, 0.5}, {hitAt(200.5, 0.5, 200.1, 0.5)});
  EXPECT_EQ(traced.free.size(), 140U);
  EXPECT_EQ(traced.hit, (Cells{{200, 0}}));
}

TEST(ScanFootprint, AHitWinsOverAnotherBeamThatPasses) {
  Beam passing;
  passing.free_end = {6.5, 0.5};
  const Traced traced = trace({0.5, 0.5}, {hitAt(3.5, 0.5, 3.1, 0.5), passing});
  EXPECT_EQ(traced.hit, (Cells{{3, 0}}));
  EXPECT_EQ(traced.free.count({3, 0}), 0U);
  EXPECT_EQ(traced.free.count({5, 0}), 1U);
}

TEST(TileBox, JoinsToTheSmallestBoxOfBoth) {
  const TileBox empty;
  const TileBox left{{-2, 0}, {0, 1}};
  const TileBox right{{1, -1}, {2, 3}};
  EXPECT_TRUE(empty.empty());
  EXPECT_EQ(empty.cellCount(), 0.0);
  EXPECT_TRUE(empty.joined(left) == left);
  EXPECT_TRUE(left.joined(empty) == left);
  EXPECT_TRUE((left.joined(right) == TileBox{{-2, -1}, {2, 3}}));
  EXPECT_EQ(left.joined(right).cellCount(), 16.0 * kTileCells * kTileCells);
}

TEST(ScanFootprint, BoxHoldsTheSensorAndTheEndsOfBeams) {
  Beam beam;
  beam.free_end = {-1.0, 130.0};
  EXPECT_TRUE((ScanFootprint::boxOf({1.0, 1.0}, {beam}) == TileBox{{-1, 0}, {1, 3}}));
}

}  // namespace
}  // namespace ram_slam
