// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "ram_slam/stages/clock_guard.hpp"
#include "ram_slam/stages/drop_counter.hpp"

namespace ram_slam {

/// Messages that may be used now, in the order in which they came.
template <typename Message>
struct PassedMessages {
  std::vector<Message> messages;
  bool is_set_back = false;  ///< the clock was set back: these are the first after that
};

/// The door of every stream of stamped messages: decides whether a stamp that leaps is a stray one
/// or shows that the clock has changed. A message whose stamp leaps is held until the next ones
/// show which is right, so that a single wrong stamp changes nothing:
///
/// - Later than a second after the newest one (or three times the usual interval): passes with the
///   next message, if that is later still.
/// - More than a second older: the clock was set back if messages of the new clock cover one second
///   and none of the old clock came between them.
/// - Otherwise it is dropped and counted.
///
/// A source whose own stamps go on is merely late, and never sets the clock back.
template <typename Message>
class InputGuard {
public:
  /// \param source  the publisher, where one stream has several
  PassedMessages<Message> add(std::int64_t stamp_ns,
                              Message message,
                              DropCounter& drops,
                              const std::string& source = "") {
    if (isOfThisClock(stamp_ns)) {
      dropHeld(drops);
      remember(stamp_ns, source);
      return {single(std::move(message)), false};
    }
    if (isLate(stamp_ns, source)) {
      newest_by_source_[source] = std::max(newest_by_source_[source], stamp_ns);
      drops.add(DropReason::kOtherClock, stamp_ns, detail(stamp_ns));
      return {};
    }
    if (!held_.empty() && (!continuesHeld(stamp_ns) || held_.size() >= kMostHeld)) dropHeld(drops);
    held_.push_back({stamp_ns, source, std::move(message)});
    return isConfirmed() ? releaseHeld() : PassedMessages<Message>{};
  }

  /// No message comes any more: gives what is held and is ahead.
  PassedMessages<Message> finish(DropCounter& drops) {
    if (!held_.empty() && held_.front().stamp_ns > newest_ns_) return releaseHeld();
    dropHeld(drops);
    return {};
  }

private:
  static constexpr std::int64_t kLeapNs = ClockGuard::kSetBackNs;
  static constexpr std::int64_t kUsualIntervals = 3;  ///< one or two messages may be missing
  static constexpr std::size_t kMostHeld = 2000;      ///< a second of the fastest sensors

  struct Held {
    std::int64_t stamp_ns;
    std::string source;
    Message message;
  };

  static std::vector<Message> single(Message message) {
    std::vector<Message> messages;
    messages.push_back(std::move(message));
    return messages;
  }

  bool isOfThisClock(std::int64_t stamp_ns) const {
    return newest_ns_ == 0 ||
           (!ClockGuard::isSetBack(newest_ns_, stamp_ns) &&
            stamp_ns <= newest_ns_ + std::max(kLeapNs, kUsualIntervals * interval_ns_));
  }
  bool isLate(std::int64_t stamp_ns, const std::string& source) const {
    const auto own = newest_by_source_.find(source);
    return stamp_ns < newest_ns_ && own != newest_by_source_.end() &&
           !ClockGuard::isSetBack(own->second, stamp_ns);
  }
  bool continuesHeld(std::int64_t stamp_ns) const {
    const bool is_same_side = (stamp_ns < newest_ns_) == (held_.back().stamp_ns < newest_ns_);
    return is_same_side && !ClockGuard::isSetBack(held_.back().stamp_ns, stamp_ns);
  }
  bool isConfirmed() const {
    const std::int64_t covered_ns = held_.back().stamp_ns - held_.front().stamp_ns;
    return held_.front().stamp_ns > newest_ns_ ? covered_ns > 0 : covered_ns >= kLeapNs;
  }

  void remember(std::int64_t stamp_ns, const std::string& source) {
    if (newest_ns_ != 0 && stamp_ns > newest_ns_) interval_ns_ = stamp_ns - newest_ns_;
    newest_ns_ = std::max(newest_ns_, stamp_ns);
    newest_by_source_[source] = std::max(newest_by_source_[source], stamp_ns);
  }
  PassedMessages<Message> releaseHeld() {
    PassedMessages<Message> passed;
    passed.is_set_back = held_.front().stamp_ns < newest_ns_;
    newest_ns_ = 0;
    newest_by_source_.clear();
    for (Held& held : held_) {
      remember(held.stamp_ns, held.source);
      passed.messages.push_back(std::move(held.message));
    }
    held_.clear();
    return passed;
  }
  void dropHeld(DropCounter& drops) {
    for (const Held& held : held_)
      drops.add(DropReason::kOtherClock, held.stamp_ns, detail(held.stamp_ns));
    held_.clear();
  }
  std::string detail(std::int64_t stamp_ns) const {
    char text[96];
    std::snprintf(text, sizeof(text), "%.3f s %s than the others; check its publisher's clock",
                  1e-9 * std::abs(static_cast<double>(stamp_ns - newest_ns_)),
                  stamp_ns < newest_ns_ ? "older" : "newer");
    return text;
  }

  std::int64_t newest_ns_ = 0;    ///< 0: none yet
  std::int64_t interval_ns_ = 0;  ///< between the newest two
  std::map<std::string, std::int64_t> newest_by_source_;
  std::vector<Held> held_;
};

}  // namespace ram_slam
