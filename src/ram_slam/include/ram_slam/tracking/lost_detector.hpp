// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/fast_slam/landmark_registry.hpp"
#include "ram_slam/fast_slam/particle.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/sensing/field_of_view.hpp"

namespace ram_slam {

/// The table explains the fields.
struct LostDetectorParameters {
  double window = 2.0;
  int minimum_evidence = 3;
  double lost_below = 0.15;
  double match_distance = 0.4;
  double unexplained_cell_m = 0.5;
  int suspicious_evidence = 2;
  double suspicious_quality = 0.35;
  double evidence_path_m = 10.0;
  double view_tolerance_m = 0.3;

  static const ram_parameters::ParameterTable<LostDetectorParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// How recent readings and a pose in a map agree.
struct MapAgreement {
  int expected_count = 0;        ///< landmarks that should have been seen
  int found_count = 0;           ///< of these, seen
  int looked_through_count = 0;  ///< of these, where the view shows empty space
  int unexplained_count = 0;     ///< features where the map holds nothing, one per cell
  /// Share of the expected landmarks that were found, 1 if none was expected.
  double quality() const {
    return expected_count == 0 ? 1.0 : static_cast<double>(found_count) / expected_count;
  }
};

/// Whether what the sensor shows is what the map holds around the pose. Each landmark counts once
/// per window, however often it is in view, since readings of one place are not independent. New
/// features alone are no contradiction (unknown ground), nor are landmarks overlooked (corners are
/// found every other time): the robot is lost when both come together. Landmarks that were not seen
/// for a long way are no evidence: where a loop closes, drift alone moves them.
class LostDetector {
public:
  /// One reading at the pose that a particle proposes, and the map that it is compared with.
  struct Reading {
    const FeatureList& features;
    const FieldOfView* view;  ///< null: landmarks cannot be missed
    const Particle& particle;
    const LandmarkRegistry& registry;
  };

  /// \param confirm_log_odds  landmarks less likely than this are no evidence
  /// \throws std::invalid_argument as LostDetectorParameters::validate()
  LostDetector(const LostDetectorParameters& parameters, double confirm_log_odds);

  /// \param path_m  the way driven so far, by odometry
  void add(const Reading& reading, double path_m);
  void clear();
  /// The pose was found in the map just now: for a while all its landmarks are evidence.
  void trustMap(double path_m) { map_trusted_at_m_ = path_m; }

  MapAgreement agreement() const;
  /// \param suspicious  there is other evidence, too: less will do
  bool lost(bool suspicious = false) const;

private:
  /// When a landmark was last found or missed; 0: not within the window.
  struct Sightings {
    std::int64_t found_ns = 0;
    std::int64_t missed_ns = 0;
    std::int64_t looked_through_ns = 0;
  };

  /// Whether a feature shows the landmark. \param explained  per feature: set for those that do
  bool matchFeatures(const FeatureList& list,
                     const Eigen::Vector2d& expected_m,
                     const std::string& type,
                     std::vector<bool>& explained) const;
  void addMissing(const Reading& reading,
                  const LandmarkRecord& record,
                  const Eigen::Vector2d& expected_m,
                  const Eigen::Vector2d& robot_from_landmark_m);
  void addUnexplained(const Reading& reading, const std::vector<bool>& explained);
  void forget(std::int64_t now_ns);
  /// Whether the pose relative to a landmark cannot have drifted far.
  bool isEvidence(LandmarkId id, double path_m) const;
  /// What a view shows at a point, if it shows the same all around it.
  Sight sightAround(const FieldOfView& view, const Eigen::Vector2d& point_m) const;

  LostDetectorParameters parameters_;
  double confirm_log_odds_;
  std::map<LandmarkId, Sightings> sightings_;
  std::map<LandmarkId, double> seen_at_m_;  ///< of the way, when a landmark was found last
  double map_trusted_at_m_ = -std::numeric_limits<double>::infinity();
  std::map<std::pair<int, int>, std::int64_t> unexplained_ns_;  ///< by cell of the map
};

}  // namespace ram_slam
