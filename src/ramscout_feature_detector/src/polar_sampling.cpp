// SPDX-License-Identifier: BSD-3-Clause
#include "polar_sampling.hpp"

#include <algorithm>
#include <cmath>

#include "wide_registers.hpp"

namespace ramscout_feature_detector {
namespace {

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

/// Where samples lie in a scan.
struct Polar {
  std::vector<double> range_m;
  std::vector<double> beam;  ///< counted from the first, not yet rounded
};

RAMSCOUT_WIDE_REGISTERS
void toPolar(const std::vector<double>& x_of_samples_m,
             const std::vector<double>& y_of_samples_m,
             const ram_slam::Pose2& laser_from_grid,
             const ram_slam::LaserScan& scan,
             Polar& polar) {
  const double c = std::cos(laser_from_grid.yaw_rad);
  const double s = std::sin(laser_from_grid.yaw_rad);
  const double x_m = laser_from_grid.x_m;
  const double y_m = laser_from_grid.y_m;
  const double angle_min_rad = scan.angle_min_rad;
  const double angle_increment_rad = scan.angle_increment_rad;
  const std::size_t count = x_of_samples_m.size();
  const double* xs_m = x_of_samples_m.data();
  const double* ys_m = y_of_samples_m.data();
  double* range_m = polar.range_m.data();
  double* beam = polar.beam.data();
  for (std::size_t i = 0; i < count; ++i) {
    const double x = x_m + c * xs_m[i] - s * ys_m[i];
    const double y = y_m + s * xs_m[i] + c * ys_m[i];
    range_m[i] = std::sqrt(x * x + y * y);
    beam[i] = (bearingOf(x, y) - angle_min_rad) / angle_increment_rad;
  }
}

/// What one scan shows of one place.
enum class Vote { kNone, kFree, kOccupied };

/// \param beams_per_turn  also if the scan has fewer
/// \param surface_m  how near to a reading a place is on its surface
Vote vote(double range_m,
          double offset,
          double beams_per_turn,
          double surface_m,
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
      if (std::abs(beyond_m) < surface_m) return Vote::kOccupied;
      return beyond_m < 0.0 ? Vote::kFree : Vote::kNone;
    }
    case ram_slam::Return::kNothing:
      return range_m < scan.range_max_m ? Vote::kFree : Vote::kNone;
    default:
      return Vote::kNone;
  }
}

PolarGrid::Cell cellOf(int free_votes, int occupied_votes, const CellRule& rule) {
  if (free_votes + occupied_votes == 0) return PolarGrid::kUnknown;
  const double occupied = static_cast<double>(occupied_votes) / (free_votes + occupied_votes);
  if (occupied < rule.free_below) return PolarGrid::kFree;
  return occupied < rule.mixed_below ? PolarGrid::kMixed : PolarGrid::kOccupied;
}

}  // namespace

PolarSampling::PolarSampling(const std::vector<double>& radii_m,
                             const std::vector<double>& half_pitches_m,
                             int sectors,
                             const CellRule& rule)
    : sectors_(sectors), half_pitches_m_(half_pitches_m), rule_(rule) {
  for (std::size_t ring = 0; ring < half_pitches_m.size(); ++ring) {
    for (int sector = 0; sector < sectors; ++sector) {
      for (int i = 0; i < kSamplesPerCell; ++i) {
        const double radius_m = radii_m[kSamplesPerSide * ring + i / kSamplesPerSide];
        const double angle_rad =
            2.0 * M_PI / sectors * (sector + (i % kSamplesPerSide + 0.5) / kSamplesPerSide - 0.5);
        x_m_.push_back(radius_m * std::cos(angle_rad));
        y_m_.push_back(radius_m * std::sin(angle_rad));
      }
    }
  }
}

void PolarSampling::sample(const ram_slam::Pose2& laser_from_grid,
                           const ram_slam::LaserScan& scan,
                           PolarGrid::Cell* cells) const {
  Polar polar{std::vector<double>(x_m_.size()), std::vector<double>(x_m_.size())};
  toPolar(x_m_, y_m_, laser_from_grid, scan, polar);
  const double beams_per_turn = std::abs(2.0 * M_PI / scan.angle_increment_rad);
  std::size_t next = 0;
  for (const double half_pitch_m : half_pitches_m_) {
    const double surface_m = std::max(rule_.surface_m, half_pitch_m);
    for (int sector = 0; sector < sectors_; ++sector) {
      int free_votes = 0;
      int occupied_votes = 0;
      for (int i = 0; i < kSamplesPerCell; ++i, ++next) {
        const Vote seen =
            vote(polar.range_m[next], polar.beam[next], beams_per_turn, surface_m, scan);
        free_votes += seen == Vote::kFree ? 1 : 0;
        occupied_votes += seen == Vote::kOccupied ? 1 : 0;
      }
      *cells++ = cellOf(free_votes, occupied_votes, rule_);
    }
  }
}

}  // namespace ramscout_feature_detector
