// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/odometry_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "ram_slam/stages/clock_guard.hpp"

namespace ramscout_kinematics {
namespace {

double secondsBetween(std::int64_t from_ns, std::int64_t to_ns) {
  return static_cast<double>(to_ns - from_ns) / 1e9;
}

std::int64_t toNanoseconds(double duration_s) {
  return static_cast<std::int64_t>(std::llround(duration_s * 1e9));
}

std::string toText(std::int64_t stamp_ns) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9f", secondsBetween(0, stamp_ns));
  return text;
}

}  // namespace

const ram_parameters::ParameterTable<OdometryBufferParameters>& OdometryBufferParameters::table() {
  using namespace ram_parameters;
  using P = OdometryBufferParameters;
  static const auto table =
      ParameterTable<P>()
          .add("buffer_duration_s", &P::buffer_duration_s, "s", aboveUpTo(0.0, 3600.0),
               "Length of the history that can be asked about; of a gap, max_gap_s count.")
          .add("reorder_window_s", &P::reorder_window_s, "s",
               between(0.0, ram_slam::ClockGuard::kSetBackNs * 1e-9),
               "Odometry that arrives out of order by up to this is put in its place, later it is "
               "dropped. By more than 1 s: the clock was set back, and the history is forgotten.")
          .add("max_extrapolation_s", &P::max_extrapolation_s, "s", atLeast(0.0),
               "How far past the newest odometry a request may reach; the last velocity is "
               "continued, with more noise.")
          .add("acceleration_sigma_mps2", &P::acceleration_sigma_mps2, "m/s^2", atLeast(0.0),
               "Standard deviation of the unknown acceleration during that time.")
          .add("turn_acceleration_sigma_radps2", &P::turn_acceleration_sigma_radps2, "rad/s^2",
               atLeast(0.0), "The same of the turn.")
          .add("gap_s", &P::gap_s, "s", positive(),
               "A longer interval between two samples is a gap; its noise is multiplied by "
               "interval / gap_s.")
          .add("max_gap_s", &P::max_gap_s, "s", anyNumber(),
               "Requests that touch a longer gap than this are refused.")
          .rule(&P::max_gap_s, ">= gap_s", [](const P& p) { return p.max_gap_s >= p.gap_s; })
          .add("max_speed_mps", &P::max_speed_mps, "m/s", positive(),
               "Fastest the robot moves. Samples that imply twice that are jumps and not used; "
               "three in a row mean that the odometry's origin was moved, and motion continues "
               "from there.")
          .add("max_turn_rate_radps", &P::max_turn_rate_radps, "rad/s", positive(),
               "Fastest the robot turns; jumps as above.")
          .expert("Odometry samples")
          .add("continuous_gap_m", &P::continuous_gap_m, "m", atLeast(0.0),
               "A gap over which the pose moved no farther than this ...")
          .add("continuous_gap_rad", &P::continuous_gap_rad, "rad", atLeast(0.0),
               "... and turned no farther than this is none: the odometry went on, or the robot "
               "stood still.")
          .add("jump_slack_m", &P::jump_slack_m, "m", atLeast(0.0),
               "Distance a sample may be off beyond twice the speed before it is a jump: stamps "
               "jitter.")
          .add("jump_slack_rad", &P::jump_slack_rad, "rad", atLeast(0.0),
               "Angle a sample may be off beyond twice the turn rate before it is a jump.")
          .add("twist_baseline_s", &P::twist_baseline_s, "s", positive(),
               "Shortest time between two poses from which the last velocity is computed.");
  return table;
}

void OdometryBufferParameters::validate() const {
  table().check(*this);
}

OdometryBuffer::OdometryBuffer(const OdometryBufferParameters& parameters)
    : parameters_(parameters) {
  parameters_.validate();
}

Added OdometryBuffer::add(const OdometrySample& sample) {
  if (sample.stamp_ns <= 0) throw std::invalid_argument("odometry without a stamp");
  if (!sample.odom_from_base.isFinite() || !sample.twist.allFinite()) {
    throw std::invalid_argument("odometry is not finite");
  }
  const std::int64_t newest_ns = empty() ? 0 : entries_.back().sample.stamp_ns;
  if (ram_slam::ClockGuard::isSetBack(newest_ns, sample.stamp_ns)) {
    entries_.clear();
    has_forgotten_ = false;
    entries_.push_back({sample});
    return Added::kClockSetBack;
  }
  if (secondsBetween(sample.stamp_ns, newest_ns) > parameters_.reorder_window_s)
    return Added::kTooLate;

  const auto place = std::lower_bound(
      entries_.begin(), entries_.end(), sample.stamp_ns,
      [](const Entry& entry, std::int64_t stamp_ns) { return entry.sample.stamp_ns < stamp_ns; });
  const auto index = static_cast<std::size_t>(std::distance(entries_.begin(), place));
  const bool repeated = place != entries_.end() && place->sample.stamp_ns == sample.stamp_ns;
  const bool in_order = place == entries_.end();
  if (repeated) {
    place->sample = sample;
  } else {
    entries_.insert(place, {sample});
  }
  measureFrom(index);
  const bool origin_moved = judgeFrom(index);
  const bool held_back = entries_[index].standing == Standing::kHeldBack;
  forgetOld();
  if (origin_moved) return Added::kDiscontinuity;
  if (held_back) return Added::kJump;
  if (repeated) return Added::kRepeated;
  return in_order ? Added::kInOrder : Added::kReordered;
}

