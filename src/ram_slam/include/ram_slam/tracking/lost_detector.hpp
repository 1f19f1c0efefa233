// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <map>

#include "ram_slam/fast_slam/landmark_registry.hpp"
#include "ram_slam/fast_slam/particle.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/sensing/field_of_view.hpp"

namespace ram_slam {

struct LostDetectorParameters {
  /// [s] of readings that are judged together.
  double window = 2.0;
  /// [m] a feature nearer than this to a landmark of its type shows it.
  double match_distance = 0.4;
  /// Landmarks that should have been seen, and as many features that no landmark explains: with
  /// fewer there is no verdict.
  int minimum_evidence = 3;
  /// The robot is lost below this share of landmarks found among those that should have been.
  double lost_below = 0.15;
  /// Two readings contradict each other in more than this share of what both know about: the robot
  /// was carried away.
  double discontinuity = 0.4;
  /// Readings contradict those that the map was learned from in more than this share, again and
  /// again: the robot is somewhere else.
  double contradiction = 0.1;

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// What the readings of late say about a pose in a map.
struct MapAgreement {
  int expected_count = 0;        ///< landmarks that should have been seen
  int found_count = 0;           ///< of these, seen
  int looked_through_count = 0;  ///< of these, where the view shows empty space
  int unexplained_count = 0;     ///< features where the map holds nothing, one per half metre
  /// Share of the expected landmarks that were found, 1 if none was expected.
  double quality() const {
    return expected_count == 0 ? 1.0 : static_cast<double>(found_count) / expected_count;
  }
};

/// Whether what the sensor shows is what the map holds around the pose. Each landmark counts once
/// per window, however often it is looked at, since readings of one place are not independent. New
/// features alone are no contradiction (unknown ground), nor are landmarks overlooked (corners are
/// found every other time): the robot is lost when both come together. Landmarks that were not seen
/// for a long way are no evidence: where a loop closes, drift alone moves them.
class LostDetector {
public:
  /// \throws std::invalid_argument as LostDetectorParameters::validate()
  explicit LostDetector(const LostDetectorParameters& parameters);

  /// Takes in one reading at the pose that the particle proposes.
  /// \param path_m  the way driven so far, by odometry
  /// \param view  null: landmarks cannot be missed
  void add(const FeatureList& list,
           const FieldOfView* view,
           const Particle& particle,
           const LandmarkRegistry& registry,
           double confirm_log_odds,
           double path_m);
  void clear();
  /// The pose was found in the map just now: for a while all its landmarks are evidence.
  void trustMap(double path_m) { map_trusted_at_m_ = path_m; }

  MapAgreement agreement() const;
  /// \param suspicious  something else speaks for it, too: less evidence will do
  bool lost(bool suspicious = false) const;

private:
  struct Looks {
    std::int64_t found_ns = 0;
    std::int64_t missed_ns = 0;
    std::int64_t looked_through_ns = 0;
  };

  void forget(std::int64_t now_ns);
  /// Whether the pose relative to a landmark cannot have drifted far.
  bool isEvidence(LandmarkId id, double path_m) const;

  LostDetectorParameters parameters_;
  std::map<LandmarkId, Looks> looks_;
  std::map<LandmarkId, double> seen_at_m_;  ///< of the way, when a landmark was found last
  double map_trusted_at_m_ = -std::numeric_limits<double>::infinity();
  std::map<std::pair<int, int>, std::int64_t> unexplained_ns_;  ///< by cell of the map
};

}  // namespace ram_slam
