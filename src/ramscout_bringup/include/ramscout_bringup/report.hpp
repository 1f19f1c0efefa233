// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "ramscout_bringup/results.hpp"

namespace ramscout_bringup {

/// Bounds of the report's size, together at most 3 MB.
struct ReportLimits {
  std::size_t max_map_bytes = 1'000'000;  ///< of the map's PNG
  int max_map_edge_px = 4000;
  double path_step_m = 0.02;  ///< between two points of a path, longer if there are too many
  std::size_t max_path_points = 10000;
  std::size_t max_landmarks = 5000;
  std::size_t max_closures = 2000;
  std::size_t chart_intervals = 300;
  std::size_t max_list = 300;   ///< rows of any other list
  std::size_t max_text = 1000;  ///< bytes of any text
};

/// A run as one HTML page without references to other files or the network: map, paths, landmarks
/// and closures to zoom into, what is good and bad about the run, figures over time, what was left
/// out, settings. All content is data of the page's script, so that no text of a recording can be
/// HTML.
std::string toHtml(const Results& results, const ReportLimits& limits = {});

/// The data of that page, as JSON; the script in src/report.html is its only reader.
nlohmann::ordered_json reportData(const Results& results, const ReportLimits& limits);

}  // namespace ramscout_bringup
