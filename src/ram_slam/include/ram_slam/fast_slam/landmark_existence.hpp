// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_slam/fast_slam/landmark_registry.hpp"
#include "ram_slam/fast_slam/parameters.hpp"
#include "ram_slam/fast_slam/particle.hpp"
#include "ram_slam/sensing/field_of_view.hpp"

namespace ram_slam {

/// Whether landmarks exist: a log-odds filter over readings in which they were found or should have
/// been (Thrun et al., Probabilistic Robotics, 2005, section 13.6.2).
class LandmarkExistence {
public:
  /// \param particles  those whose maps were updated with the reading, outlive this
  /// \param weights  one per particle, of sum 1
  LandmarkExistence(const FastSlamParameters& parameters,
                    const std::vector<Particle>& particles,
                    const std::vector<double>& weights);

  /// Updates the log-odds of all landmarks from one reading and clears their matched_weight.
  /// \param view  what the sensor could have seen; null: landmarks that were not found lose nothing
  /// \param map_from_base  where the robot is
  /// \returns the landmarks whose log-odds fell below delete_log_odds
  std::vector<LandmarkId> update(LandmarkRegistry& registry,
                                 const FieldOfView* view,
                                 const Pose2& map_from_base) const;

private:
  /// A particle that stands for a share of the weight of all.
  struct Representative {
    const Particle* particle;
    Eigen::Matrix2d base_from_map;  ///< rotation
    int count;                      ///< of the shares that it stands for
  };

  /// Log-odds that a landmark loses because it was not found where the view ...
  struct MissingEvidence {
    double overlooked = 0.0;  ///< ... shows something
    double passed = 0.0;      ///< ... shows that there is nothing
  };

  MissingEvidence missingEvidence(const LandmarkRecord& record,
                                  const FieldOfView& view,
                                  const Pose2& map_from_base) const;
  /// What the view shows at a point that is known to some centimetres.
  Sight sightBeside(const FieldOfView& view, const Eigen::Vector2d& point_in_base_m) const;

  const FastSlamParameters& parameters_;
  std::vector<Representative> representatives_;
};

}  // namespace ram_slam
