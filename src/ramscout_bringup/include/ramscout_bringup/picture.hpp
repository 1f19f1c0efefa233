// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "ramscout_bringup/results.hpp"

namespace ramscout_bringup {

/// Sizes of the picture.
struct PictureLayout {
  int longest_edge_px = 2400;   ///< of the map at most, but a cell is at least a pixel ...
  int max_edge_px = 6000;       ///< ... unless the picture would become longer than this
  int largest_cell_px = 8;      ///< edge of a cell of a small map
  double margin_m = 1.0;        ///< around all that is drawn
  int legend_height_px = 46;    ///< two lines of text
  int legend_width_px = 860;    ///< scale bar and three entries
  double font_scale = 0.5;      ///< of OpenCV's simplex font: 11 px high
  double scale_bar_px = 150.0;  ///< longest scale bar
};

/// A picture of a run as a PNG file's content: the map (walls black, floor white, unknown grey),
/// landmarks with their 1-sigma ellipses, the estimated path, the true one if there is one (aligned
/// with the estimate as compareWithTruth() does), a scale bar and a legend. An empty map gives a
/// picture of the paths alone.
std::string drawPicture(const Results& results, const PictureLayout& layout = {});

/// The known part of a map as a PNG file's content: walls black, floor white, unknown grey.
struct MapImage {
  std::string png;  ///< empty if nothing is known
  double resolution_m = 0.0;
  ram_slam::Pose2 map_from_image;  ///< lower left corner of the image
};
/// \param max_bytes  of the PNG; cells are joined, walls first, until it is no larger
/// \param max_edge_px  likewise of the image
MapImage drawMapImage(const ram_slam::OccupancyGrid& map, std::size_t max_bytes, int max_edge_px);

}  // namespace ramscout_bringup
