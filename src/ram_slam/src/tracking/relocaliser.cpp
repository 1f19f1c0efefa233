// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/relocaliser.hpp"

#include <algorithm>
#include <utility>

#include "ram_slam/geometry/motion_gate.hpp"

namespace ram_slam {

const ram_parameters::ParameterTable<RelocaliserParameters>& RelocaliserParameters::table() {
  using P = RelocaliserParameters;
  using namespace ram_parameters;
  static const auto table =
      ParameterTable<P>()
          .include(&P::local, LocalConstellationParameters::table())
          .include(&P::constellation, ConstellationParameters::table())
          .expert("Tries of a lost robot")
          .add("try_every_m", &P::try_every_m, "m", positive(),
               "Driving between two tries to find the robot in the map, at least this ...")
          .add("try_every_share", &P::try_every_share, "", atLeast(0.0),
               "... and this share of the way driven lost, so that long searches cost little, ...")
          .add("try_every_per_view_m", &P::try_every_per_view_m, "m", atLeast(0.0),
               "... and this per view of the map: a search in a map of 300 m of way takes up to a "
               "second of one core, and a lost robot is to keep up with its scans.")
          .add("same_place_m", &P::same_place_m, "m", positive(),
               "Two tries that differ by no more than this ...")
          .add("same_place_rad", &P::same_place_rad, "rad", positive(),
               "... and this found the same place.")
          .section("place_finder", &P::place_finder, PlaceFinderParameters::table());
  return table;
}

Relocaliser::Relocaliser(const RelocaliserParameters& parameters, const FeatureMatchers& matchers)
    : parameters_((parameters.validate(), parameters)),
      matchers_(matchers),
      local_(parameters.local, matchers),
      next_try_m_(parameters.try_every_m) {}

void Relocaliser::add(const FeatureList& list,
                      const Pose2& before_from_now,
                      std::shared_ptr<const FieldOfView> view) {
  local_.add(list, before_from_now, std::move(view));
}

std::optional<PoseWithCovariance2> Relocaliser::search(const Query& query) {
  next_try_m_ =
      local_.distance_m() +
      std::max({parameters_.try_every_m, parameters_.try_every_share * local_.distance_m(),
                parameters_.try_every_per_view_m * static_cast<double>(query.map_views.size())});
  const std::optional<PoseWithCovariance2> place =
      findPlace({query.map, query.map_views, local_, query.expected}, matchers_,
                parameters_.constellation, parameters_.place_finder);
  if (!place) {
    map_from_local_.reset();
    return std::nullopt;
  }
  const std::optional<Pose2> before =
      std::exchange(map_from_local_, place->pose * query.local_from_base.inverse());
  if (!before) return std::nullopt;
  const Pose2 difference = (*before * query.local_from_base).inverse() * place->pose;
  if (MotionGate{parameters_.same_place_m, parameters_.same_place_rad}.isExceededBy(difference))
    return std::nullopt;
  return place;
}

Constellation confirmedLandmarks(const LandmarkFilter& filter) {
  Constellation map;
  for (const LandmarkEstimate& estimate : filter.landmarks().landmarks) {
    if (estimate.existence_log_odds < filter.confirm_log_odds()) continue;
    map.push_back({estimate.type, estimate.mean_m, estimate.covariance_m2,
                   filter.registry().find(estimate.id)->descriptors, estimate.orientation_rad,
                   estimate.orientation_variance_rad2});
  }
  return map;
}

}  // namespace ram_slam
