// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/sensing/laser_scan.hpp"

namespace ram_slam {

/// What one beam saw, in the laser's frame: the end of the beam, drawn onto the line through its
/// neighbours if they lie on one.
struct SurfacePoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float normal_x =
      0.0F;  ///< unit normal of the line, turned towards the laser; zero if there is no line
  float normal_y = 0.0F;

  bool hasNormal() const { return normal_x != 0.0F || normal_y != 0.0F; }
};

/// Settings of the line fit.
struct SurfaceParameters {
  /// A line is fitted through the neighbours of a beam on each side that are within a window about
  /// its end, but at least through so many and at most through so many.
  int neighbour_count = 3;
  int max_neighbour_count = 12;
  double window_m = 0.2;               ///< to each side
  double window_in_deviations = 10.0;  ///< the same of the readings' standard deviation, if larger
  double max_gap_m = 0.2;  ///< between neighbours; farther apart they are different things
  double max_line_deviation_m = 0.03;   ///< standard deviation of the neighbours from their line
  double max_line_in_deviations = 1.7;  ///< the same of the readings' standard deviation, if larger
  double max_range_m = 80.0;            ///< readings beyond are not used: too sparse to be lines
  /// Gaps up to this many distances of neighbouring beams on a facing wall are none, either.
  double max_gap_in_beams = 4.0;
  /// A reading without enough neighbours may have them across gaps so many times as wide, if they
  /// lie on a line: a wall at a grazing angle.
  double grazing_gap_factor = 5.0;
  int min_line_points = 4;           ///< neighbours that a line needs, the point itself included
  double min_line_elongation = 3.0;  ///< deviation along the line over that across it

  static const ram_parameters::ParameterTable<SurfaceParameters>& table();

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// The surfaces that one scan saw, beam by beam, so that the place of a point in the scan is found
/// from its bearing.
struct SurfaceScan {
  double angle_min_rad = 0.0;
  double angle_increment_rad = 0.0;
  std::vector<SurfacePoint> points;  ///< those of beams that hit, in beam order
  std::vector<std::int32_t>
      point_of_beam;  ///< index into `points`; of a beam without a hit: that of the next one
};

/// Whether two points that follow each other lie on one line: each near the other's.
/// \param max_deviation_m  of a point from the line of the other
bool lieOnOneLine(const SurfacePoint& a, const SurfacePoint& b, double max_deviation_m);

/// Where everything was seen from the laser's pose at the first beam.
/// \param last_beam  pose of the laser at the last beam, seen from the first one; in
/// between it moves at constant twist
/// \throws std::invalid_argument as LaserScan::validate()
SurfaceScan extractSurfaces(const LaserScan& scan,
                            const SurfaceParameters& parameters,
                            const Pose2& last_beam = {});

}  // namespace ram_slam
