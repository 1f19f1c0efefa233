// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/lost_detector.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "ram_slam/tracking/duration.hpp"

namespace ram_slam {

const ram_parameters::ParameterTable<LostDetectorParameters>& LostDetectorParameters::table() {
  using P = LostDetectorParameters;
  using namespace ram_parameters;
  static const auto table =
      ParameterTable<P>()
          .add("window", &P::window, "s", positive(),
               "Or the robot is lost if within this time ...")
          .add("minimum_evidence", &P::minimum_evidence, "", atLeast(1),
               "... so many landmarks should have been seen and so many features are where the map "
               "holds nothing, ...")
          .add("lost_below", &P::lost_below, "", within(0.0, 1.0),
               "... and less than this share of those landmarks was found.")
          .expert("Whether the map agrees with the pose")
          .add("landmark_match_distance", &P::match_distance, "m", positive(),
               "A feature nearer than this to a landmark of its type shows it.")
          .add("unexplained_cell_m", &P::unexplained_cell_m, "m", positive(),
               "Side of the squares of which each counts as one feature that no landmark explains.")
          .add("suspicious_evidence", &P::suspicious_evidence, "", atLeast(1),
               "As minimum_evidence, after a contradiction below the threshold `discontinuity`.")
          .add("suspicious_quality", &P::suspicious_quality, "", within(0.0, 1.0),
               "As lost_below, after a contradiction below the threshold `discontinuity`.")
          .add("evidence_path_m", &P::evidence_path_m, "m", positive(),
               "A landmark that was not seen for so much driving is no evidence: where a loop "
               "closes, drift alone moves it.")
          .add(
              "view_tolerance_m", &P::view_tolerance_m, "m", atLeast(0.0),
              "A pose may be off by this without being wrong: what a view shows at a landmark must "
              "hold that far around it.");
  return table;
}

LostDetector::LostDetector(const LostDetectorParameters& parameters, double confirm_log_odds)
    : parameters_((parameters.validate(), parameters)), confirm_log_odds_(confirm_log_odds) {}

void LostDetector::clear() {
  sightings_.clear();
  unexplained_ns_.clear();
}

void LostDetector::add(const Reading& reading, double path_m) {
  const FeatureList& list = reading.features;
  const Pose2& map_from_base = reading.particle.proposal.pose;
  const Eigen::Matrix2d base_from_map = map_from_base.rotation().transpose();
  double reach_m = reading.view == nullptr ? 0.0 : reading.view->range_m();
  for (const Feature& feature : list.features)
    reach_m = std::max(reach_m, feature.position_m.norm() + parameters_.match_distance);
  std::vector<bool> explained(list.features.size(), false);
  reading.particle.landmarks.forEach([&](LandmarkId id, const Landmark& landmark) {
    const Eigen::Vector2d expected_m =
        base_from_map * (landmark.mean_m - map_from_base.translation());
    if (expected_m.squaredNorm() > reach_m * reach_m) return;
    const LandmarkRecord* record = reading.registry.find(id);
    if (record == nullptr) return;
    const bool found = matchFeatures(list, expected_m, record->type, explained);
    if (found) seen_at_m_[id] = path_m;
    if (record->existence_log_odds < confirm_log_odds_) return;
    if (found) {
      sightings_[id].found_ns = list.stamp_ns;
    } else if (reading.view != nullptr && expected_m.norm() <= reading.view->range_m() &&
               isEvidence(id, path_m)) {
      addMissing(reading, *record, expected_m, map_from_base.translation() - landmark.mean_m);
    }
  });
  addUnexplained(reading, explained);
  forget(list.stamp_ns);
}

bool LostDetector::matchFeatures(const FeatureList& list,
                                 const Eigen::Vector2d& expected_m,
                                 const std::string& type,
                                 std::vector<bool>& explained) const {
  bool found = false;
  for (std::size_t i = 0; i < list.features.size(); ++i) {
    const Feature& feature = list.features[i];
    if (feature.type != type ||
        (feature.position_m - expected_m).norm() > parameters_.match_distance) {
      continue;
    }
    found = explained[i] = true;
  }
  return found;
}

void LostDetector::addMissing(const Reading& reading,
                              const LandmarkRecord& record,
                              const Eigen::Vector2d& expected_m,
                              const Eigen::Vector2d& robot_from_landmark_m) {
  const std::int64_t now_ns = reading.features.stamp_ns;
  const Sight sight = sightAround(*reading.view, expected_m);
  if (sight == Sight::kEmpty) sightings_[record.id].looked_through_ns = now_ns;
  if (sight == Sight::kVisible && knownFrom(record, robot_from_landmark_m))
    sightings_[record.id].missed_ns = now_ns;
}

void LostDetector::addUnexplained(const Reading& reading, const std::vector<bool>& explained) {
  const Pose2& map_from_base = reading.particle.proposal.pose;
  for (std::size_t i = 0; i < explained.size(); ++i) {
    if (explained[i]) continue;
    const Eigen::Vector2d cell =
        (map_from_base * reading.features.features[i].position_m) / parameters_.unexplained_cell_m;
    unexplained_ns_[{static_cast<int>(std::floor(cell.x())),
                     static_cast<int>(std::floor(cell.y()))}] = reading.features.stamp_ns;
  }
}

Sight LostDetector::sightAround(const FieldOfView& view, const Eigen::Vector2d& point_m) const {
  const Sight sight = view.look(point_m);
  for (const Eigen::Vector2d& side : {Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(-1.0, 0.0),
                                      Eigen::Vector2d(0.0, 1.0), Eigen::Vector2d(0.0, -1.0)}) {
    const Sight beside = view.look(point_m + parameters_.view_tolerance_m * side);
    if (beside == Sight::kHidden) return Sight::kHidden;
    if (sight == Sight::kEmpty && beside == Sight::kVisible) return Sight::kVisible;
  }
  return sight;
}

bool LostDetector::isEvidence(LandmarkId id, double path_m) const {
  const auto seen = seen_at_m_.find(id);
  const double known_at_m =
      seen == seen_at_m_.end() ? map_trusted_at_m_ : std::max(seen->second, map_trusted_at_m_);
  return path_m - known_at_m < parameters_.evidence_path_m;
}

void LostDetector::forget(std::int64_t now_ns) {
  const std::int64_t oldest_ns = now_ns - toNanoseconds(parameters_.window);
  const auto fade = [oldest_ns](std::int64_t& stamp_ns) {
    if (stamp_ns < oldest_ns) stamp_ns = 0;
  };
  for (auto entry = sightings_.begin(); entry != sightings_.end();) {
    Sightings& seen = entry->second;
    fade(seen.found_ns);
    fade(seen.missed_ns);
    fade(seen.looked_through_ns);
    const bool empty = seen.found_ns == 0 && seen.missed_ns == 0 && seen.looked_through_ns == 0;
    entry = empty ? sightings_.erase(entry) : std::next(entry);
  }
  for (auto entry = unexplained_ns_.begin(); entry != unexplained_ns_.end();)
    entry = entry->second < oldest_ns ? unexplained_ns_.erase(entry) : std::next(entry);
}

MapAgreement LostDetector::agreement() const {
  MapAgreement sum;
  for (const auto& [id, seen] : sightings_) {
    ++sum.expected_count;
    if (seen.found_ns != 0) {
      ++sum.found_count;
    } else if (seen.looked_through_ns != 0) {
      ++sum.looked_through_count;
    }
  }
  sum.unexplained_count = static_cast<int>(unexplained_ns_.size());
  return sum;
}

bool LostDetector::lost(bool suspicious) const {
  const MapAgreement now = agreement();
  if (suspicious && now.expected_count >= parameters_.suspicious_evidence &&
      now.unexplained_count >= parameters_.suspicious_evidence &&
      now.quality() < parameters_.suspicious_quality) {
    return true;
  }
  return now.expected_count >= parameters_.minimum_evidence &&
         now.unexplained_count >= parameters_.minimum_evidence &&
         now.quality() < parameters_.lost_below;
}

}  // namespace ram_slam
