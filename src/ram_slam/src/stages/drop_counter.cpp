// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/drop_counter.hpp"

#include <algorithm>

namespace ram_slam {

std::string toText(DropReason reason) {
  switch (reason) {
    case DropReason::kNotLater:
      return "stamp not later than the one before";
    case DropReason::kOtherClock:
      return "stamp of another clock than the others";
    case DropReason::kInvalidScan:
      return "unusable scan";
    case DropReason::kInvalidOdometry:
      return "unusable odometry";
    case DropReason::kInvalidFeatures:
      return "unusable features";
    case DropReason::kInvalidTrajectory:
      return "unusable trajectory";
    case DropReason::kMapPoseAway:
      return "pose in the smoother's map far from the estimator's";
    case DropReason::kNoOdometry:
      return "no odometry at the stamp";
    case DropReason::kNoMount:
      return "no transform from the sensor to the base";
    case DropReason::kNoMotion:
      return "no motion up to the stamp";
    case DropReason::kNoPose:
      return "no pose in the map at the stamp";
    case DropReason::kQueueFull:
      return "queue full";
    case DropReason::kMapFull:
      return "map at its size limit";
    case DropReason::kPaused:
      return "paused";
    case DropReason::kLost:
      return "robot lost at the stamp";
  }
  return "";
}

void DropCounter::add(DropReason reason, std::int64_t stamp_ns, const std::string& detail) {
  Drops& drops = drops_[reason];
  if (drops.count == 0) drops.first_ns = stamp_ns;
  drops.reason = reason;
  drops.last_ns = stamp_ns;
  drops.detail = detail;
  ++drops.count;
  ++total_;
  newest_ = reason;
}

void DropCounter::add(const DropCounter& other) {
  for (const auto& [reason, theirs] : other.drops_) {
    Drops& drops = drops_[reason];
    if (drops.count == 0) {
      drops = theirs;
      continue;
    }
    drops.count += theirs.count;
    drops.first_ns = std::min(drops.first_ns, theirs.first_ns);
    if (theirs.last_ns < drops.last_ns) continue;
    drops.last_ns = theirs.last_ns;
    drops.detail = theirs.detail;
  }
  if (other.total_ > 0) newest_ = other.newest_;
  total_ += other.total_;
}

std::vector<Drops> DropCounter::all() const {
  std::vector<Drops> all;
  for (const auto& [reason, drops] : drops_) all.push_back(drops);
  return all;
}

}  // namespace ram_slam
