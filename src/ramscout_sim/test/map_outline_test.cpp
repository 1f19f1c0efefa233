// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "ramscout_sim/map_image.hpp"
#include "ramscout_sim/random.hpp"

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

/// Twice the signed area inside a polygon, positive if it is walked counter-clockwise.
double shoelace(const std::vector<Eigen::Vector2d>& polygon) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum;
}

MapImage randomMap(std::uint64_t seed) {
  Random random(1, Stream::kBuilding, seed);
  std::vector<std::string> rows(12, std::string(17, '.'));
  for (std::string& row : rows)
    for (char& cell : row) cell = random.uniform() < 0.45 ? '#' : '.';
  return drawn(rows, 0.5);
}

TEST(Outlines, EncloseTheAreaOfTheOccupiedCells) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const MapImage map = randomMap(seed);
    double twice_m2 = 0.0;  // holes are walked clockwise and count negative
    for (const auto& outline : outlinesOf(map, 0.0)) twice_m2 += shoelace(outline);
    const auto occupied = std::count(map.cells.begin(), map.cells.end(), Cell::kOccupied);
    EXPECT_NEAR(0.5 * twice_m2, 0.25 * static_cast<double>(occupied), 1e-9) << seed;
  }
}

TEST(Outlines, AreAsLongAsTheSidesBetweenOccupiedAndOtherCells) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const MapImage map = randomMap(seed);
    const auto occupied = [&](int x, int y) {
      return x >= 0 && y >= 0 && x < map.width_cells && y < map.height_cells &&
             map.at(x, y) == Cell::kOccupied;
    };
    int sides = 0;
    for (int y = -1; y < map.height_cells; ++y) {
      for (int x = -1; x < map.width_cells; ++x) {
        sides += occupied(x, y) != occupied(x + 1, y) ? 1 : 0;
        sides += occupied(x, y) != occupied(x, y + 1) ? 1 : 0;
      }
    }
    double length_m = 0.0;
    for (const auto& outline : outlinesOf(map, 0.0)) {
      for (std::size_t i = 0; i < outline.size(); ++i)
        length_m += (outline[(i + 1) % outline.size()] - outline[i]).norm();
    }
    EXPECT_NEAR(length_m, 0.5 * sides, 1e-9) << seed;
  }
}

TEST(Outlines, LieInTheWorldWhereTheMapLies) {
  MapImage map = drawn({"#"}, 2.0);
  map.world_from_map = {10.0, -5.0, M_PI_2};  // x of the map points along y of the world
  const auto outlines = outlinesOf(map, 0.0);
  ASSERT_EQ(outlines.size(), 1u);
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : outlines[0]) middle += 0.25 * corner;
  EXPECT_NEAR(middle.x(), 9.0, 1e-12);
  EXPECT_NEAR(middle.y(), -4.0, 1e-12);
  EXPECT_NEAR(shoelace(outlines[0]), 2.0 * 4.0, 1e-9) << "still with the cell on the left";
}

TEST(ExtrudeOutlines, MakesTwoTrianglesForEachSideAndHitsNoRobot) {
  const Solid walls = extrudeOutlines(drawn({"......", ".####.", "......"}, 0.5), 2.5, 0.75);
  ASSERT_TRUE(walls.mesh);
  EXPECT_FALSE(walls.solid);
  EXPECT_EQ(walls.mesh->vertices_m.size(), 8u);
  EXPECT_EQ(walls.mesh->triangles.size(), 8u);
  double area_m2 = 0.0;
  for (const auto& triangle : walls.mesh->triangles) {
    const Eigen::Vector3f& a = walls.mesh->vertices_m[triangle[0]];
    area_m2 += 0.5 * static_cast<double>((walls.mesh->vertices_m[triangle[1]] - a)
                                             .cross(walls.mesh->vertices_m[triangle[2]] - a)
                                             .norm());
  }
  EXPECT_NEAR(area_m2, 2.0 * (2.0 + 0.5) * 2.5, 1e-5);  // perimeter by height
}

}  // namespace
}  // namespace ramscout_sim
