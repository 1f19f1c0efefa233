// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/sensing/beam_finder.hpp"
#include "ram_slam/sensing/laser_scan.hpp"
#include "ram_slam/sensing/placed_scan.hpp"

namespace ram_slam {

/// What a sensor observed of a point at which something is expected.
enum class Sight {
  kHidden,   ///< out of view or behind something: no information
  kVisible,  ///< something is there or close to it: what is expected there should have been
             ///< seen
  kEmpty,    ///< the view goes well past it: nothing is there
};

/// What could have been seen in one reading of a sensor: the evidence against landmarks that a list
/// of features cannot give. The estimator knows no more about sensors than this.
class FieldOfView {
public:
  virtual ~FieldOfView() = default;
  virtual Sight look(const Eigen::Vector2d& point_in_base_m) const = 0;
  /// Beyond this distance from the base everything is hidden.
  virtual double range_m() const = 0;
  /// Whether landmarks show themselves to every side, as far as the view reaches: then one is
  /// missed wherever it should be in view, not only from where it was seen before. False of
  /// corners.
  virtual bool showsEverySide() const { return false; }
  /// Some of the points at which the sensor saw something, spread evenly over the view; none if the
  /// sensor does not measure them.
  virtual const std::vector<Eigen::Vector2d>& surface_m() const;
};

/// A view from a known place.
struct PlacedView {
  Pose2 map_from_base;
  std::shared_ptr<const FieldOfView> view;
};

/// The share of what two views both know about that they contradict each other in, if the base
/// moved like that between them: surfaces of one in the free space of the other. Some hundredths
/// for two views of one place, a third and more for views of two places. None if they have too
/// little in common.
std::optional<double> discontinuity(const FieldOfView& before,
                                    const FieldOfView& now,
                                    const Pose2& before_from_now);

/// Settings of LaserView.
struct LaserViewParameters {
  double margin_at_max_range_m = 0.5;  ///< corners at the edge of the range are seldom found
  double blocked_m = 0.2;              ///< a reading this much nearer than a point hides it
  double passed_m = 0.3;     ///< a reading this much farther means that nothing is at the point
  int beams_beside = 1;      ///< on each side of a point's own beam that must agree with it
  int surface_points = 180;  ///< of surface_m(), about

  static const ram_parameters::ParameterTable<LaserViewParameters>& table();
};

/// The view of a planar lidar.
class LaserView : public FieldOfView {
public:
  /// \throws std::invalid_argument as LaserScan::validate()
  LaserView(const LaserScan& scan,
            const Pose2& base_from_laser,
            const LaserViewParameters& parameters = {});
  Sight look(const Eigen::Vector2d& point_in_base_m) const override;
  double range_m() const override;
  const std::vector<Eigen::Vector2d>& surface_m() const override { return surface_m_; }

private:
  LaserViewParameters parameters_;
  LaserScan scan_;
  BeamFinder finder_;
  Eigen::Matrix2d base_from_laser_rotation_;
  Eigen::Vector2d base_from_laser_m_;
  std::vector<Eigen::Vector2d> surface_m_;
};

/// The views of a map's scans. \throws std::invalid_argument as LaserScan::validate()
std::vector<PlacedView> viewsOf(const std::vector<PlacedScan>& scans);

}  // namespace ram_slam
