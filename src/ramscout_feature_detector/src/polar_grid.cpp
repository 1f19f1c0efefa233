// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/polar_grid.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>

#include "ram_slam/pose2.hpp"

#include "wide_registers.hpp"

namespace ramscout_feature_detector {
namespace {

constexpr const char* kPrefix = "pg1:8x24:4.0:";
constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr int kCellsPerDigit = 3;
constexpr int kDigitCount = PolarGrid::kCells / kCellsPerDigit;

constexpr int kSamplesPerSide = 2;
constexpr double kSurfaceM = 0.08;
constexpr double kFreeBelow = 0.2;
constexpr double kMixedBelow = 0.6;
constexpr int kLeastCommonCells = PolarGrid::kCells / 5;
constexpr double kPriorCells = 20.0;
constexpr double kPriorDifference = 0.12;
constexpr double kOneSidedWeight = 0.1;
constexpr double kTurnWeight = 0.01;

int countBits(std::uint64_t bits) {
  return static_cast<int>(std::bitset<64>(bits).count());
}

constexpr int kSamplesPerCell = kSamplesPerSide * kSamplesPerSide;
constexpr int kSamples = PolarGrid::kCells * kSamplesPerCell;
using Values = std::array<double, kSamples>;

/// Sample points of all cells relative to a corner at the origin with its bisector along x, cell by
/// cell.
struct Samples {
  Values x_m, y_m;
  std::array<double, PolarGrid::kRings> half_pitch_m;
};

Samples makeSamples() {
  Samples samples;
  const double ring_m = (PolarGrid::kOuterRadiusM - PolarGrid::kInnerRadiusM) / PolarGrid::kRings;
  std::size_t next = 0;
  for (int ring = 0; ring < PolarGrid::kRings; ++ring) {
    samples.half_pitch_m[ring] = 0.5 * ring_m / kSamplesPerSide;
    for (int sector = 0; sector < PolarGrid::kSectors; ++sector) {
      for (int i = 0; i < kSamplesPerCell; ++i) {
        const double radius_m = PolarGrid::kInnerRadiusM +
                                ring_m * (ring + (i / kSamplesPerSide + 0.5) / kSamplesPerSide);
        const double angle_rad = 2.0 * M_PI / PolarGrid::kSectors *
                                 (sector + (i % kSamplesPerSide + 0.5) / kSamplesPerSide - 0.5);
        samples.x_m[next] = radius_m * std::cos(angle_rad);
        samples.y_m[next++] = radius_m * std::sin(angle_rad);
      }
    }
  }
  return samples;
}

const Samples& samplePoints() {
  static const Samples samples = makeSamples();
  return samples;
}

/// atan2 within 2e-8 (Abramowitz & Stegun, Handbook of Mathematical Functions, 4.4.49), in a form
/// that compilers vectorise.
inline double bearingOf(double x, double y) {
  const double across = std::abs(x);
  const double up = std::abs(y);
  const double largest = std::max(std::max(across, up), 1e-300);
  const double t = std::min(across, up) / largest;
  const double t2 = t * t;
  double angle_rad = 0.0028662257;
  angle_rad = angle_rad * t2 - 0.0161657367;
  angle_rad = angle_rad * t2 + 0.0429096138;
  angle_rad = angle_rad * t2 - 0.0752896400;
  angle_rad = angle_rad * t2 + 0.1065626393;
  angle_rad = angle_rad * t2 - 0.1420889944;
  angle_rad = angle_rad * t2 + 0.1999355085;
  angle_rad = angle_rad * t2 - 0.3333314528;
  angle_rad = (angle_rad * t2 + 1.0) * t;
  angle_rad = up > across ? M_PI_2 - angle_rad : angle_rad;
  angle_rad = x < 0.0 ? M_PI - angle_rad : angle_rad;
  return std::copysign(angle_rad, y);
}

/// Where the samples around a corner lie in a scan.
struct Polar {
  Values range_m;
  Values beam;  ///< counted from the first, not yet rounded
};

RAMSCOUT_WIDE_REGISTERS
Polar toPolar(const ram_slam::Pose2& laser_from_corner,
              double angle_min_rad,
              double angle_increment_rad) {
  const Samples& samples = samplePoints();
  const double c = std::cos(laser_from_corner.yaw_rad);
  const double s = std::sin(laser_from_corner.yaw_rad);
  const double x_m = laser_from_corner.x_m;
  const double y_m = laser_from_corner.y_m;
  Polar polar;
  for (int i = 0; i < kSamples; ++i) {
    const double x = x_m + c * samples.x_m[i] - s * samples.y_m[i];
    const double y = y_m + s * samples.x_m[i] + c * samples.y_m[i];
    polar.range_m[i] = std::sqrt(x * x + y * y);
    polar.beam[i] = (bearingOf(x, y) - angle_min_rad) / angle_increment_rad;
  }
  return polar;
}

/// What one scan says about one place.
enum class Vote { kNone, kFree, kOccupied };

/// \param beams_per_turn  also if the scan has fewer
Vote vote(double range_m,
          double offset,
          double beams_per_turn,
          double half_pitch_m,
          const ram_slam::LaserScan& scan) {
  const auto count = static_cast<double>(scan.ranges_m.size());
  offset += 0.5;
  if (!(offset >= 0.0 && offset < count)) {
    // The same direction counted in another turn.
    offset = offset - 0.5 - beams_per_turn * std::floor((offset - 0.5) / beams_per_turn) + 0.5;
    if (!(offset >= 0.0 && offset < count)) return Vote::kNone;
  }
  const auto index = static_cast<std::size_t>(offset);
  switch (scan.at(index)) {
    case ram_slam::Return::kHit: {
      const double beyond_m = range_m - scan.ranges_m[index];
      if (std::abs(beyond_m) < std::max(kSurfaceM, half_pitch_m)) return Vote::kOccupied;
      return beyond_m < 0.0 ? Vote::kFree : Vote::kNone;
    }
    case ram_slam::Return::kNothing:
      return range_m < scan.range_max_m ? Vote::kFree : Vote::kNone;
    default:
      return Vote::kNone;
  }
}

PolarGrid::Cell cellOf(int free_votes, int occupied_votes) {
  if (free_votes + occupied_votes == 0) return PolarGrid::kUnknown;
  const double occupied = static_cast<double>(occupied_votes) / (free_votes + occupied_votes);
  if (occupied < kFreeBelow) return PolarGrid::kFree;
  return occupied < kMixedBelow ? PolarGrid::kMixed : PolarGrid::kOccupied;
}

}  // namespace

PolarGrid PolarGrid::around(const Eigen::Vector2d& place_m,
                            double orientation_rad,
                            const ram_slam::LaserScan& scan) {
  const Polar polar = toPolar({place_m.x(), place_m.y(), orientation_rad}, scan.angle_min_rad,
                              scan.angle_increment_rad);
  const double beams_per_turn = std::abs(2.0 * M_PI / scan.angle_increment_rad);
  PolarGrid grid;
  std::size_t next = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    const double half_pitch_m = samplePoints().half_pitch_m[ring];
    for (int sector = 0; sector < kSectors; ++sector) {
      int free_votes = 0;
      int occupied_votes = 0;
      for (int i = 0; i < kSamplesPerCell; ++i, ++next) {
        const Vote said =
            vote(polar.range_m[next], polar.beam[next], beams_per_turn, half_pitch_m, scan);
        free_votes += said == Vote::kFree ? 1 : 0;
        occupied_votes += said == Vote::kOccupied ? 1 : 0;
      }
      grid.set(ring, sector, cellOf(free_votes, occupied_votes));
    }
  }
  return grid;
}

