// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ramscout_bringup/results.hpp"

namespace ramscout_bringup {

enum class FindingLevel { kGood, kWarning, kBad };
/// "good", "warning" or "bad".
std::string toText(FindingLevel level);

/// What a run shows about its quality, in plain English.
struct Finding {
  FindingLevel level = FindingLevel::kGood;
  std::string text;
  std::string advice = "";  ///< what to do; empty if there is nothing to do
};

/// Beyond these a run is worth a warning.
struct FindingLimits {
  double least_used_share = 0.95;  ///< of the scans
  double worst_used_share = 0.5;   ///< below it the run is bad
  double most_slip_share = 0.05;   ///< of the scans, with slipping wheels
  double most_without_odometry_share = 0.05;
  double longest_gap_s = 2.0;  ///< between scans that were used
  double path_without_loop_m = 100.0;
};

/// One finding for each question that the results can answer: was the place known all the time,
/// were the scans used, did the odometry come, were loops closed, is the path the true one.
std::vector<Finding> findingsOf(const Results& results, const FindingLimits& limits = {});

/// The worst level; good if there is no finding.
FindingLevel worstOf(const std::vector<Finding>& findings);

}  // namespace ramscout_bringup
