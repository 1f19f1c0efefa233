// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "ram_slam/landmarks/landmark.hpp"

namespace ram_slam {

/// A landmark as the whole filter sees it, in the map frame.
struct LandmarkEstimate {
  LandmarkId id = 0;
  std::string type;
  std::string classifier;
  Eigen::Vector2d mean_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Identity();
  double existence_log_odds = 0.0;
  double orientation_rad = 0.0;
  double orientation_variance_rad2 = 1e6;  ///< 1e6: not observed
  std::int64_t placed_ns = 0;  ///< when it was first put into the map; 0: before the path began
};

/// E[(p_first - mean)(p_second - mean)^T] of two landmarks; first_id < second_id.
struct LandmarkCovariance {
  LandmarkId first_id = 0;
  LandmarkId second_id = 0;
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Zero();
};

/// The feature layer of the world belief, with the joint covariance of landmarks near each other.
struct LandmarkMap {
  std::int64_t stamp_ns = 0;
  std::vector<LandmarkEstimate> landmarks;      ///< ordered by id
  std::vector<LandmarkCovariance> covariances;  ///< ordered by (first_id, second_id)
};

}  // namespace ram_slam
