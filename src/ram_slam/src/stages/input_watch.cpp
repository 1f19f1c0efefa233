// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/input_watch.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace ram_slam {

void InputWatch::arrived(const std::string& publisher, double stamp_age_s, double now_s) {
  arrivals_.push_back({now_s, stamp_age_s});
  while (arrivals_.size() > 2 && arrivals_.front().now_s < now_s - kWindow_s) arrivals_.pop_front();
  newest_publisher_ = publisher;
  ++arrival_count_;
}

void InputWatch::refused(const std::string& reason, double now_s) {
  if (refused_count_ + 1 < arrival_count_ || refused_count_ == 0) refused_since_s_ = now_s;
  refused_count_ = arrival_count_;
  refusal_ = reason;
}

void InputWatch::report(double now_s, InputFacts& facts) const {
  if (arrivals_.empty()) return;
  facts.age_s = now_s - arrivals_.back().now_s;
  facts.newest_publisher = newest_publisher_;
  if (arrivals_.size() > 1) {
    facts.interval_s = (arrivals_.back().now_s - arrivals_.front().now_s) /
                       static_cast<double>(arrivals_.size() - 1);
  }
  facts.stamp_age_s = arrivals_.back().stamp_age_s;
  for (const Arrival& arrival : arrivals_) {
    if (std::abs(arrival.stamp_age_s) < std::abs(facts.stamp_age_s))
      facts.stamp_age_s = arrival.stamp_age_s;
  }
  const bool is_refused = refused_count_ == arrival_count_ &&
                          arrivals_.back().now_s - refused_since_s_ >= kRefusedFor_s;
  facts.refusal = is_refused ? refusal_ : "";
}

double InputWatch::rate_hz(double now_s) const {
  if (arrivals_.size() < 2 || arrivals_.back().now_s < now_s - kWindow_s) return 0.0;
  const double covered_s = arrivals_.back().now_s - arrivals_.front().now_s;
  return covered_s > 0.0 ? static_cast<double>(arrivals_.size() - 1) / covered_s : 0.0;
}

void LatencyWatch::arrived(std::int64_t stamp_ns, double now_s) {
  waiting_.push_back({stamp_ns, now_s});
  if (waiting_.size() > kMostWaiting) waiting_.pop_front();
}

void LatencyWatch::answered(std::int64_t stamp_ns, double now_s) {
  const auto found = std::find_if(waiting_.begin(), waiting_.end(), [stamp_ns](const Waiting& one) {
    return one.stamp_ns == stamp_ns;
  });
  if (found == waiting_.end()) return;
  latencies_s_.push_back(now_s - found->now_s);
  if (latencies_s_.size() > kMostLatencies) latencies_s_.pop_front();
  waiting_.erase(waiting_.begin(), std::next(found));
}

double LatencyWatch::percentile_s(double share) const {
  if (latencies_s_.empty()) return 0.0;
  std::vector<double> sorted(latencies_s_.begin(), latencies_s_.end());
  const auto place = static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(place),
                   sorted.end());
  return sorted[place];
}

}  // namespace ram_slam
