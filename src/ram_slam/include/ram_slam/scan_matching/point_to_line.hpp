// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/scan_matching/surface_scan.hpp"

namespace ram_slam {

/// How points of one scan are paired with lines of another.
struct PairingLimits {
  double max_distance_m = 0.3;     ///< between a point and its partner
  double min_normal_cosine = 0.8;  ///< of the angle between the two normals
  double robust_scale_m = 0.03;    ///< residual at which a pair counts half (Cauchy)
  /// Beams on each side of a point's own among which its partner is searched, at most.
  double max_search_beams = 12.0;
  std::size_t point_stride = 1;  ///< every how-many-th point of the source is used
};

/// Sum over point-to-line pairs of w r^2, with r = n . (T p - q), in the neighbourhood of T =
/// target_from_source: cost + 2 gradient . d + d^T information d, d = change of (x, y, yaw) of T.
struct PointToLineSum {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double cost_m2 = 0.0;           ///< sum of w r^2
  double weight = 0.0;            ///< sum of w
  std::size_t visible_count = 0;  ///< source points on lines within the target's field of view
  std::size_t pair_count = 0;     ///< those of them that have a partner

  /// 0 if no point is in the field of view.
  double inlierRatio() const {
    return visible_count == 0
               ? 0.0
               : static_cast<double>(pair_count) / static_cast<double>(visible_count);
  }
};

/// Pairs each point of `source` with the nearest point of `target` about the beam in its
/// direction, if that lies on a line, and sums the point-to-line residuals (Censi, ICRA 2008; the
/// beam order replaces the search). Points of `source` on no line (edges, far walls at a grazing
/// angle) are paired, too, but do not count in pair_count and visible_count.
PointToLineSum sumPointToLine(const SurfaceScan& target,
                              const SurfaceScan& source,
                              const Pose2& target_from_source,
                              const PairingLimits& limits);

/// The surfaces of a scan, and how the laser moved during its sweep.
struct SweepingScan {
  const SurfaceScan& surfaces;
  Eigen::Vector3d velocity;  ///< (x, y, yaw) [m/s, m/s, rad/s] in the laser's axes
};

/// Information and gradient as in PointToLineSum, of (x, y, yaw) of T, and of the time of one
/// counterclockwise turn of the mirror [s], which both scans share.
struct ScanPairSum {
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
};

/// The pairs of sumPointToLine(), with the derivatives of their residuals by the time of a mirror
/// turn, too. With the time p of a mirror turn, the point of a beam at the angle a from the first
/// beam is displaced by p a / (2 pi) (v + w x point) for the velocity v and the turn rate w of the
/// laser.
ScanPairSum sumScanPair(const SweepingScan& target,
                        const SweepingScan& source,
                        const Pose2& target_from_source,
                        const PairingLimits& limits);

}  // namespace ram_slam