bool OdometryBuffer::judgeFrom(std::size_t first) {
  bool origin_moved = false;
  // Two entries back: they may have been accepted because of what followed them.
  for (std::size_t i = first < 2 ? 0 : first - 2; i < entries_.size(); ++i) {
    std::size_t before = i;
    while (before > 0 && entries_[before - 1].standing == Standing::kHeldBack) --before;
    if (before > 0 && entries_[i].sample.is_restart) {
      entries_[i].standing = Standing::kOriginMoved;
      continue;
    }
    if (before == 0 || isPlausible(entries_[before - 1].sample, entries_[i].sample)) {
      entries_[i].standing = Standing::kAccepted;
      continue;
    }
    entries_[i].standing = Standing::kHeldBack;
    if (originMovedAt(i)) {
      entries_[i - 2].standing = Standing::kOriginMoved;
      entries_[i - 1].standing = entries_[i].standing = Standing::kAccepted;
      origin_moved = true;
    }
  }
  return origin_moved;
}

bool OdometryBuffer::originMovedAt(std::size_t last_of_three) const {
  if (last_of_three < 2) return false;
  const Entry& first = entries_[last_of_three - 2];
  const Entry& second = entries_[last_of_three - 1];
  return first.standing == Standing::kHeldBack && second.standing == Standing::kHeldBack &&
         isPlausible(first.sample, second.sample) &&
         isPlausible(second.sample, entries_[last_of_three].sample);
}

bool OdometryBuffer::isPlausible(const OdometrySample& before, const OdometrySample& after) const {
  const double interval_s = secondsBetween(before.stamp_ns, after.stamp_ns);
  const ram_slam::Pose2 moved = before.odom_from_base.inverse() * after.odom_from_base;
  return moved.translation().norm() <=
             2.0 * parameters_.max_speed_mps * interval_s + parameters_.jump_slack_m &&
         std::abs(moved.yaw_rad) <=
             2.0 * parameters_.max_turn_rate_radps * interval_s + parameters_.jump_slack_rad;
}

void OdometryBuffer::measureFrom(std::size_t first) {
  const std::int64_t max_gap_ns = toNanoseconds(parameters_.max_gap_s);
  for (std::size_t i = std::max<std::size_t>(first, 1); i < entries_.size(); ++i) {
    const std::int64_t interval_ns = entries_[i].sample.stamp_ns - entries_[i - 1].sample.stamp_ns;
    entries_[i].history_ns = entries_[i - 1].history_ns + std::min(interval_ns, max_gap_ns);
  }
}

void OdometryBuffer::forgetOld() {
  const std::int64_t limit_ns =
      newestAccepted()->history_ns - toNanoseconds(parameters_.buffer_duration_s);
  for (auto next = nextAccepted(entries_.begin());
       next != entries_.end() && next->history_ns <= limit_ns;
       next = nextAccepted(entries_.begin())) {
    entries_.erase(entries_.begin(), next);
    has_forgotten_ = true;
  }
}

std::int64_t OdometryBuffer::newestNs() const {
  return empty() ? 0 : newestAccepted()->sample.stamp_ns;
}

OdometryBuffer::Iterator OdometryBuffer::newestAccepted() const {
  return acceptedBefore(entries_.back().sample.stamp_ns);
}

OdometryBuffer::Iterator OdometryBuffer::nextAccepted(Iterator entry) const {
  return std::find_if(std::next(entry), entries_.end(), [](const Entry& candidate) {
    return candidate.standing != Standing::kHeldBack;
  });
}

OdometryBuffer::Iterator OdometryBuffer::acceptedBefore(std::int64_t stamp_ns) const {
  auto entry = std::prev(std::upper_bound(entries_.begin(), entries_.end(), stamp_ns,
                                          [](std::int64_t stamp, const Entry& candidate) {
                                            return stamp < candidate.sample.stamp_ns;
                                          }));
  while (entry->standing == Standing::kHeldBack) --entry;
  return entry;
}

std::vector<MotionSegment> OdometryBuffer::segments(std::int64_t from_ns,
                                                    std::int64_t to_ns) const {
  requireCovered(from_ns, to_ns);
  std::vector<MotionSegment> segments;
  Iterator before = acceptedBefore(from_ns);
  std::int64_t reached_ns = from_ns;
  while (reached_ns < to_ns) {
    const Iterator after = nextAccepted(before);
    if (after == entries_.end()) {
      segments.push_back(beyond(before, reached_ns, to_ns));
      break;
    }
    const std::int64_t end_ns = std::min(to_ns, after->sample.stamp_ns);
    segments.push_back(between(*before, *after, reached_ns, end_ns));
    reached_ns = end_ns;
    before = after;
  }
  return segments;
}

