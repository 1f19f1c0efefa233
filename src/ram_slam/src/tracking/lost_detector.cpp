// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/lost_detector.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "ram_parameters/require.hpp"

namespace ram_slam {
namespace {

constexpr double kCell_m = 0.5;
constexpr int kSuspiciousEvidence = 2;
constexpr double kSuspiciousQuality = 0.35;
constexpr double kEvidencePath_m = 10.0;
// A pose may be this much off without being wrong: what a view says must hold that far around.
constexpr double kAround_m = 0.3;

Sight lookAround(const FieldOfView& view, const Eigen::Vector2d& point_m) {
  const Sight sight = view.look(point_m);
  for (const Eigen::Vector2d& side : {Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(-1.0, 0.0),
                                      Eigen::Vector2d(0.0, 1.0), Eigen::Vector2d(0.0, -1.0)}) {
    const Sight beside = view.look(point_m + kAround_m * side);
    if (beside == Sight::kHidden) return Sight::kHidden;
    if (sight == Sight::kEmpty && beside == Sight::kVisible) return Sight::kVisible;
  }
  return sight;
}

using ram_parameters::require;

}  // namespace

void LostDetectorParameters::validate() const {
  require(window > 0.0, "window", window, "> 0");
  require(match_distance > 0.0, "match_distance", match_distance, "> 0");
  require(minimum_evidence >= 1, "minimum_evidence", minimum_evidence, ">= 1");
  require(0.0 <= lost_below && lost_below <= 1.0, "lost_below", lost_below, "in [0, 1]");
  require(0.0 < contradiction && contradiction <= 1.0, "contradiction", contradiction, "in (0, 1]");
  require(0.0 < discontinuity && discontinuity <= 1.0, "discontinuity", discontinuity, "in (0, 1]");
}

LostDetector::LostDetector(const LostDetectorParameters& parameters) : parameters_(parameters) {
  parameters_.validate();
}

void LostDetector::clear() {
  looks_.clear();
  unexplained_ns_.clear();
}

void LostDetector::add(const FeatureList& list,
                       const FieldOfView* view,
                       const Particle& particle,
                       const LandmarkRegistry& registry,
                       double confirm_log_odds,
                       double path_m) {
  const Pose2& map_from_base = particle.proposal.pose;
  const Eigen::Matrix2d base_from_map = map_from_base.rotation().transpose();
  double reach_m = view == nullptr ? 0.0 : view->range_m();
  for (const Feature& feature : list.features)
    reach_m = std::max(reach_m, feature.position_m.norm() + parameters_.match_distance);
  std::vector<bool> explained(list.features.size(), false);
  particle.landmarks.forEach([&](LandmarkId id, const Landmark& landmark) {
    const Eigen::Vector2d expected_m =
        base_from_map * (landmark.mean_m - map_from_base.translation());
    if (expected_m.squaredNorm() > reach_m * reach_m) return;
    const LandmarkRecord* record = registry.find(id);
    if (record == nullptr) return;
    bool found = false;
    for (std::size_t i = 0; i < list.features.size(); ++i) {
      const Feature& feature = list.features[i];
      if (feature.type != record->type ||
          (feature.position_m - expected_m).norm() > parameters_.match_distance) {
        continue;
      }
      found = explained[i] = true;
      seen_at_m_[id] = path_m;
    }
    if (record->existence_log_odds < confirm_log_odds) return;
    if (found) {
      looks_[id].found_ns = list.stamp_ns;
      return;
    }
    if (view == nullptr || expected_m.norm() > view->range_m() || !isEvidence(id, path_m)) return;
    const Sight sight = lookAround(*view, expected_m);
    if (sight == Sight::kEmpty) looks_[id].looked_through_ns = list.stamp_ns;
    if (sight == Sight::kVisible &&
        knownFrom(*record, map_from_base.translation() - landmark.mean_m)) {
      looks_[id].missed_ns = list.stamp_ns;
    }
  });
  for (std::size_t i = 0; i < explained.size(); ++i) {
    if (explained[i]) continue;
    const Eigen::Vector2d cell = (map_from_base * list.features[i].position_m) / kCell_m;
    unexplained_ns_[{static_cast<int>(std::floor(cell.x())),
                     static_cast<int>(std::floor(cell.y()))}] = list.stamp_ns;
  }
  forget(list.stamp_ns);
}

bool LostDetector::isEvidence(LandmarkId id, double path_m) const {
  const auto seen = seen_at_m_.find(id);
  const double known_at_m =
      seen == seen_at_m_.end() ? map_trusted_at_m_ : std::max(seen->second, map_trusted_at_m_);
  return path_m - known_at_m < kEvidencePath_m;
}

void LostDetector::forget(std::int64_t now_ns) {
  const std::int64_t oldest_ns = now_ns - static_cast<std::int64_t>(parameters_.window * 1e9);
  const auto fade = [oldest_ns](std::int64_t& stamp_ns) {
    if (stamp_ns < oldest_ns) stamp_ns = 0;
  };
  for (auto entry = looks_.begin(); entry != looks_.end();) {
    Looks& looks = entry->second;
    fade(looks.found_ns);
    fade(looks.missed_ns);
    fade(looks.looked_through_ns);
    const bool empty = looks.found_ns == 0 && looks.missed_ns == 0 && looks.looked_through_ns == 0;
    entry = empty ? looks_.erase(entry) : std::next(entry);
  }
  for (auto entry = unexplained_ns_.begin(); entry != unexplained_ns_.end();)
    entry = entry->second < oldest_ns ? unexplained_ns_.erase(entry) : std::next(entry);
}

MapAgreement LostDetector::agreement() const {
  MapAgreement sum;
  for (const auto& [id, looks] : looks_) {
    ++sum.expected_count;
    if (looks.found_ns != 0) {
      ++sum.found_count;
    } else if (looks.looked_through_ns != 0) {
      ++sum.looked_through_count;
    }
  }
  sum.unexplained_count = static_cast<int>(unexplained_ns_.size());
  return sum;
}

bool LostDetector::lost(bool suspicious) const {
  const MapAgreement now = agreement();
  if (suspicious && now.expected_count >= kSuspiciousEvidence &&
      now.unexplained_count >= kSuspiciousEvidence && now.quality() < kSuspiciousQuality) {
    return true;
  }
  return now.expected_count >= parameters_.minimum_evidence &&
         now.unexplained_count >= parameters_.minimum_evidence &&
         now.quality() < parameters_.lost_below;
}

}  // namespace ram_slam
