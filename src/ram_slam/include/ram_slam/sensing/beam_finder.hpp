// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace ram_slam {

/// Finds the beam of a scan in the direction of a point, to 2e-4 rad, without a branch: loops over
/// many points run on vectors.
class BeamFinder {
public:
  BeamFinder(double angle_min_rad, double angle_increment_rad, std::size_t beam_count)
      : angle_min_rad_(static_cast<float>(angle_min_rad)),
        beams_per_rad_(static_cast<float>(1.0 / angle_increment_rad)),
        beams_per_turn_(static_cast<float>(2.0 * M_PI / std::abs(angle_increment_rad))),
        beam_count_(static_cast<float>(beam_count)) {}

  /// The beam's index, or -1 if none has that direction. In the laser's frame.
  std::int32_t beamTowards(float x_m, float y_m) const {
    float beam = (roughBearing(y_m, x_m) - angle_min_rad_) * beams_per_rad_ + 0.5F;
    const float turned_on = beam + beams_per_turn_;
    const float turned_back = beam - beams_per_turn_;
    beam = beam < 0.0F ? turned_on : beam;
    beam = beam >= std::max(beam_count_, beams_per_turn_) ? turned_back : beam;
    const bool is_seen = beam >= 0.0F && beam < beam_count_;
    return static_cast<std::int32_t>(is_seen ? beam : -1.0F);
  }

private:
  static float roughBearing(float y, float x) {
    const float ax = std::abs(x);
    const float ay = std::abs(y);
    const float ratio = std::min(ax, ay) / std::max(std::max(ax, ay), 1e-12F);
    const float square = ratio * ratio;
    const float octant =
        ((-0.0464964749F * square + 0.15931422F) * square - 0.327622764F) * square * ratio + ratio;
    const float beyond_diagonal = static_cast<float>(M_PI_2) - octant;
    const float quadrant = ay > ax ? beyond_diagonal : octant;
    const float behind = static_cast<float>(M_PI) - quadrant;
    const float half = x < 0.0F ? behind : quadrant;
    return y < 0.0F ? -half : half;
  }

  float angle_min_rad_;
  float beams_per_rad_;
  float beams_per_turn_;
  float beam_count_;
};

}  // namespace ram_slam
