// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "ram_slam/fast_slam/fast_slam.hpp"

namespace ram_slam {
namespace {

constexpr double kPassedLogOdds = -2.0;  // a look well past a landmark
// What was sure once is doubted down to this because a detector overlooks it, and deleted only
// where a view goes through it.
constexpr double kOverlookedLogOdds = 0.0;
constexpr int kWitnesses = 10;    // particles that are asked whether a landmark is missing
constexpr double kAside_m = 0.1;  // beside an edge a view goes past it: so far it must be empty

/// What the view says about a point that is known to some centimetres.
Sight lookBeside(const FieldOfView& view, const Eigen::Vector2d& point_in_base_m) {
  const Sight sight = view.look(point_in_base_m);
  const double range_m = point_in_base_m.norm();
  if (sight != Sight::kEmpty || range_m <= kAside_m) return sight;
  const Eigen::Vector2d aside_m =
      kAside_m / range_m * Eigen::Vector2d(-point_in_base_m.y(), point_in_base_m.x());
  const bool empty = view.look(point_in_base_m + aside_m) == Sight::kEmpty &&
                     view.look(point_in_base_m - aside_m) == Sight::kEmpty;
  return empty ? Sight::kEmpty : Sight::kHidden;
}

}  // namespace

void FastSlam::collectEvidence(const FieldOfView* view) {
  const double seen =
      std::log(parameters_.detection_probability / parameters_.false_detection_probability);
  const std::vector<Witness> witnesses =
      view == nullptr ? std::vector<Witness>{} : this->witnesses();
  std::vector<LandmarkId> refuted;
  for (LandmarkRecord& record : registry_.records()) {
    const double unseen_weight = 1.0 - record.matched_weight;
    double evidence = record.matched_weight * seen;
    record.matched_weight = 0.0;
    Doubt doubt;
    if (view != nullptr && unseen_weight > 0.0) doubt = doubtOf(record, *view, witnesses);
    evidence += unseen_weight * (doubt.overlooked + doubt.passed);
    if (evidence == 0.0) continue;
    const bool looked_through = doubt.passed < 0.0;
    const double least = record.was_confirmed && !looked_through
                             ? std::min(record.existence_log_odds, kOverlookedLogOdds)
                             : -std::numeric_limits<double>::infinity();
    record.existence_log_odds =
        std::clamp(record.existence_log_odds + evidence, least, parameters_.maximum_log_odds);
    record.was_confirmed =
        record.was_confirmed || record.existence_log_odds >= parameters_.confirm_log_odds;
    if (record.existence_log_odds < parameters_.delete_log_odds) refuted.push_back(record.id);
  }
  for (const LandmarkId id : refuted) remove(id);
}

std::vector<FastSlam::Witness> FastSlam::witnesses() const {
  // Equally spaced on the weight axis, as in resampleLowVariance(): each stands for as much weight.
  const std::vector<double> weights = this->weights();
  std::vector<Witness> witnesses;
  double passed = 0.0;
  int chosen = 0;
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    passed += weights[k];
    const int up_to = std::min(kWitnesses, static_cast<int>(passed * kWitnesses + 0.5));
    if (up_to == chosen) continue;
    witnesses.push_back(
        {&particles_[k], particles_[k].map_from_base.rotation().transpose(), up_to - chosen});
    chosen = up_to;
  }
  return witnesses;
}

FastSlam::Doubt FastSlam::doubtOf(const LandmarkRecord& record,
                                  const FieldOfView& view,
                                  const std::vector<Witness>& witnesses) const {
  // Where it was never seen from as far, it is not missed.
  const double reach_m =
      view.showsEverySide() ? view.range_m() : std::min(view.range_m(), record.seen_within_m);
  if (record.bounds_m.exteriorDistance(estimate_.pose.translation()) > reach_m) return {};
  const double missed = std::log((1.0 - parameters_.detection_probability) /
                                 (1.0 - parameters_.false_detection_probability));
  Doubt sum;
  int held_count = 0;
  for (const Witness& witness : witnesses) {
    const Landmark* landmark = witness.particle->landmarks.find(record.id);
    if (landmark == nullptr) continue;
    held_count += witness.count;
    const Eigen::Vector2d from_robot_m =
        landmark->mean_m - witness.particle->map_from_base.translation();
    const Sight sight = lookBeside(view, witness.base_from_map * from_robot_m);
    if (sight == Sight::kEmpty) {
      sum.passed += witness.count * kPassedLogOdds;
    } else if (sight == Sight::kVisible &&
               (view.showsEverySide() || knownFrom(record, -from_robot_m))) {
      sum.overlooked += witness.count * missed;
    }
  }
  if (held_count == 0) return {};
  return {sum.overlooked / held_count, sum.passed / held_count};
}

void FastSlam::remove(LandmarkId id) {
  registry_.remove(id);
  for (Particle& particle : particles_) particle.landmarks.erase(id);
}

void FastSlam::forgetAbandoned() {
  std::vector<LandmarkId> abandoned;
  for (const LandmarkRecord& record : registry_.records()) {
    const bool held =
        particles_[best_].landmarks.find(record.id) != nullptr ||
        std::any_of(particles_.begin(), particles_.end(), [&record](const Particle& particle) {
          return particle.landmarks.find(record.id) != nullptr;
        });
    if (!held) abandoned.push_back(record.id);
  }
  for (const LandmarkId id : abandoned) registry_.remove(id);
}

}  // namespace ram_slam
