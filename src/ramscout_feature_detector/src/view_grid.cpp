// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/view_grid.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>

#include "ram_slam/geometry/pose2.hpp"

#include "base64_cells.hpp"
#include "polar_sampling.hpp"
#include "wide_registers.hpp"

namespace ramscout_feature_detector {
namespace {

constexpr const char* kPrefix = "pg2:8x48:8.0:";
/// The bounds of the rings plus kRingOffsetM are a geometric series.
PolarSampling makeSampling() {
  std::vector<double> radii_m, half_pitches_m;
  const auto bound_m = [](int ring) {
    const double ratio = (ViewGrid::kOuterRadiusM + ViewGrid::kRingOffsetM) /
                         (ViewGrid::kInnerRadiusM + ViewGrid::kRingOffsetM);
    return (ViewGrid::kInnerRadiusM + ViewGrid::kRingOffsetM) *
               std::pow(ratio, 1.0 * ring / ViewGrid::kRings) -
           ViewGrid::kRingOffsetM;
  };
  for (int ring = 0; ring < ViewGrid::kRings; ++ring) {
    const double width_m = bound_m(ring + 1) - bound_m(ring);
    radii_m.push_back(bound_m(ring) + 0.25 * width_m);
    radii_m.push_back(bound_m(ring) + 0.75 * width_m);
    half_pitches_m.push_back(0.25 * width_m);
  }
  return {radii_m, half_pitches_m, ViewGrid::kSectors};
}

double weightOf(int ring, double outermost) {
  return 1.0 + (outermost - 1.0) * ring / (ViewGrid::kRings - 1);
}

int countBits(std::uint64_t bits) {
  return static_cast<int>(std::bitset<64>(bits).count());
}

/// The sectors of a ring turned by at most all of them, to either side.
std::uint64_t turned(std::uint64_t ring, int sectors) {
  const std::uint64_t all = (std::uint64_t{1} << ViewGrid::kSectors) - 1;
  const int left = (sectors + ViewGrid::kSectors) % ViewGrid::kSectors;
  return (ring << left | ring >> (ViewGrid::kSectors - left)) & all;
}

}  // namespace

ViewGrid ViewGrid::around(const Eigen::Vector2d& place_m, const ram_slam::LaserScan& scan) {
  static const PolarSampling sampling = makeSampling();
  ViewGrid grid;
  const double to_laser_rad = std::atan2(-place_m.y(), -place_m.x());
  sampling.sample({place_m.x(), place_m.y(), to_laser_rad}, scan, grid.cells_.data());
  grid.range_cm_ = static_cast<int>(
      std::lround(std::min(100.0 * place_m.norm(), static_cast<double>(kFarthestCm))));
  return grid;
}

std::string ViewGrid::toString() const {
  std::string text = kPrefix + std::to_string(range_cm_) + ':';
  appendCells(cells_.data(), kCells, text);
  return text;
}

std::optional<ViewGrid> ViewGrid::parse(const std::string& text) {
  static const std::string prefix = kPrefix;
  if (text.compare(0, prefix.size(), prefix) != 0) return std::nullopt;
  const std::size_t colon = text.find(':', prefix.size());
  if (colon == std::string::npos || colon == prefix.size()) return std::nullopt;
  ViewGrid grid;
  for (std::size_t i = prefix.size(); i < colon; ++i) {
    if (text[i] < '0' || text[i] > '9') return std::nullopt;
    grid.range_cm_ = 10 * grid.range_cm_ + (text[i] - '0');
    if (grid.range_cm_ > kFarthestCm) return std::nullopt;
  }
  const bool has_zeros = text[prefix.size()] == '0' && colon > prefix.size() + 1;
  if (has_zeros) return std::nullopt;
  if (!readCells(text, colon + 1, kCells, grid.cells_.data())) return std::nullopt;
  return grid;
}

ComparableView::ComparableView(const ViewGrid& grid) : range_m_(grid.range_m()) {
  for (int ring = 0; ring < ViewGrid::kRings; ++ring) {
    for (int sector = 0; sector < ViewGrid::kSectors; ++sector) {
      const std::uint64_t bit = std::uint64_t{1} << sector;
      const PolarGrid::Cell state = grid.at(ring, sector);
      if (state == PolarGrid::kFree) rings_[ring].free |= bit;
      if (state == PolarGrid::kMixed) rings_[ring].mixed |= bit;
      if (state == PolarGrid::kOccupied) rings_[ring].occupied |= bit;
    }
  }
}

RAMSCOUT_WIDE_REGISTERS
std::optional<double> ComparableView::distance(const ComparableView& other,
                                               const ViewComparison& weights) const {
  const double all_weights =
      0.5 * (1.0 + weights.outermost_ring) * ViewGrid::kRings * ViewGrid::kSectors;
  std::optional<double> best;
  for (int turn = -weights.largest_turn; turn <= weights.largest_turn; ++turn) {
    double common = 0.0, different = 0.0, one_sided = 0.0;
    for (int ring = 0; ring < ViewGrid::kRings; ++ring) {
      const Ring& a = rings_[ring];
      const Ring b{turned(other.rings_[ring].free, turn), turned(other.rings_[ring].mixed, turn),
                   turned(other.rings_[ring].occupied, turn)};
      const std::uint64_t clear_a = a.free | a.occupied;
      const std::uint64_t clear_b = b.free | b.occupied;
      const std::uint64_t known_a = clear_a | a.mixed;
      const std::uint64_t known_b = clear_b | b.mixed;
      const double weight = weightOf(ring, weights.outermost_ring);
      common += weight * countBits(known_a & known_b);
      one_sided += weight * countBits(known_a ^ known_b);
      different += weight * (countBits((a.free & b.occupied) | (a.occupied & b.free)) +
                             0.25 * countBits((a.mixed & clear_b) | (clear_a & b.mixed)));
    }
    if (common < weights.least_common_share * all_weights) continue;
    const double angle_rad = 2.0 * M_PI * turn / ViewGrid::kSectors;
    const double apart_m =
        std::sqrt(std::max(range_m_ * range_m_ + other.range_m_ * other.range_m_ -
                               2.0 * range_m_ * other.range_m_ * std::cos(angle_rad),
                           0.0));
    const double difference = (different + weights.prior_cells * weights.prior_difference) /
                                  (common + weights.prior_cells) +
                              weights.one_sided * one_sided / all_weights +
                              weights.apart_per_m * std::min(apart_m, weights.farthest_apart_m);
    if (!best || difference < *best) best = difference;
  }
  return best;
}

}  // namespace ramscout_feature_detector
