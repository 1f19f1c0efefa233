// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "ram_slam/fast_slam/parameters.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/landmarks/feature_matcher.hpp"
#include "ram_slam/landmarks/landmark.hpp"

namespace ram_slam {

/// What all particles know alike about a landmark; where it is, each knows for itself.
struct LandmarkRecord {
  LandmarkId id = 0;
  std::string type;
  /// Of the feature that created it; shared, because the filter is copied all the time.
  std::shared_ptr<const std::string> classifier;
  std::int64_t placed_ns = 0;                  ///< when it was first put into a map
  std::vector<DescriptorPointer> descriptors;  ///< its appearance, from different places
  double existence_log_odds = 0.0;
  bool was_confirmed = false;    ///< at some time
  double matched_weight = 0.0;   ///< share of the particles that saw it in the last reading
  Eigen::AlignedBox2d bounds_m;  ///< encloses where it can be matched, in every particle
  std::uint32_t seen_from = 0;   ///< bit per sector of the direction from the landmark to the robot
  double seen_within_m = 0.0;    ///< largest distance at which it was seen
  Eigen::Matrix3d drift = Eigen::Matrix3d::Zero();  ///< MapDrift::covariance() at its creation
  double orientation_rad = 0.0;                     ///< in the map, mean of what was seen
  double orientation_variance_rad2 = 1e6;           ///< 1e6: not observed
};

/// The landmarks that some particle holds, in the order of their identifiers. Identifiers are never
/// used again.
class LandmarkRegistry {
public:
  /// A landmark with the appearance of this feature; its bounds are still empty.
  LandmarkRecord& create(const Feature& feature, DescriptorPointer descriptor);
  /// Null if there is none. Valid until create() or remove().
  LandmarkRecord* find(LandmarkId id);
  const LandmarkRecord* find(LandmarkId id) const;
  void remove(LandmarkId id);
  const std::vector<LandmarkRecord>& records() const { return records_; }
  std::vector<LandmarkRecord>& records() { return records_; }
  /// Takes over a record as it is, e.g. from a stored map. \throws std::invalid_argument if its id
  /// was used already
  void restore(LandmarkRecord record);
  /// Leaves out the next so many identifiers, which may have been used without this registry.
  void skip(LandmarkId count) { next_id_ += count; }

private:
  std::vector<LandmarkRecord> records_;
  LandmarkId next_id_ = 0;
};

/// Remembers from where the landmark was seen, and its descriptor if it is unlike the known ones.
void addSighting(LandmarkRecord& record,
                 const Eigen::Vector2d& robot_from_landmark_m,
                 const FeatureMatcher* matcher,
                 const DescriptorPointer& descriptor,
                 const AppearanceParameters& parameters);

/// Averages in one more observation of the landmark's orientation in the map.
void addOrientation(LandmarkRecord& record,
                    double orientation_rad,
                    double variance_rad2,
                    const AppearanceParameters& parameters);

/// Whether the landmark was seen from about there before, so that it should be seen from there
/// again.
bool knownFrom(const LandmarkRecord& record, const Eigen::Vector2d& robot_from_landmark_m);

}  // namespace ram_slam
