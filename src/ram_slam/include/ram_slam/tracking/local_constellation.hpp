// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "ram_slam/landmarks/constellation.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/sensing/field_of_view.hpp"

namespace ram_slam {

struct LocalConstellationParameters {
  /// [m] of driving that is remembered.
  double length = 20.0;
  /// [m] a feature nearer than this to a known point of its type is that point.
  double match_distance = 0.25;
  /// Points seen less often are taken for errors of the detector.
  int minimum_sightings = 2;
  /// [m/m] standard deviation that a point's position gains per metre driven since it was seen.
  double drift_per_m = 0.01;

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// What a robot that does not know where it is has seen of late, put together by odometry: the
/// features of the last metres and the views they were seen in, relative to each other.
class LocalConstellation {
public:
  /// A view and where the base was in it, seen from the base now.
  struct PlacedView {
    Pose2 base_from_then;
    std::shared_ptr<const FieldOfView> view;
  };

  /// \throws std::invalid_argument as LocalConstellationParameters::validate()
  LocalConstellation(const LocalConstellationParameters& parameters, FeatureMatchers matchers);

  /// \param before_from_now  motion of the base since the last list
  /// \param view  null if the sensor tells none
  void add(const FeatureList& list,
           const Pose2& before_from_now,
           std::shared_ptr<const FieldOfView> view);
  void clear();

  /// What was seen often enough, in the base frame of now.
  Constellation points() const;
  /// A view per half metre or so of the way, oldest first.
  std::vector<PlacedView> views() const;
  /// The way driven since clear() [m], also what is forgotten.
  double distance_m() const { return distance_m_; }

private:
  struct Point {
    ConstellationPoint place;  ///< in the local frame
    int sightings = 0;
    double seen_at_m = 0.0;  ///< on the way
  };
  struct View {
    Pose2 local_from_base;
    double seen_at_m = 0.0;
    std::shared_ptr<const FieldOfView> view;
  };

  void forget();
  void addFeature(const Feature& feature, std::vector<bool>& used);
  void addView(std::shared_ptr<const FieldOfView> view);

  LocalConstellationParameters parameters_;
  FeatureMatchers matchers_;
  Pose2 local_from_base_;
  double distance_m_ = 0.0;
  std::vector<Point> points_;
  std::deque<View> views_;
};

/// What a hypothesis about the pose makes of the views: how much likelier it gets [nat, at most 0],
/// given the landmarks that would have to be where the views show nothing.
/// \param paired  per landmark, whether the hypothesis pairs it with something seen
double contradiction(const Constellation& map,
                     const std::vector<bool>& paired,
                     const Pose2& map_from_base,
                     const std::vector<LocalConstellation::PlacedView>& views);

}  // namespace ram_slam
