// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/trajectory_correction.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <unordered_map>

#include "ram_slam/fast_slam/fast_slam.hpp"
#include "ram_slam/fast_slam/landmark_records.hpp"

namespace ram_slam {

TrajectoryCorrection::TrajectoryCorrection(Trajectory path,
                                           const Trajectory& corrected,
                                           const std::optional<MotionGate>& loaded_frame)
    : path_(std::move(path)), is_map_loaded_(loaded_frame.has_value()) {
  const std::int64_t first_ns = std::max(path_.front().stamp_ns, corrected.front().stamp_ns);
  const std::int64_t last_ns = std::min(path_.back().stamp_ns, corrected.back().stamp_ns);
  if (last_ns < first_ns)
    throw std::invalid_argument("the corrected trajectory has no stamp in common with the path");
  map_from_corrected_ = *poseAt(path_, first_ns) * poseAt(corrected, first_ns)->inverse();
  if (loaded_frame) {
    if (loaded_frame->isExceededBy(map_from_corrected_))
      throw std::invalid_argument("the corrected trajectory is not in the frame of the map");
    map_from_corrected_ = {};
  }
  for (const StampedPose2& old : path_) {
    const std::int64_t stamp_ns = std::clamp(old.stamp_ns, first_ns, last_ns);
    const Pose2 before = stamp_ns == old.stamp_ns ? old.pose : *poseAt(path_, stamp_ns);
    new_from_old_.push_back(map_from_corrected_ * *poseAt(corrected, stamp_ns) * before.inverse());
  }
}

const Pose2& TrajectoryCorrection::newFromOld(std::int64_t stamp_ns) const {
  const auto after =
      std::upper_bound(path_.begin(), path_.end(), stamp_ns,
                       [](std::int64_t stamp, const auto& pose) { return stamp < pose.stamp_ns; });
  return new_from_old_[static_cast<std::size_t>(
      std::max<std::ptrdiff_t>(std::distance(path_.begin(), after) - 1, 0))];
}

Pose2 TrajectoryCorrection::ofLandmark(const LandmarkRecord& record) const {
  return is_map_loaded_ && record.placed_ns == 0 ? Pose2{} : newFromOld(record.placed_ns);
}

Path TrajectoryCorrection::correctedPath() const {
  Path path;
  for (std::size_t i = 0; i < path_.size(); ++i)
    path.append({path_[i].stamp_ns, new_from_old_[i] * path_[i].pose});
  return path;
}

Trajectory TrajectoryCorrection::inMap(Trajectory corrected) const {
  for (StampedPose2& stamped : corrected) stamped.pose = map_from_corrected_ * stamped.pose;
  return corrected;
}

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
  const TrajectoryCorrection correction(trajectory(), corrected, loaded_frame);

  // From here on nothing fails.
  std::vector<LandmarkTree*> trees;
  std::unordered_map<LandmarkId, Pose2> new_from_old;  // looked up, never walked through
  for (Particle& particle : particles_) trees.push_back(&particle.landmarks);
  for (const LandmarkRecord& record : registry_.records()) {
    new_from_old.emplace(record.id, correction.ofLandmark(record));
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
  shared_error_.follow(correction.inMap(corrected));
  for (LandmarkRecord& record : registry_.records())
    refreshBounds(record, particles_, parameters_.creation_gate);
  const LandmarkTree& landmarks = particles_[best_].landmarks;
  const auto apart = [&landmarks](LandmarkId younger, LandmarkId older) {
    return Eigen::Matrix2d(landmarks.find(younger)->covariance_m2 +
                           landmarks.find(older)->covariance_m2);
  };
  for (const LandmarkId id : duplicates(registry_, landmarks, apart, matchers_, parameters_))
    remove(id);
  return correction.mapFromCorrected();
}

}  // namespace ram_slam
