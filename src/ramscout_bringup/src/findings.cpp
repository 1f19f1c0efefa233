// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/findings.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "ramscout_bringup/evaluation.hpp"

namespace ramscout_bringup {
namespace {

using nlohmann::ordered_json;

/// With three digits.
std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

std::string percent(double share) {
  return number(100.0 * share) + " %";
}

/// Of a stamp since the first pose, as the charts have it.
std::string instant(const Results& results, double stamp_s) {
  const std::int64_t begin_ns =
      results.trajectory_online.empty() ? 0 : results.trajectory_online.front().stamp_ns;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f s", stamp_s - 1e-9 * static_cast<double>(begin_ns));
  return text.data();
}

double valueOf(const ordered_json& summary, const char* key) {
  const auto found = summary.find(key);
  return found != summary.end() && found->is_number() ? found->get<double>() : 0.0;
}

std::string textOf(const ordered_json& summary, const char* key) {
  const auto found = summary.find(key);
  return found != summary.end() && found->is_string() ? found->get<std::string>() : "";
}

void addTruth(const Results& results, std::vector<Finding>& findings) {
  if (!results.summary.contains("position_error_rms_m")) return;
  const bool is_bad = textOf(results.summary, "verdict") == "bad";
  findings.push_back({is_bad ? FindingLevel::kBad : FindingLevel::kGood,
                      "The final path is " +
                          number(valueOf(results.summary, "position_error_rms_m")) +
                          " m off the true one (root mean square)" +
                          (is_bad ? ", more than this run may be." : ".")});
}

void addScans(const Results& results, const FindingLimits& limits, std::vector<Finding>& findings) {
  if (results.scan_count == 0) return;
  const std::size_t used = results.trajectory_online.size();
  const double share = static_cast<double>(used) / static_cast<double>(results.scan_count);
  Finding finding{
      FindingLevel::kGood,
      std::to_string(used) + " of " + std::to_string(results.scan_count) + " scans were used."};
  if (share < limits.least_used_share) {
    finding.level = share < limits.worst_used_share ? FindingLevel::kBad : FindingLevel::kWarning;
    finding.advice = "The reasons are below, under what was left out and the notes.";
  }
  findings.push_back(finding);
}

void addGap(const Results& results, const FindingLimits& limits, std::vector<Finding>& findings) {
  const Trajectory& poses = results.trajectory_online;
  double longest_s = 0.0;
  double from_s = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double gap_s = 1e-9 * static_cast<double>(poses[i].stamp_ns - poses[i - 1].stamp_ns);
    if (gap_s <= longest_s) continue;
    longest_s = gap_s;
    from_s = 1e-9 * static_cast<double>(poses[i - 1].stamp_ns);
  }
  if (longest_s <= limits.longest_gap_s) return;
  findings.push_back({FindingLevel::kWarning,
                      "No scan was used for " + number(longest_s) + " s, from " +
                          instant(results, from_s) + " on.",
                      "Check the driver, the network and the disk that was recorded to."});
}

void addLosses(const Results& results, std::vector<Finding>& findings) {
  const auto losses = results.summary.find("losses");
  if (losses == results.summary.end() || !losses->is_array()) return;
  if (losses->empty()) {
    findings.push_back({FindingLevel::kGood, "The robot's place was known all the time."});
    return;
  }
  const ordered_json& last = losses->back();
  const std::string advice =
      "The charts show when. Drive slower there, or through places with more structure.";
  const std::string since = instant(results, valueOf(last, "from_s"));
  const std::string reason = textOf(last, "reason");
  if (last["to_s"].is_null()) {
    findings.push_back(
        {FindingLevel::kBad,
         "At the end the robot's place was not known, from " + since + " on: " + reason + ".",
         advice});
  } else {
    findings.push_back({FindingLevel::kWarning,
                        "The robot's place was lost and found again, " +
                            std::to_string(losses->size()) + " times; the last time at " + since +
                            ": " + reason + ".",
                        advice});
  }
}

void addCarried(const Results& results, std::vector<Finding>& findings) {
  const double times = valueOf(results.summary, "times_carried");
  if (times > 0.0)
    findings.push_back({FindingLevel::kWarning,
                        "The robot was carried, or no scans came while it drove: " + number(times) +
                            " times. The map is continued where it was put down.",
                        "Start a new recording when the robot is carried."});
}

void addOdometry(const Results& results,
                 const FindingLimits& limits,
                 std::vector<Finding>& findings) {
  const ordered_json& summary = results.summary;
  const std::string source = textOf(summary, "motion_from");
  if (source.empty()) return;
  const auto poses =
      static_cast<double>(std::max<std::size_t>(results.trajectory_online.size(), 1));
  const double without = valueOf(summary, "scans_without_odometry") / poses;
  const double slip = valueOf(summary, "scans_with_wheel_slip") / poses;
  Finding finding{FindingLevel::kGood, "The motion comes from " + source + "."};
  if (source.find("no odometry") != std::string::npos) {
    finding.level = FindingLevel::kWarning;
    finding.advice = "Record odometry, too: along corridors scans do not show how far it went.";
  } else if (without > limits.most_without_odometry_share) {
    finding.level = FindingLevel::kWarning;
    finding.text = percent(without) + " of the scans came without odometry.";
    finding.advice = "Check the odometry's driver; its rate is charted below.";
  } else if (slip > limits.most_slip_share) {
    finding.level = FindingLevel::kWarning;
    finding.text = "The wheels contradict " + percent(slip) + " of the scans.";
    finding.advice = "Check wheel diameters, the laser's mount and the stamps of both.";
  }
  findings.push_back(finding);
}

void addLoops(const Results& results, const FindingLimits& limits, std::vector<Finding>& findings) {
  if (!results.summary.contains("loop_closures")) return;
  const double loops = valueOf(results.summary, "loop_closures");
  const double path_m = valueOf(results.summary, "distance_m");
  if (loops > 0.0) {
    const auto refused = std::count_if(results.closures.begin(), results.closures.end(),
                                       [](const auto& closure) { return !closure.is_accepted; });
    findings.push_back(
        {FindingLevel::kGood, "Known places were recognised: " + number(loops) + " closed loops" +
                                  (refused > 0 ? ", and " + std::to_string(refused) +
                                                     " refused because the others contradict them."
                                               : ".")});
  } else if (path_m > limits.path_without_loop_m && !results.pose_graph_g2o.empty()) {
    findings.push_back({FindingLevel::kWarning,
                        "No loop was closed along " + number(path_m) +
                            " m: nothing corrects what has drifted on the way.",
                        "Drive through a place a second time, best in the same direction."});
  }
}

void addOthers(const Results& results, std::vector<Finding>& findings) {
  if (results.landmarks.empty())
    findings.push_back({FindingLevel::kWarning, "The map has no landmark.",
                        "Check the feature detector's settings for this lidar."});
  if (const double resets = valueOf(results.summary, "clock_resets"); resets > 0.0)
    findings.push_back(
        {FindingLevel::kWarning,
         "The clock was set back; the map begins there: " + number(resets) + " times.",
         "Start the nodes after the clock is set."});
}

}  // namespace

std::string toText(FindingLevel level) {
  if (level == FindingLevel::kGood) return "good";
  return level == FindingLevel::kWarning ? "warning" : "bad";
}

std::vector<Finding> findingsOf(const Results& results, const FindingLimits& limits) {
  std::vector<Finding> findings;
  addTruth(results, findings);
  addScans(results, limits, findings);
  addGap(results, limits, findings);
  addLosses(results, findings);
  addCarried(results, findings);
  addOdometry(results, limits, findings);
  addLoops(results, limits, findings);
  addOthers(results, findings);
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.level > b.level; });
  return findings;
}

FindingLevel worstOf(const std::vector<Finding>& findings) {
  FindingLevel worst = FindingLevel::kGood;
  for (const Finding& finding : findings) worst = std::max(worst, finding.level);
  return worst;
}

}  // namespace ramscout_bringup
