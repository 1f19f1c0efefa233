// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "ramscout_feature_detector/shared_parameters.hpp"

namespace ramscout_feature_detector {

/// A straight line fitted to consecutive points by total least squares.
struct LineFit {
  /// Two points lie on a line whatever their noise; three are the fewest whose residual measures
  /// it.
  static constexpr std::size_t kFewestPoints = 3;

  int count = 0;
  Eigen::Vector2d centroid_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction =
      Eigen::Vector2d::UnitX();  ///< unit, from the first point towards the last
  double spread_m2 = 0.0;        ///< sum of squared distances from the centroid along the line
  double residual_m2 = 0.0;      ///< sum of squared distances from the line

  Eigen::Vector2d normal() const { return {-direction.y(), direction.x()}; }
  /// Variance of one point's distance from the line [m^2]: measured, with the sensor's variance as
  /// a prior that counts as much as `prior_points` points; so that normalised squared errors have
  /// the right mean although the variance is itself an estimate.
  double noiseVariance(double prior_m2, double prior_points) const;
  /// Variance of the direction's angle [rad^2] for points of that noise.
  double angleVariance(double noise_m2) const { return noise_m2 / spread_m2; }
  /// Variance of the line's distance from a point in its prolongation [m^2].
  double offsetVariance(double noise_m2, const Eigen::Vector2d& point_m) const;
};

/// Points of one connected surface in the order of the beams, in the laser's frame. Fitting a line
/// to any run of them costs the same, whatever its length.
class Contour {
public:
  /// \param points_m  at least two
  /// \param closed  the surface goes all around and the points repeat its beginning: it has no ends
  explicit Contour(std::vector<Eigen::Vector2d> points_m,
                   bool closed = false,
                   const LineParameters& parameters = {});

  std::size_t size() const { return points_m_.size(); }
  const Eigen::Vector2d& operator[](std::size_t index) const { return points_m_[index]; }
  const Eigen::Vector2d& front() const { return points_m_.front(); }
  const Eigen::Vector2d& back() const { return points_m_.back(); }
  bool closed() const { return closed_; }

  /// Length of the contour up to a point [m], of the smoothed contour: noise lengthens the raw one.
  double arc_m(std::size_t index) const { return arcs_m_[index]; }
  double length_m() const { return arcs_m_.back(); }
  /// The first point whose arc is not less than `arc_m`, at most the last point.
  std::size_t indexAt(double arc_m) const;
  /// The point nearest to a place.
  std::size_t nearest(const Eigen::Vector2d& place_m) const;

  /// Line through the points first..last, both included; needs last > first.
  LineFit fit(std::size_t first, std::size_t last) const;
  /// Sum of squared distances of the points first..last from that line [m^2].
  double residual_m2(std::size_t first, std::size_t last) const;

  /// Whether the lines through the points first..middle and middle..last differ in direction by at
  /// least an angle and at most 180 degrees less it; several times faster than fitting them.
  /// \param cos_twice  cosine of twice the angle
  bool bendsAt(std::size_t first, std::size_t middle, std::size_t last, double cos_twice) const;

  /// The same line without the bias that range noise gives it: noise moves points along their
  /// beams, so not only across the line but along it, too. Regression on the places where the beams
  /// meet the line, weighted for equal noise of all ranges; takes time for every point.
  LineFit refine(LineFit line, std::size_t first, std::size_t last) const;

private:
  struct Sums {
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  };
  /// Mean of the points first..last, relative to the first of all, and their scatter about it.
  Sums moments(std::size_t first, std::size_t last) const;

  std::vector<Eigen::Vector2d> points_m_;
  std::vector<Sums> sums_;  ///< sums_[i]: of the points before i, relative to the first
  std::vector<double> arcs_m_;
  bool closed_;
  LineParameters parameters_;
};

}  // namespace ramscout_feature_detector
