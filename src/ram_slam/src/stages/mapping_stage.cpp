// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/mapping_stage.hpp"

#include <exception>
#include <stdexcept>
#include <utility>

namespace ram_slam {

MappingStage::MappingStage(const OccupancyMapperParameters& parameters,
                           std::vector<PlacedScan> loaded)
    : parameters_(parameters), map_(parameters, std::move(loaded)), gate_(!map_.loaded().empty()) {}

int MappingStage::set(const Tracking& tracking) {
  gate_.set(tracking);
  return tracking.is_lost ? map_.removeAfter(tracking.certain_until_ns) : 0;
}

void MappingStage::add(const MountedScan& scan,
                       const Pose2& map_from_base,
                       const Pose2& last_beam) {
  const std::int64_t stamp_ns = scan.scan.stamp_ns;
  const StampOrder order = clock_.check(stamp_ns);
  if (order == StampOrder::kNotLater) {
    drops_.add(DropReason::kNotLater, stamp_ns, "scan");
    return;
  }
  if (order == StampOrder::kSetBack) {
    reset();
    clock_.check(stamp_ns);
  }
  if (!gate_.admits(stamp_ns)) {
    drops_.add(DropReason::kLost, stamp_ns, "scan");
    return;
  }
  try {
    map_.add(scan.scan, map_from_base, scan.base_from_laser, last_beam);
  } catch (const std::exception& error) {
    drops_.add(DropReason::kInvalidScan, stamp_ns, error.what());
  }
}

BeamCounts MappingStage::draw() {
  return map_.draw([this](std::int64_t stamp_ns, const std::exception& error) {
    drops_.add(DropReason::kMapFull, stamp_ns, error.what());
  });
}

void MappingStage::reset() {
  map_ = KeyScanMap(parameters_, map_.loaded());
  clock_ = {};
  gate_ = TrackingGate(!map_.loaded().empty());
  ++reset_count_;
}

}  // namespace ram_slam
