// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/causes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace ram_slam {
namespace {

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string duration(double seconds) {
  constexpr double kDay_s = 86400.0;
  char text[32];
  if (seconds > kDay_s) {
    std::snprintf(text, sizeof(text), "%.0f days", seconds / kDay_s);
  } else {
    std::snprintf(text, sizeof(text), "%.0f s", seconds);
  }
  return text;
}

std::string withoutDigits(std::string text) {
  text.erase(std::remove_if(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; }),
             text.end());
  return text;
}

}  // namespace

std::vector<Link> allLinks() {
  return {Link::kClock,      Link::kScan,     Link::kTf,   Link::kOdometry,
          Link::kKinematics, Link::kFeatures, Link::kPose, Link::kMap};
}

std::string toText(Link link) {
  switch (link) {
    case Link::kClock:
      return "clock";
    case Link::kScan:
      return "scan";
    case Link::kTf:
      return "tf";
    case Link::kOdometry:
      return "odometry";
    case Link::kKinematics:
      return "kinematics";
    case Link::kFeatures:
      return "features";
    case Link::kPose:
      return "pose";
    case Link::kMap:
      return "map";
  }
  return "";
}

std::vector<Cause> CauseFinder::find(const NodeFacts& facts) {
  if (!facts.has_clock) {
    return {{Link::kClock, Severity::kWarning, "no clock",
             "use_sim_time is set and nothing has come on /clock yet"}};
  }
  if (facts.clock_standing_s > kPatience_s) {
    return {{Link::kClock, Severity::kWarning, "clock stands",
             "the time on /clock stands still: the simulation or the recording is paused, waits, "
             "or has ended"}};
  }
  std::vector<Cause> causes;
  for (const InputFacts& input : facts.inputs) checkInput(facts, input, causes);
  for (const TransformFacts& transform : facts.transforms) checkTransform(facts, transform, causes);
  causes.insert(causes.end(), facts.own.begin(), facts.own.end());
  if (causes.empty()) checkOutput(facts, causes);
  std::stable_sort(causes.begin(), causes.end(), [](const Cause& a, const Cause& b) {
    return a.severity != b.severity ? a.severity > b.severity : a.link < b.link;
  });
  return causes;
}

double CauseFinder::silencePatience_s(const InputFacts& input) {
  return std::max(kPatience_s, kUsualIntervals * input.interval_s);
}

bool CauseFinder::isSilent(const InputFacts& input) {
  if (input.is_rare) return input.age_s == kNever_s && input.publishers.empty();
  return input.age_s > silencePatience_s(input);
}

void CauseFinder::checkInput(const NodeFacts& node,
                             const InputFacts& input,
                             std::vector<Cause>& causes) {
  const Severity severity = input.is_needed ? Severity::kError : Severity::kWarning;
  if (!isSilent(input)) {
    checkStamps(node, input, causes);
    if (!input.refusal.empty()) {
      causes.push_back(
          {input.link, severity, "refused " + input.content,
           "no usable " + input.content + " on " + input.topic + ": " + input.refusal});
    }
  } else if (node.running_s > kPatience_s) {
    const std::string name = nameOfSilence(input);
    causes.push_back({input.link, severity, name, textOfSilence(name, input)});
  } else {
    causes.push_back({input.link, Severity::kWarning, "starting",
                      "starts: waits for " + input.content + " on " + input.topic});
  }
}

std::string CauseFinder::nameOfSilence(const InputFacts& input) {
  if (input.publishers.empty())
    return input.elsewhere.empty() || input.age_s != kNever_s ? "no publisher" : "wrong topic";
  if (!input.published_type.empty() && input.published_type != input.type) return "wrong type";
  if (!input.dead.empty()) return "node dead";
  return input.age_s == kNever_s ? "nothing yet" : "node silent";
}

std::string CauseFinder::textOfSilence(const std::string& name, const InputFacts& input) {
  const std::string who = joined(input.publishers);
  if (name == "wrong topic") {
    const std::string others = "no " + input.content + ": no node publishes " + input.topic +
                               ", but there is " + joined(input.elsewhere);
    if (input.elsewhere.size() > 1)
      return others + "; set " + input.argument + ":= to the right one, or start " + input.source;
    const std::string& other = input.elsewhere.front();
    return others + "; start with " + input.argument + ":=" + other.substr(0, other.find(' '));
  }
  if (name == "no publisher") {
    return "no " + input.content + ": no node publishes " + input.topic + "; start " +
           input.source + ", or set " + input.argument + ":= to its topic";
  }
  if (name == "wrong type") {
    return "no " + input.content + ": " + input.topic + " of " + who + " carries " +
           input.published_type + ", not " + input.type;
  }
  if (name == "node dead") {
    return "no " + input.content + " on " + input.topic + ": " + joined(input.dead) +
           " does not answer; start it again";
  }
  if (name == "nothing yet") {
    return "no " + input.content + " yet: " + who + " publishes nothing on " + input.topic +
           "; see what it reports itself";
  }
  return "no " + input.content + " any more: " + who + " publishes nothing on " + input.topic +
         "; it is stopped, or lacks what it needs itself";
}