MotionSegment OdometryBuffer::between(const Entry& before,
                                      const Entry& after,
                                      std::int64_t from_ns,
                                      std::int64_t to_ns) const {
  const std::int64_t start_ns = before.sample.stamp_ns;
  const double interval_s = secondsBetween(start_ns, after.sample.stamp_ns);
  const ram_slam::Pose2 moved =
      before.sample.odom_from_base.inverse() * after.sample.odom_from_base;
  const bool is_continuous = after.standing == Standing::kAccepted &&
                             moved.translation().norm() <= parameters_.continuous_gap_m &&
                             std::abs(moved.yaw_rad) <= parameters_.continuous_gap_rad;
  const double longest_s = after.sample.is_restart ? parameters_.gap_s : parameters_.max_gap_s;
  if (interval_s > longest_s && !is_continuous) {
    refuse(Unavailable::kGap,
           "no odometry between " + toText(start_ns) + " and " + toText(after.sample.stamp_ns));
  }
  MotionSegment segment;
  segment.duration_s = secondsBetween(from_ns, to_ns);
  segment.noise_factor =
      std::clamp(interval_s / parameters_.gap_s, 1.0, parameters_.max_gap_s / parameters_.gap_s);
  const double fraction = segment.duration_s / interval_s;
  if (after.standing == Standing::kOriginMoved) {
    // How far the robot went is not known, but how far it can have gone is.
    const double reach_m = parameters_.max_speed_mps * interval_s;
    const double reach_rad = parameters_.max_turn_rate_radps * interval_s;
    segment.added_variance =
        fraction * Eigen::Vector3d(reach_m * reach_m, reach_m * reach_m, reach_rad * reach_rad);
  } else {
    segment.increment = fraction * ram_slam::logarithm(moved);
  }
  return segment;
}

MotionSegment OdometryBuffer::beyond(Iterator newest,
                                     std::int64_t from_ns,
                                     std::int64_t to_ns) const {
  MotionSegment segment;
  segment.duration_s = secondsBetween(from_ns, to_ns);
  segment.increment = latestTwist(newest) * segment.duration_s;
  // A constant unknown acceleration a displaces by a t^2 / 2 in the time t since the newest sample.
  const double start_s = secondsBetween(newest->sample.stamp_ns, from_ns);
  const double end_s = secondsBetween(newest->sample.stamp_ns, to_ns);
  const double growth_s4 = (std::pow(end_s, 4) - std::pow(start_s, 4)) / 4.0;
  const double forward_variance = std::pow(parameters_.acceleration_sigma_mps2, 2) * growth_s4;
  const double turn_variance = std::pow(parameters_.turn_acceleration_sigma_radps2, 2) * growth_s4;
  segment.added_variance = {forward_variance, forward_variance, turn_variance};
  return segment;
}

Eigen::Vector3d OdometryBuffer::latestTwist(Iterator newest) const {
  Iterator start = newest;
  double baseline_s = 0.0;
  while (baseline_s < parameters_.twist_baseline_s && start != entries_.begin() &&
         start->standing == Standing::kAccepted) {
    --start;
    while (start->standing == Standing::kHeldBack) --start;
    baseline_s = secondsBetween(start->sample.stamp_ns, newest->sample.stamp_ns);
  }
  if (baseline_s < parameters_.twist_baseline_s || baseline_s > parameters_.gap_s)
    return newest->sample.twist;
  return ram_slam::logarithm(start->sample.odom_from_base.inverse() *
                             newest->sample.odom_from_base) /
         baseline_s;
}

void OdometryBuffer::requireCovered(std::int64_t from_ns, std::int64_t to_ns) const {
  if (from_ns <= 0 || to_ns <= 0) throw std::invalid_argument("a stamp of the interval is zero");
  if (to_ns < from_ns) {
    throw std::invalid_argument("interval ends (" + toText(to_ns) + ") before it starts (" +
                                toText(from_ns) + ")");
  }
  if (empty()) throw OdometryUnavailable(Unavailable::kNoOdometry, "no odometry received yet");
  if (from_ns < oldestNs()) {
    refuse(has_forgotten_ ? Unavailable::kTooOld : Unavailable::kBeforeFirst,
           "from " + toText(from_ns) + " is too old");
  }
  if (to_ns > newestNs() + toNanoseconds(parameters_.max_extrapolation_s)) {
    std::string held_back;
    if (entries_.back().standing == Standing::kHeldBack) {
      held_back = ": the newest is faster than twice max_speed_mps (" +
                  std::to_string(parameters_.max_speed_mps) + ") or max_turn_rate_radps (" +
                  std::to_string(parameters_.max_turn_rate_radps) + ")";
    }
    refuse(Unavailable::kNotYetAvailable,
           "no odometry up to " + toText(to_ns) + " yet" + held_back);
  }
}

void OdometryBuffer::refuse(Unavailable reason, const std::string& what) const {
  throw OdometryUnavailable(
      reason, what + "; buffered are " + toText(oldestNs()) + " to " + toText(newestNs()));
}

}  // namespace ramscout_kinematics
