// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/landmarks/landmark.hpp"
#include "ram_slam/landmarks/landmark_map.hpp"
#include "ram_slam/smoothing/landmark_smoother_parameters.hpp"

namespace ram_slam {

/// A list of features, and the motion up to it that odometry measured.
struct FeatureStep {
  FeatureList list;
  /// The base, seen from that of the list before; not used in the first one. The covariance may be
  /// singular.
  PoseWithCovariance2 motion;
};

/// A feature, and the landmark that it is paired with.
struct FeatureReading {
  /// In place of a landmark: paired with none.
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  std::size_t pose = 0;              ///< index of the pose that it was seen from
  const Feature* feature = nullptr;  ///< in the steps, which must outlive it
  PointMeasurement measured;
  std::size_t landmark = kNone;
  double score = 0.0;   ///< [nat] that the pair is better than none, per independent reading
  double second = 0.0;  ///< the same of the next best landmark that its list leaves free, or 0

  bool isPaired() const { return landmark != kNone; }
};

/// What is smoothed: the poses, the landmarks, and what was measured between them.
struct LandmarkProblem {
  std::vector<std::int64_t> stamps_ns;
  std::vector<std::array<double, 3>> poses;  ///< x, y, yaw of map_from_base at the stamps
  std::vector<PoseWithCovariance2> motions;  ///< from each pose to the next
  std::vector<FeatureReading> readings;      ///< in the order of their poses
  std::vector<LandmarkEstimate> landmarks;
  LandmarkId next_id = 0;  ///< of a landmark that is made
  double cost = 0.0;       ///< of the last least squares [nat]

  Pose2 poseOf(const FeatureReading& reading) const {
    const std::array<double, 3>& pose = poses[reading.pose];
    return {pose[0], pose[1], pose[2]};
  }
};

/// \param trajectory  where the poses begin
/// \throws std::invalid_argument if steps are out of order or outside the trajectory, or a feature
///   or motion is not finite or its covariance not positive definite
LandmarkProblem makeLandmarkProblem(const std::vector<FeatureStep>& steps,
                                    const Trajectory& trajectory,
                                    const std::vector<LandmarkEstimate>& landmarks,
                                    const LandmarkSmootherParameters& parameters);

}  // namespace ram_slam
