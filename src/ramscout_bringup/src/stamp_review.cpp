// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/stamp_review.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "ram_slam/geometry/median.hpp"
#include "ram_slam/stages/clock_guard.hpp"

namespace ramscout_bringup {
namespace {

/// Messages of one topic that arrive out of order do so by less than this.
constexpr std::int64_t kToleranceNs = ram_slam::ClockGuard::kSetBackNs;
/// So many messages in a row are no stray ones: at 10 Hz a second of driving.
constexpr std::size_t kLeastDrive = 10;

/// The members of the longest sequence that does not fall.
std::vector<bool> longestRisingSequence(const std::vector<std::int64_t>& values) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> ends;  // of the sequence of each length, the one with the least end
  std::vector<std::size_t> before(values.size(), kNone);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto place =
        std::upper_bound(ends.begin(), ends.end(), values[i],
                         [&](std::int64_t value, std::size_t end) { return value < values[end]; });
    if (place != ends.begin()) before[i] = *(place - 1);
    if (place == ends.end()) {
      ends.push_back(i);
    } else {
      *place = i;
    }
  }
  std::vector<bool> is_member(values.size(), false);
  for (std::size_t i = ends.empty() ? kNone : ends.back(); i != kNone; i = before[i])
    is_member[i] = true;
  return is_member;
}

/// Whether each stamp lies more than the tolerance outside its neighbours in the rising sequence.
std::vector<bool> misplaced(const std::vector<std::int64_t>& stamps_ns) {
  std::vector<bool> result = longestRisingSequence(stamps_ns);
  std::vector<std::int64_t> next(stamps_ns.size() + 1, std::numeric_limits<std::int64_t>::max());
  for (std::size_t i = stamps_ns.size(); i-- > 0;) next[i] = result[i] ? stamps_ns[i] : next[i + 1];
  std::int64_t previous = std::numeric_limits<std::int64_t>::min() + kToleranceNs;
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    if (result[i]) {
      previous = stamps_ns[i];
      result[i] = false;
      continue;
    }
    const std::int64_t limit =
        next[i] == std::numeric_limits<std::int64_t>::max() ? next[i] : next[i] + kToleranceNs;
    result[i] = stamps_ns[i] < previous - kToleranceNs || stamps_ns[i] > limit;
  }
  return result;
}

/// Whether a stamp lies where the others miss one: then the message was written late.
bool fillsAHole(std::int64_t stamp_ns,
                const std::vector<std::int64_t>& sorted_ns,
                double period_s) {
  // Between regular stamps the nearest one is never farther than half a step.
  constexpr double kLeastDistance = 0.75;  // steps
  const auto next = std::lower_bound(sorted_ns.begin(), sorted_ns.end(), stamp_ns);
  if (next == sorted_ns.begin() || next == sorted_ns.end()) return false;
  const std::int64_t nearest_ns = std::min(*next - stamp_ns, stamp_ns - *(next - 1));
  return 1e-9 * static_cast<double>(nearest_ns) >= kLeastDistance * period_s;
}

/// Whether the stamps fall so often that these are no drives, but a file in no order of time.
bool isInNoOrder(const std::vector<std::int64_t>& stamps_ns) {
  std::size_t fall_count = 0;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i)
    fall_count += stamps_ns[i] < stamps_ns[i - 1] - kToleranceNs ? 1 : 0;
  return fall_count * kLeastDrive > stamps_ns.size();
}

void reviewSteps(const std::vector<std::int64_t>& sorted_ns, StampReview& review) {
  std::vector<std::int64_t> steps_ns;
  for (std::size_t i = 1; i < sorted_ns.size(); ++i) {
    const std::int64_t step_ns = sorted_ns[i] - sorted_ns[i - 1];
    if (step_ns <= 0) continue;
    steps_ns.push_back(step_ns);
    if (1e-9 * static_cast<double>(step_ns) > review.longest_gap_s) {
      review.longest_gap_s = 1e-9 * static_cast<double>(step_ns);
      review.longest_gap_from_ns = sorted_ns[i - 1];
    }
  }
  if (steps_ns.empty()) return;
  review.period_s = 1e-9 * static_cast<double>(ram_slam::median(std::move(steps_ns)));
}

std::string seconds(std::int64_t ns) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << 1e-9 * static_cast<double>(ns) << " s";
  return text.str();
}

/// First and last index of the wanted drive.
std::pair<std::size_t, std::size_t> limits(const std::vector<std::int64_t>& stamps_ns,
                                           const StampReview& review,
                                           const std::string& topic,
                                           const std::optional<std::size_t>& part) {
  if (review.reset.empty()) return {0, stamps_ns.size()};
  const std::size_t parts = review.reset.size() + 1;
  if (!part || *part > parts || *part == 0) {
    const std::size_t at = review.reset.front();
    throw std::runtime_error("the clock of " + topic + " was set back " +
                             std::to_string(review.reset.size()) + " times, first after message " +
                             std::to_string(at) + " (from " + seconds(stamps_ns[at - 1]) + " to " +
                             seconds(stamps_ns[at]) + "): the recording has " +
                             std::to_string(parts) + " drives; read one of them with --part 1 to " +
                             std::to_string(parts));
  }
  return {*part > 1 ? review.reset[*part - 2] : 0,
          *part < parts ? review.reset[*part - 1] : stamps_ns.size()};
}

}  // namespace

