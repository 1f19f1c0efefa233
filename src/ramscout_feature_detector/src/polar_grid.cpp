// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/polar_grid.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>

#include "ram_slam/geometry/pose2.hpp"

#include "base64_cells.hpp"
#include "polar_sampling.hpp"

namespace ramscout_feature_detector {
namespace {

constexpr const char* kPrefix = "pg1:8x24:4.0:";

int countBits(std::uint64_t bits) {
  return static_cast<int>(std::bitset<64>(bits).count());
}

/// Two samples a ring, linear in radius.
PolarSampling makeSampling() {
  const double ring_m = (PolarGrid::kOuterRadiusM - PolarGrid::kInnerRadiusM) / PolarGrid::kRings;
  std::vector<double> radii_m;
  for (int ring = 0; ring < PolarGrid::kRings; ++ring) {
    for (int i = 0; i < PolarSampling::kSamplesPerSide; ++i) {
      radii_m.push_back(PolarGrid::kInnerRadiusM +
                        ring_m * (ring + (i + 0.5) / PolarSampling::kSamplesPerSide));
    }
  }
  return {radii_m,
          std::vector<double>(PolarGrid::kRings, 0.5 * ring_m / PolarSampling::kSamplesPerSide),
          PolarGrid::kSectors};
}

}  // namespace

PolarGrid PolarGrid::around(const Eigen::Vector2d& place_m,
                            double orientation_rad,
                            const ram_slam::LaserScan& scan) {
  static const PolarSampling sampling = makeSampling();
  PolarGrid grid;
  sampling.sample({place_m.x(), place_m.y(), orientation_rad}, scan, grid.cells_.data());
  return grid;
}

std::string PolarGrid::toString() const {
  std::string text = kPrefix;
  appendCells(cells_.data(), kCells, text);
  return text;
}

std::optional<PolarGrid> PolarGrid::parse(const std::string& text) {
  static const std::string prefix = kPrefix;
  PolarGrid grid;
  if (text.compare(0, prefix.size(), prefix) != 0 ||
      !readCells(text, prefix.size(), kCells, grid.cells_.data())) {
    return std::nullopt;
  }
  return grid;
}

ComparableGrid::ComparableGrid(const PolarGrid& grid)
    : turned_{planesOf(grid, -1), planesOf(grid, 0), planesOf(grid, 1)} {}

ComparableGrid::Planes ComparableGrid::planesOf(const PolarGrid& grid, int turn) {
  Planes planes;
  for (int ring = 0; ring < PolarGrid::kRings; ++ring) {
    for (int sector = 0; sector < PolarGrid::kSectors; ++sector) {
      const int cell = ring * PolarGrid::kSectors + sector;
      const std::uint64_t bit = std::uint64_t{1} << (cell % 64);
      const PolarGrid::Cell state = grid.at(ring, sector + turn);
      if (state == PolarGrid::kFree) planes.free[cell / 64] |= bit;
      if (state == PolarGrid::kMixed) planes.mixed[cell / 64] |= bit;
      if (state == PolarGrid::kOccupied) planes.occupied[cell / 64] |= bit;
    }
  }
  return planes;
}

std::optional<double> ComparableGrid::distance(const ComparableGrid& other,
                                               const GridComparison& weights) const {
  const Planes& a = turned_[1];
  std::optional<double> best;
  for (int turn = -1; turn <= 1; ++turn) {
    const Planes& b = other.turned_[turn + 1];
    int common = 0, opposite = 0, half_apart = 0, one_sided = 0;
    for (int i = 0; i < kWords; ++i) {
      const std::uint64_t clear_a = a.free[i] | a.occupied[i];
      const std::uint64_t clear_b = b.free[i] | b.occupied[i];
      const std::uint64_t known_a = clear_a | a.mixed[i];
      const std::uint64_t known_b = clear_b | b.mixed[i];
      common += countBits(known_a & known_b);
      one_sided += countBits(known_a ^ known_b);
      opposite += countBits((a.free[i] & b.occupied[i]) | (a.occupied[i] & b.free[i]));
      half_apart += countBits((a.mixed[i] & clear_b) | (clear_a & b.mixed[i]));
    }
    if (common < weights.least_common_cells) continue;
    const double difference =
        (opposite + 0.25 * half_apart + weights.prior_cells * weights.prior_difference) /
            (common + weights.prior_cells) +
        weights.one_sided * one_sided / PolarGrid::kCells + weights.per_sector * std::abs(turn);
    if (!best || difference < *best) best = difference;
  }
  return best;
}

}  // namespace ramscout_feature_detector
