// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/scan_matching/correlative_search.hpp"
#include "ram_slam/sensing/field_of_view.hpp"
#include "ram_slam/tracking/local_constellation.hpp"

namespace ram_slam {

/// How recent views agree with those of a map at a pose.
struct ViewAgreement {
  int compared_count = 0;      ///< views that share enough with the map's to be compared
  double contradiction = 0.0;  ///< mean over these of the share that discontinuity() gives
  double evidence = 0.0;       ///< [nat] for the pose, at most MapViews::kMostEvidence per view
};

/// Views that a map was learned from, one per place: what a robot sees there if it is where it
/// takes itself for, beyond the landmarks.
class MapViews {
public:
  /// The most that one view may say for a pose, and against it [nat].
  static constexpr double kMostEvidence = 1.0;
  static constexpr double kMostCounterevidence = 4.0;

  /// Keeps the view unless there is one from about there.
  /// \param path_m  the way driven so far
  void add(std::int64_t stamp_ns,
           const Pose2& map_from_base,
           double path_m,
           std::shared_ptr<const FieldOfView> view);
  /// The map has come to be another one: its views lie on this path; those that do not are dropped.
  void follow(const Trajectory& path);
  void clear();
  bool empty() const { return places_.empty(); }
  std::size_t size() const { return places_.size(); }

  /// The mean share of contradiction between a view and the map's nearest ones, if the base is
  /// there; none if they have too little in common.
  std::optional<double> contradiction(const FieldOfView& view, const Pose2& map_from_base) const;
  /// The same of a robot that is being tracked, compared only with views that agreed within the
  /// last kTrustedPath_m of its way: where a loop closes, drift alone makes the others contradict.
  std::optional<double> watch(const FieldOfView& view, const Pose2& map_from_base, double path_m);
  /// The pose was found in the map just now: for a while all views count.
  void trustMap(double path_m);
  static constexpr double kTrustedPath_m = 10.0;

  /// The same for views along a way, given where its end is.
  ViewAgreement judge(const std::vector<LocalConstellation::PlacedView>& views,
                      const Pose2& map_from_base) const;

  /// The pose nearby that the views contradict least.
  Pose2 refined(const std::vector<LocalConstellation::PlacedView>& views,
                const Pose2& map_from_base) const;

  /// Poses near a place of the map at which the surfaces in the views lie on those of the map:
  /// where the robot may be, as far as walls tell. At most one per kTile_m square, the best first.
  std::vector<Pose2> candidates(const std::vector<LocalConstellation::PlacedView>& views) const;

private:
  struct Place {
    std::int64_t stamp_ns = 0;
    Pose2 map_from_base;
    std::shared_ptr<const FieldOfView> view;
    double agreed_at_m = 0.0;  ///< of the way, when it agreed with the robot's view last
  };

  /// Indices of the places near enough to be compared, the nearest first.
  std::vector<std::size_t> near(const Pose2& map_from_base) const;

  std::vector<Place> places_;  ///< oldest first
  /// Of all places, once they were searched; nothing that can be seen from outside.
  mutable std::optional<LikelihoodPyramid> surfaces_;
};

}  // namespace ram_slam
