// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <unordered_map>
#include <vector>

#include "ram_slam/fast_slam/fast_slam.hpp"
#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/geometry/trajectory.hpp"

namespace ram_slam {
namespace {

/// Where the corrected trajectory moves things that were placed from the robot's pose at a stamp.
class Correction {
public:
  /// \param loaded_frame  of a loaded map: the corrected trajectory is in its frame, as far as this
  Correction(Trajectory path,
             const Trajectory& corrected,
             const std::optional<MotionGate>& loaded_frame)
      : path_(std::move(path)) {
    const std::int64_t first_ns = std::max(path_.front().stamp_ns, corrected.front().stamp_ns);
    last_ns_ = std::min(path_.back().stamp_ns, corrected.back().stamp_ns);
    if (last_ns_ < first_ns)
      throw std::invalid_argument("the corrected trajectory has no stamp in common with the path");
    map_from_corrected_ = *poseAt(path_, first_ns) * poseAt(corrected, first_ns)->inverse();
    if (loaded_frame) {
      if (loaded_frame->isExceededBy(map_from_corrected_))
        throw std::invalid_argument("the corrected trajectory is not in the frame of the map");
      map_from_corrected_ = {};
    }
    for (const StampedPose2& old : path_) {
      const std::int64_t stamp_ns = std::clamp(old.stamp_ns, first_ns, last_ns_);
      const Pose2 before = stamp_ns == old.stamp_ns ? old.pose : *poseAt(path_, stamp_ns);
      new_from_old_.push_back(map_from_corrected_ * *poseAt(corrected, stamp_ns) *
                              before.inverse());
    }
  }

  /// That of the last pose at or before the stamp.
  const Pose2& newFromOld(std::int64_t stamp_ns) const {
    const auto after = std::upper_bound(
        path_.begin(), path_.end(), stamp_ns,
        [](std::int64_t stamp, const auto& pose) { return stamp < pose.stamp_ns; });
    return new_from_old_[static_cast<std::size_t>(
        std::max<std::ptrdiff_t>(std::distance(path_.begin(), after) - 1, 0))];
  }

  Path correctedPath() const {
    Path path;
    for (std::size_t i = 0; i < path_.size(); ++i)
      path.append({path_[i].stamp_ns, new_from_old_[i] * path_[i].pose});
    return path;
  }

  const Pose2& mapFromCorrected() const { return map_from_corrected_; }

private:
  Trajectory path_;
  std::vector<Pose2> new_from_old_;
  Pose2 map_from_corrected_;
  std::int64_t last_ns_ = 0;
};

}  // namespace

void FastSlam::movePose(const Pose2& new_from_old) {
  const PoseWithCovariance2 move{new_from_old, Eigen::Matrix3d::Zero()};
  for (Particle& particle : particles_) {
    particle.map_from_base = new_from_old * particle.map_from_base;
    particle.proposal = move * particle.proposal;
    particle.path.moveLast(new_from_old);
  }
  estimate_ = move * estimate_;
}

Pose2 FastSlam::followTrajectory(const Trajectory& corrected) {
  validate(corrected);
  if (!started() || corrected.empty())
    throw std::invalid_argument("there is no path that could be corrected");
  std::optional<MotionGate> loaded_frame;
  if (is_map_loaded_) loaded_frame = parameters_.loaded_frame;
  const Correction correction(trajectory(), corrected, loaded_frame);

  // From here on nothing fails.
  std::vector<LandmarkTree*> trees;
  std::unordered_map<LandmarkId, Pose2> new_from_old;  // looked up, never walked through
  for (Particle& particle : particles_) trees.push_back(&particle.landmarks);
  for (const LandmarkRecord& record : registry_.records()) {
    const bool is_loaded = is_map_loaded_ && record.placed_ns == 0;
    new_from_old.emplace(record.id, is_loaded ? Pose2{} : correction.newFromOld(record.placed_ns));
  }
  LandmarkTree::transform(trees, [&](LandmarkId id, const Landmark& landmark) {
    const Pose2& move = new_from_old.at(id);
    const Eigen::Matrix2d rotation = move.rotation();
    return Landmark{move * landmark.mean_m,
                    rotation * landmark.covariance_m2 * rotation.transpose()};
  });

  movePose(correction.newFromOld(stamp_ns_));
  const Path path = correction.correctedPath();
  for (Particle& particle : particles_) particle.path = path;
  Trajectory followed = corrected;
  for (StampedPose2& stamped : followed)
    stamped.pose = correction.mapFromCorrected() * stamped.pose;
  shared_error_.follow(followed);
  for (LandmarkRecord& record : registry_.records()) refreshBounds(record);
  removeDuplicates();
  return correction.mapFromCorrected();
}

void FastSlam::removeDuplicates() {
  const Particle& best = particles_[best_];
  const Eigen::Matrix2d floor_m2 = parameters_.feature_noise_floor *
                                   parameters_.feature_noise_floor * Eigen::Matrix2d::Identity();
  std::vector<LandmarkId> duplicates;
  const std::vector<LandmarkRecord>& records = registry_.records();
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Landmark* younger = best.landmarks.find(records[i].id);
    if (younger == nullptr) continue;
    for (std::size_t j = 0; j < i; ++j) {
      if (records[j].type != records[i].type ||
          !records[j].bounds_m.intersects(records[i].bounds_m))
        continue;
      const Landmark* older = best.landmarks.find(records[j].id);
      if (older == nullptr) continue;
      const Eigen::Vector2d apart_m = younger->mean_m - older->mean_m;
      const Eigen::Matrix2d covariance_m2 =
          younger->covariance_m2 + older->covariance_m2 + floor_m2;
      if (apart_m.dot(covariance_m2.inverse() * apart_m) > parameters_.creation_gate) continue;
      if (!records[i].descriptors.empty() &&
          logLikelihoodRatio(findMatcher(matchers_, records[i].type),
                             records[i].descriptors.front(), records[j].descriptors) < 0.0)
        continue;
      duplicates.push_back(records[i].id);
      break;
    }
  }
  for (const LandmarkId id : duplicates) remove(id);
}

}  // namespace ram_slam