StampReview reviewStamps(const std::vector<std::int64_t>& stamps_ns) {
  StampReview review;
  const std::vector<bool> is_misplaced = misplaced(stamps_ns);
  std::vector<std::size_t> suspects;  // few misplaced ones in a row
  std::vector<std::int64_t> kept_ns;
  std::int64_t newest_ns = std::numeric_limits<std::int64_t>::min() + kToleranceNs;
  for (std::size_t i = 0; i < stamps_ns.size();) {
    std::size_t end = i;
    while (end < stamps_ns.size() && is_misplaced[end] == is_misplaced[i]) ++end;
    const bool are_few = is_misplaced[i] && end - i < kLeastDrive;
    for (; i < end; ++i) {
      if (are_few) {
        suspects.push_back(i);
        continue;
      }
      if (stamps_ns[i] < newest_ns - kToleranceNs) {
        review.reset.push_back(i);
        newest_ns = stamps_ns[i];
      }
      newest_ns = std::max(newest_ns, stamps_ns[i]);
      kept_ns.push_back(stamps_ns[i]);
    }
  }
  std::sort(kept_ns.begin(), kept_ns.end());
  reviewSteps(kept_ns, review);
  if (isInNoOrder(stamps_ns)) {
    review.reset.clear();
    return review;
  }
  for (const std::size_t i : suspects)
    if (!fillsAHole(stamps_ns[i], kept_ns, review.period_s)) review.stray.push_back(i);
  return review;
}

double shareOfDifferent(std::vector<std::int64_t> stamps_ns) {
  const auto count = static_cast<double>(stamps_ns.size());
  std::sort(stamps_ns.begin(), stamps_ns.end());
  const auto different = std::unique(stamps_ns.begin(), stamps_ns.end()) - stamps_ns.begin();
  return static_cast<double>(different) / count;
}

bool shouldUseRecorders(const std::vector<std::int64_t>& stamps_ns,
                        const std::vector<std::int64_t>& recorders_ns) {
  constexpr double kLeastShare = 0.5;
  return stamps_ns.size() >= 3 && recorders_ns.size() == stamps_ns.size() &&
         shareOfDifferent(stamps_ns) < kLeastShare && shareOfDifferent(recorders_ns) >= kLeastShare;
}

Drive selectDrive(const std::vector<std::int64_t>& stamps_ns,
                  const std::string& topic,
                  const std::optional<std::size_t>& part) {
  const StampReview review = reviewStamps(stamps_ns);
  const auto [begin, end] = limits(stamps_ns, review, topic, part);
  Drive drive;
  drive.period_s = review.period_s;
  std::vector<bool> is_stray(stamps_ns.size(), false);
  for (const std::size_t index : review.stray) is_stray[index] = true;
  for (std::size_t i = begin; i < end; ++i) {
    if (is_stray[i]) {
      ++drive.stray_count;
    } else {
      drive.order.push_back(i);
    }
  }
  std::stable_sort(drive.order.begin(), drive.order.end(),
                   [&](std::size_t a, std::size_t b) { return stamps_ns[a] < stamps_ns[b]; });
  if (drive.stray_count > 0) {
    drive.notes.push_back("left out " + std::to_string(drive.stray_count) + " messages of " +
                          topic + ": stamp more than 1 s from those before and after, first " +
                          seconds(stamps_ns[review.stray.front()]) + ", last " +
                          seconds(stamps_ns[review.stray.back()]));
  }
  if (!review.reset.empty()) {
    drive.notes.push_back("part " + std::to_string(*part) + " of " +
                          std::to_string(review.reset.size() + 1) + " of " + topic +
                          ": the clock was set back");
  }
  return drive;
}

std::vector<std::size_t> selectScans(const Drive& drive,
                                     const std::vector<std::int64_t>& stamps_ns,
                                     const RecordingOptions& options) {
  const auto nanoseconds = [](double s) {
    return static_cast<std::int64_t>(std::llround(1e9 * s));
  };
  std::vector<std::size_t> scans;
  // A tenth of the step is left to the jitter of the sensor.
  const std::int64_t step_ns = options.max_rate_hz ? nanoseconds(0.9 / *options.max_rate_hz) : 0;
  for (const std::size_t i : drive.order) {
    const std::int64_t since_first_ns = stamps_ns[i] - stamps_ns[drive.order.front()];
    const double read_s = 1e-9 * static_cast<double>(since_first_ns) - options.start_s;
    if (read_s < 0.0 || (options.duration_s && read_s > *options.duration_s)) continue;
    if (!scans.empty() && stamps_ns[i] - stamps_ns[scans.back()] < step_ns) continue;
    scans.push_back(i);
  }
  if (scans.empty())
    throw std::runtime_error("the recording has no scan between --start and --start + --duration");
  return scans;
}

}  // namespace ramscout_bringup
