// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/landmark_existence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ram_slam {

LandmarkExistence::LandmarkExistence(const FastSlamParameters& parameters,
                                     const std::vector<Particle>& particles,
                                     const std::vector<double>& weights)
    : parameters_(parameters) {
  // Equally spaced on the weight axis, as in resampleLowVariance(): each stands for as much weight.
  const int shares = parameters.existence.sampled_particles;
  double passed = 0.0;
  int chosen = 0;
  for (std::size_t k = 0; k < particles.size(); ++k) {
    passed += weights[k];
    const int up_to = std::min(shares, static_cast<int>(passed * shares + 0.5));
    if (up_to == chosen) continue;
    representatives_.push_back(
        {&particles[k], particles[k].map_from_base.rotation().transpose(), up_to - chosen});
    chosen = up_to;
  }
}

std::vector<LandmarkId> LandmarkExistence::update(LandmarkRegistry& registry,
                                                  const FieldOfView* view,
                                                  const Pose2& map_from_base) const {
  const double seen =
      std::log(parameters_.detection_probability / parameters_.false_detection_probability);
  std::vector<LandmarkId> refuted;
  for (LandmarkRecord& record : registry.records()) {
    const double unseen_weight = 1.0 - record.matched_weight;
    double evidence = record.matched_weight * seen;
    record.matched_weight = 0.0;
    MissingEvidence missing;
    if (view != nullptr && unseen_weight > 0.0)
      missing = missingEvidence(record, *view, map_from_base);
    evidence += unseen_weight * (missing.overlooked + missing.passed);
    if (evidence == 0.0) continue;
    // A detector may overlook what was confirmed once: only a view through its place removes it.
    const double least =
        record.was_confirmed && !(missing.passed < 0.0)
            ? std::min(record.existence_log_odds, parameters_.existence.overlooked_log_odds)
            : -std::numeric_limits<double>::infinity();
    record.existence_log_odds =
        std::clamp(record.existence_log_odds + evidence, least, parameters_.maximum_log_odds);
    record.was_confirmed =
        record.was_confirmed || record.existence_log_odds >= parameters_.confirm_log_odds;
    if (record.existence_log_odds < parameters_.delete_log_odds) refuted.push_back(record.id);
  }
  return refuted;
}

LandmarkExistence::MissingEvidence LandmarkExistence::missingEvidence(
    const LandmarkRecord& record, const FieldOfView& view, const Pose2& map_from_base) const {
  // Where it was never seen from as far, it is not missed.
  const double reach_m =
      view.showsEverySide() ? view.range_m() : std::min(view.range_m(), record.seen_within_m);
  if (record.bounds_m.exteriorDistance(map_from_base.translation()) > reach_m) return {};
  const double missed = std::log((1.0 - parameters_.detection_probability) /
                                 (1.0 - parameters_.false_detection_probability));
  MissingEvidence sum;
  int held_count = 0;
  for (const Representative& representative : representatives_) {
    const Landmark* landmark = representative.particle->landmarks.find(record.id);
    if (landmark == nullptr) continue;
    held_count += representative.count;
    const Eigen::Vector2d from_robot_m =
        landmark->mean_m - representative.particle->map_from_base.translation();
    const Sight sight = sightBeside(view, representative.base_from_map * from_robot_m);
    if (sight == Sight::kEmpty) {
      sum.passed += representative.count * parameters_.existence.passed_log_odds;
    } else if (sight == Sight::kVisible &&
               (view.showsEverySide() || knownFrom(record, -from_robot_m))) {
      sum.overlooked += representative.count * missed;
    }
  }
  if (held_count == 0) return {};
  return {sum.overlooked / held_count, sum.passed / held_count};
}

Sight LandmarkExistence::sightBeside(const FieldOfView& view,
                                     const Eigen::Vector2d& point_in_base_m) const {
  const double margin_m = parameters_.existence.edge_margin_m;
  const Sight sight = view.look(point_in_base_m);
  const double range_m = point_in_base_m.norm();
  if (sight != Sight::kEmpty || range_m <= margin_m) return sight;
  const Eigen::Vector2d aside_m =
      margin_m / range_m * Eigen::Vector2d(-point_in_base_m.y(), point_in_base_m.x());
  const bool empty = view.look(point_in_base_m + aside_m) == Sight::kEmpty &&
                     view.look(point_in_base_m - aside_m) == Sight::kEmpty;
  return empty ? Sight::kEmpty : Sight::kHidden;
}

}  // namespace ram_slam
