// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/landmarks/local_constellation.hpp"
#include "ram_slam/scan_matching/correlative_search.hpp"
#include "ram_slam/sensing/field_of_view.hpp"

namespace ram_slam {

/// The table explains the fields.
struct MapViewsParameters {
  double same_place_m = 1.0;
  double same_place_rad = 0.8;
  double max_distance_m = 4.0;
  int max_compared = 2;
  double neutral_ratio = 0.04;
  double max_evidence = 1.0;
  double max_counterevidence = 4.0;
  double trusted_path_m = 10.0;

  /// Of the search around a pose.
  struct Refinement {
    double step_m = 0.16;
    double step_rad = 0.05;
    int halvings = 3;
    static const ram_parameters::ParameterTable<Refinement>& table();
  };
  Refinement refinement;

  /// Of the search in all of the map.
  struct Search {
    double tile_m = 3.0;
    double resolution_m = 0.15;
    double deviation_m = 0.15;
    int levels = 4;
    double angle_step_rad = 0.02;
    double min_fit = 0.6;
    double near_best_fit = 0.8;
    int max_candidates = 12;
    int max_views = 12;
    int max_points = 160;
    static const ram_parameters::ParameterTable<Search>& table();
  };
  Search search;

  static const ram_parameters::ParameterTable<MapViewsParameters>& table();
};

/// How recent views agree with those of a map at a pose.
struct ViewAgreement {
  int compared_count = 0;            ///< views that share enough with the map's to be compared
  double contradiction_ratio = 0.0;  ///< mean over these of the share that discontinuity() gives
  double evidence = 0.0;             ///< [nat] for the pose, at most max_evidence per view
};

/// Views that a map was learned from, one per place: what a robot sees there if its pose is right,
/// beyond the landmarks.
class MapViews {
public:
  explicit MapViews(const MapViewsParameters& parameters = {}) : parameters_(parameters) {}

  /// Keeps the view unless there is one from about there.
  /// \param path_m  the way driven so far
  void add(std::int64_t stamp_ns,
           const Pose2& map_from_base,
           double path_m,
           std::shared_ptr<const FieldOfView> view);
  /// A view of a map made before: it stays where it is.
  void addLoaded(const PlacedView& placed);
  /// The map has come to be another one: its views lie on this path; those that do not are dropped.
  /// Loaded ones stay.
  void follow(const Trajectory& path);
  void clear();
  bool empty() const { return places_.empty(); }
  std::size_t size() const { return places_.size(); }

  /// The mean share of contradiction between a view and the map's nearest ones, if the base is
  /// there; none if they have too little in common.
  std::optional<double> contradictionRatio(const FieldOfView& view,
                                           const Pose2& map_from_base) const;
  /// The same of a robot that is being tracked, compared only with views that agreed within the
  /// last trusted_path_m of its way: where a loop closes, drift alone makes the others contradict.
  std::optional<double> trackedContradictionRatio(const FieldOfView& view,
                                                  const Pose2& map_from_base,
                                                  double path_m);
  /// The pose was found in the map just now: for a while all views count.
  void trustMap(double path_m);

  /// The same for views along a way, given where its end is.
  ViewAgreement judge(const std::vector<LocalConstellation::PlacedView>& views,
                      const Pose2& map_from_base) const;

  /// The pose nearby that the views contradict least.
  Pose2 refined(const std::vector<LocalConstellation::PlacedView>& views,
                const Pose2& map_from_base) const;

  /// Poses near a place of the map at which the surfaces in the views lie on those of the map:
  /// where the robot may be by its walls alone. At most one per tile_m square, the best first.
  std::vector<Pose2> candidates(const std::vector<LocalConstellation::PlacedView>& views) const;

private:
  struct Place {
    std::int64_t stamp_ns = 0;
    Pose2 map_from_base;
    std::shared_ptr<const FieldOfView> view;
    double agreed_at_m = 0.0;  ///< of the way, when it agreed with the robot's view last
    bool is_loaded = false;
  };

  bool knowsPlace(const Pose2& map_from_base) const;
  /// Indices of the places near enough to be compared, the nearest first.
  std::vector<std::size_t> near(const Pose2& map_from_base) const;

  const LikelihoodPyramid* surfaces() const;

  MapViewsParameters parameters_;
  std::vector<Place> places_;  ///< oldest first
  /// Of all places, once they were searched; a cache.
  mutable std::optional<LikelihoodPyramid> surfaces_;
};

}  // namespace ram_slam
