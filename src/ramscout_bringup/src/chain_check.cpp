// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/chain_check.hpp"

#include <algorithm>
#include <optional>

namespace ramscout_bringup {
namespace {

using ram_slam::Cause;
using ram_slam::Link;
using ram_slam::Severity;

std::optional<Link> toLink(const std::string& text) {
  for (const Link link : ram_slam::allLinks()) {
    if (toText(link) == text) return link;
  }
  return std::nullopt;
}

/// The parts of "kind: link: rest"; false if the key is another one.
bool splitKey(const std::string& key, const std::string& kind, Link& link, std::string& rest) {
  if (key.compare(0, kind.size() + 2, kind + ": ") != 0) return false;
  const std::size_t end = key.find(": ", kind.size() + 2);
  if (end == std::string::npos) return false;
  const auto found = toLink(key.substr(kind.size() + 2, end - kind.size() - 2));
  if (!found) return false;
  link = *found;
  rest = key.substr(end + 2);
  return true;
}

/// What to start for a link that no node is.
std::string remedy(Link link) {
  switch (link) {
    case Link::kKinematics:
      return "no kinematic model is running; start roslaunch ramscout_bringup features.launch";
    case Link::kFeatures:
      return "no detector is running; start roslaunch ramscout_bringup features.launch";
    case Link::kPose:
      return "no estimator is running; start roslaunch ramscout_bringup fast_slam.launch";
    case Link::kMap:
      return "no mapper is running; start roslaunch ramscout_bringup map.launch";
    default:
      return "no node uses it; start roslaunch ramscout_bringup slam.launch";
  }
}

/// Whether a running node that is this link reports it. Scans, tf and odometry are seen by others.
bool isProvider(const NodeReport& report, Link link) {
  if (report.link != link) return false;
  return link != Link::kPose || report.name == "localisation";
}

bool isProvided(Link link, const std::vector<NodeReport>& reports) {
  if (link < Link::kKinematics) return true;
  return std::any_of(reports.begin(), reports.end(),
                     [&](const NodeReport& report) { return isProvider(report, link); });
}

std::optional<std::string> problemOf(Link link,
                                     const std::vector<NodeReport>& reports,
                                     const std::vector<SilentNode>& silent) {
  for (const SilentNode& node : silent) {
    if (node.link == link)
      return node.node + " reports nothing: it is stopped or dead; start it again";
  }
  if (!isProvided(link, reports)) return remedy(link);
  for (const NodeReport& report : reports) {
    for (const Cause& cause : report.causes) {
      const bool counts = cause.severity == Severity::kError || link == Link::kClock;
      if (cause.link == link && counts) return cause.text + " (reported by " + report.node + ")";
    }
  }
  return std::nullopt;
}

/// What is there of a link without a problem; nothing if no node shows it.
std::optional<std::string> evidenceOf(Link link, const std::vector<NodeReport>& reports) {
  for (const NodeReport& report : reports) {
    for (const auto& [of, text] : report.inputs) {
      if (of == link) return text;
    }
  }
  for (const NodeReport& report : reports) {
    if (link == Link::kClock) return "it runs";
    if (link == Link::kTf) return "all transforms that the nodes need are there";
    if (isProvider(report, link)) return report.message + " (" + report.node + ")";
  }
  return std::nullopt;
}

}  // namespace

bool toNodeReport(const std::string& name,
                  int level,
                  const std::string& message,
                  const std::vector<std::pair<std::string, std::string>>& values,
                  NodeReport& report) {
  const std::size_t end = name.find(": ");
  if (end == std::string::npos) return false;
  report = {};
  report.node = name.substr(0, end);
  report.name = name.substr(end + 2);
  report.severity = static_cast<Severity>(std::clamp(level, 0, 2));
  report.message = message;
  bool is_own = false;
  for (const auto& [key, text] : values) {
    Cause cause;
    std::string rest;
    if (key == "link") {
      const auto link = toLink(text);
      if (!link) return false;
      report.link = *link;
      is_own = true;
    } else if (splitKey(key, "cause", cause.link, cause.name) ||
               splitKey(key, "warning", cause.link, cause.name)) {
      cause.text = text;
      cause.severity = key.front() == 'c' ? Severity::kError : Severity::kWarning;
      report.causes.push_back(cause);
    } else if (splitKey(key, "input", cause.link, rest)) {
      report.inputs.emplace_back(cause.link, rest + ": " + text);
    }
  }
  return is_own;
}

std::vector<LinkState> checkChain(const std::vector<NodeReport>& reports,
                                  const std::vector<SilentNode>& silent) {
  std::vector<LinkState> states;
  for (const Link link : ram_slam::allLinks()) {
    const std::optional<std::string> problem = problemOf(link, reports, silent);
    const std::optional<std::string> evidence = evidenceOf(link, reports);
    states.push_back({link, !problem && evidence,
                      problem    ? *problem
                      : evidence ? *evidence
                                 : remedy(link)});
  }
  return states;
}

}  // namespace ramscout_bringup
