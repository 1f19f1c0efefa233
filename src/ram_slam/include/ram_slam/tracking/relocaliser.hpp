// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/fast_slam/landmark_filter.hpp"
#include "ram_slam/landmarks/constellation.hpp"
#include "ram_slam/landmarks/local_constellation.hpp"
#include "ram_slam/tracking/map_views.hpp"
#include "ram_slam/tracking/place_finder.hpp"

namespace ram_slam {

/// The table explains the fields.
struct RelocaliserParameters {
  LocalConstellationParameters local;
  ConstellationParameters constellation;
  double try_every_m = 0.5;
  double try_every_share = 0.05;
  double try_every_per_view_m = 0.02;
  double same_place_m = 0.4;
  double same_place_rad = 0.15;
  PlaceFinderParameters place_finder;

  static const ram_parameters::ParameterTable<RelocaliserParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// Where is the robot? Puts together what a lost robot sees on its way, and tries from time to time
/// to find it in the map. A place counts as found if two tries in a row find it.
class Relocaliser {
public:
  /// The map, and where the robot is by odometry.
  struct Query {
    const Constellation& map;
    const MapViews& map_views;
    /// Of places that are as good as each other this one is taken.
    std::optional<Pose2> expected;
    Pose2 local_from_base;  ///< by odometry, in a frame that stays the same between tries
  };

  /// \throws std::invalid_argument as RelocaliserParameters::validate()
  Relocaliser(const RelocaliserParameters& parameters, const FeatureMatchers& matchers);

  /// \param before_from_now  motion of the base since the last list
  void add(const FeatureList& list,
           const Pose2& before_from_now,
           std::shared_ptr<const FieldOfView> view);
  /// Driven since the robot was lost.
  double distance_m() const { return local_.distance_m(); }
  /// Whether the robot has driven far enough since the last try.
  bool isDue() const { return local_.distance_m() >= next_try_m_; }
  /// map_from_base if this try and the one before found the same place.
  std::optional<PoseWithCovariance2> search(const Query& query);

private:
  RelocaliserParameters parameters_;
  FeatureMatchers matchers_;
  LocalConstellation local_;
  double next_try_m_;
  std::optional<Pose2> map_from_local_;  ///< as the last try found it
};

/// The confirmed landmarks of a filter, among which a robot can be searched for.
Constellation confirmedLandmarks(const LandmarkFilter& filter);

}  // namespace ram_slam
