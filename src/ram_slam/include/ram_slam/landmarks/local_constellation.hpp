// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/landmarks/constellation.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/sensing/field_of_view.hpp"

namespace ram_slam {

/// The table explains the fields.
struct LocalConstellationParameters {
  double length = 20.0;
  double match_distance = 0.25;
  int minimum_sightings = 2;
  double drift_per_m = 0.01;
  int max_points = 60;
  int max_descriptors = 4;
  double turn_as_path_m = 0.3;
  double view_spacing_m = 0.5;
  double view_spacing_rad = 0.7;
  double min_sigma_m = 0.02;
  double new_descriptor_below = 0.0;

  static const ram_parameters::ParameterTable<LocalConstellationParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// What a robot that does not know where it is has seen recently, put together by odometry: the
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
  /// \param view  null if the sensor has none
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
  /// Index of the point that a feature of that type shows, none if it is new.
  std::optional<std::size_t> nearest(const std::string& type,
                                     const Eigen::Vector2d& place_m,
                                     const std::vector<bool>& used) const;
  /// Kalman update of the point with one more sighting in the local frame.
  void update(Point& point, const ConstellationPoint& seen) const;
  void addDescriptor(Point& point, const DescriptorPointer& descriptor) const;
  void addView(std::shared_ptr<const FieldOfView> view);

  LocalConstellationParameters parameters_;
  FeatureMatchers matchers_;
  Pose2 local_from_base_;
  double distance_m_ = 0.0;
  std::vector<Point> points_;
  std::deque<View> views_;
};

}  // namespace ram_slam