void CauseFinder::checkStamps(const NodeFacts& node,
                              const InputFacts& input,
                              std::vector<Cause>& causes) {
  if (input.age_s == kNever_s || input.is_rare) return;
  const double off_s = std::abs(input.stamp_age_s);
  if (off_s <= kMostStampAge_s * std::max(1.0, node.clock_speed)) return;
  const std::string name = off_s > kOtherClock_s     ? "other clock"
                           : input.stamp_age_s > 0.0 ? "stamps old"
                                                     : "stamps ahead";
  causes.push_back({input.link, Severity::kError, name, textOfStamps(node, input)});
}

std::string CauseFinder::textOfStamps(const NodeFacts& node, const InputFacts& input) {
  const std::string who = "the stamps of " + input.content + " on " + input.topic + " from " +
                          input.newest_publisher + " are " + duration(std::abs(input.stamp_age_s)) +
                          (input.stamp_age_s > 0.0 ? " older" : " newer") + " than the clock: ";
  if (std::abs(input.stamp_age_s) <= kOtherClock_s) {
    return who + "set the clocks of both computers (chrony), or correct the offset in the driver";
  }
  if (node.is_simulated_time) {
    return who +
           "use_sim_time is set, but its publisher uses another clock; set use_sim_time before "
           "it starts, or to false for a real robot";
  }
  return who +
         "a recording is played? Set use_sim_time to true before the nodes start, and play it "
         "with rosbag play --clock";
}

void CauseFinder::checkTransform(const NodeFacts& node,
                                 const TransformFacts& transform,
                                 std::vector<Cause>& causes) {
  const std::string both = transform.parent + " -> " + transform.child;
  if (transform.stamp_age_s > kMostStampAge_s * std::max(1.0, node.clock_speed)) {
    causes.push_back(
        {transform.link, Severity::kError, "old transform",
         "the transform " + both + " on tf is no longer renewed: " + transform.remedy});
  }
  if (transform.missing_s <= kPatience_s) return;
  const std::string no = "no transform " + both + " on tf: ";
  if (!transform.parent_exists && !transform.above.empty() && !transform.parent_parameter.empty()) {
    causes.push_back({transform.link, Severity::kError, "wrong " + transform.parent_parameter,
                      no + "there is no frame " + transform.parent + ", but above " +
                          transform.child + " there is " + joined(transform.above) + "; set " +
                          transform.parent_parameter});
  } else if (transform.above.empty() && !transform.below.empty() &&
             !transform.child_parameter.empty()) {
    causes.push_back({transform.link, Severity::kError, "wrong " + transform.child_parameter,
                      no + transform.child + " has no parent, but below " + transform.parent +
                          " there is " + joined(transform.below) + "; set " +
                          transform.child_parameter});
  } else {
    causes.push_back({transform.link, Severity::kError, "no transform", no + transform.remedy});
  }
}

void CauseFinder::checkOutput(const NodeFacts& node, std::vector<Cause>& causes) {
  if (node.output.empty()) return;
  double patience_s = node.output_patience_s;
  for (const InputFacts& input : node.inputs)
    patience_s = std::max(patience_s, node.output_patience_s + kUsualIntervals * input.interval_s);
  if (node.output_age_s <= patience_s) return;
  if (node.running_s <= patience_s) {
    causes.push_back(
        {node.link, Severity::kWarning, "starting", "starts: nothing on " + node.output + " yet"});
  } else {
    causes.push_back({node.link, Severity::kError, "no output",
                      "all inputs arrive, but nothing is published on " + node.output +
                          "; this node is too slow, or drops what comes"});
  }
}

std::vector<Cause> CauseLog::update(const std::vector<Cause>& causes, double now_s) {
  std::vector<Cause> result;
  entries_.erase(
      std::remove_if(entries_.begin(), entries_.end(),
                     [&](const Entry& entry) { return now_s - entry.newest_s > kGone_s; }),
      entries_.end());
  for (const Cause& cause : causes) {
    if (cause.name == "starting") continue;
    const std::string key = withoutDigits(toText(cause.link) + cause.name + cause.text);
    auto entry = std::find_if(entries_.begin(), entries_.end(),
                              [&](const Entry& other) { return other.key == key; });
    if (entry == entries_.end()) entry = entries_.insert(entry, {key, now_s, now_s, false});
    entry->newest_s = now_s;
    const double due_s = entry->first_s < kAtStart_s ? kStarting_s : entry->first_s + kLasting_s;
    if (entry->is_logged || now_s < due_s) continue;
    entry->is_logged = true;
    result.push_back(cause);
  }
  return result;
}

}  // namespace ram_slam