std::string PolarGrid::toString() const {
  std::string text = kPrefix;
  for (int digit = 0; digit < kDigitCount; ++digit) {
    const Cell* cell = cells_.data() + kCellsPerDigit * digit;
    text += kDigits[cell[0] | cell[1] << 2 | cell[2] << 4];
  }
  return text;
}

std::optional<PolarGrid> PolarGrid::parse(const std::string& text) {
  static const std::string prefix = kPrefix;
  static const std::string digits = kDigits;
  if (text.size() != prefix.size() + kDigitCount || text.compare(0, prefix.size(), prefix) != 0) {
    return std::nullopt;
  }
  PolarGrid grid;
  for (int digit = 0; digit < kDigitCount; ++digit) {
    const std::size_t value = digits.find(text[prefix.size() + digit]);
    if (value == std::string::npos) return std::nullopt;
    for (int i = 0; i < kCellsPerDigit; ++i) {
      grid.cells_[kCellsPerDigit * digit + i] = static_cast<Cell>(value >> (2 * i) & 3U);
    }
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

std::optional<double> ComparableGrid::distance(const ComparableGrid& other) const {
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
    if (common < kLeastCommonCells) continue;
    const double difference =
        (opposite + 0.25 * half_apart + kPriorCells * kPriorDifference) / (common + kPriorCells) +
        kOneSidedWeight * one_sided / PolarGrid::kCells + kTurnWeight * std::abs(turn);
    if (!best || difference < *best) best = difference;
  }
  return best;
}

}  // namespace ramscout_feature_detector
