// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ram_slam/fast_slam/association.hpp"
#include "ram_slam/fast_slam/landmark_filter.hpp"
#include "ram_slam/fast_slam/landmark_records.hpp"
#include "ram_slam/fast_slam/landmark_registry.hpp"
#include "ram_slam/fast_slam/landmark_tree.hpp"
#include "ram_slam/fast_slam/map_drift.hpp"
#include "ram_slam/fast_slam/parameters.hpp"
#include "ram_slam/fast_slam/particle.hpp"
#include "ram_slam/fast_slam/proposal.hpp"
#include "ram_slam/fast_slam/shared_error.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/geometry/random.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/landmarks/landmark_map.hpp"
#include "ram_slam/motion/motion_step.hpp"
#include "ram_slam/sensing/field_of_view.hpp"

namespace ram_slam {

/// How well the filter does, matches as in the best particle.
struct FastSlamQuality : MatchQuality {
  double effective_fraction = 1.0;  ///< effective particles over all, before the last resampling
};

/// Simultaneous localisation and mapping with a particle per path and a Kalman filter per landmark
/// in it.
///
/// FastSLAM 2.0: Montemerlo, Thrun, Koller, Wegbreit, IJCAI 2003; 1.0: the same, AAAI 2002.
/// docs/fast_slam.md relates equations and functions. Knows neither robot nor sensor: the motion
/// comes from a MotionModel, what a sensor saw from a FeatureList, what it would have seen from a
/// FieldOfView. Deterministic: the same input gives the same bytes.
class FastSlam : public LandmarkFilter {
public:
  /// \param map_from_base  where the robot is at the first list
  /// \throws std::invalid_argument as FastSlamParameters::validate(), or if the pose or its
  /// covariance is not finite
  explicit FastSlam(const FastSlamParameters& parameters,
                    FeatureMatchers matchers = {},
                    const PoseWithCovariance2& map_from_base = {});

  std::unique_ptr<LandmarkFilter> clone() const override {
    return std::make_unique<FastSlam>(*this);
  }

  /// \throws also std::out_of_range as MotionModel::sample() (fast_slam_1)
  void update(const FeatureList& list,
              const MotionStep& step,
              const FieldOfView* view = nullptr) override;
  /// The same, asking the model for the motion. \throws std::out_of_range as MotionModel::motion()
  void update(const FeatureList& list, const MotionModel& model, const FieldOfView* view = nullptr);

  void check(const FeatureList& list) const override { requireGood(list, stamp_ns_); }

  std::int64_t stamp_ns() const override { return stamp_ns_; }

  /// Mean over all particles and what each of them was sampled from, at stamp_ns(). The covariance
  /// is that of the pose in the frame of the start: the mixture's, or MapDrift's if that is more,
  /// and SharedError (fast_slam_2).
  const PoseWithCovariance2& estimate() const override { return estimate_; }
  /// The path of the best particle.
  Trajectory trajectory() const override { return particles_[best_].path.poses(); }
  /// The landmarks that the best particle holds, each averaged over all particles that hold it.
  LandmarkMap landmarks() const override;
  const std::vector<Particle>& particles() const { return particles_; }
  const Particle& best() const override { return particles_[best_]; }
  const FastSlamQuality& quality() const { return quality_; }
  /// As the best particle has them.
  const std::vector<Association>& associations() const override { return associations_; }
  /// What all particles know alike about the landmarks.
  const LandmarkRegistry& registry() const override { return registry_; }
  double confirm_log_odds() const override { return parameters_.confirm_log_odds; }
  /// The poses of all particles.
  std::vector<Pose2> hypotheses() const override;
  std::vector<std::pair<std::string, double>> health() const override;

  /// The robot is there, whatever the filter thought; the best particle's map is kept.
  void setPose(const PoseWithCovariance2& map_from_base) override;
  void setPose(const PoseWithCovariance2& map_from_base, std::int64_t stamp_ns) override;

  /// Moves the newest pose of all particles to new_from_old * pose, in the same maps: an error that
  /// all of them share was measured otherwise.
  void movePose(const Pose2& new_from_old) override;

  /// The map and the path are the same for all particles.
  void setMap(const LandmarkMap& map, const Trajectory& path = {}) override;

  void fixMap() override { is_map_fixed_ = true; }
  bool isMapFixed() const override { return is_map_fixed_; }

  /// Bends the map so that the robot came along the corrected trajectory, as a smoother found it:
  /// each landmark moves with the pose from which it was first seen, the particles with the newest
  /// one. The first common pose stays where it is; but if the map was learned before (setMap()
  /// without a path), the corrected trajectory must be in its frame, and its landmarks stay, unless
  /// they were placed since. Landmarks that come to lie on an older one like
  /// them are dropped. All particles share the corrected path from then on.
  /// \returns the frame of the corrected trajectory, seen from the map
  /// \throws std::invalid_argument, nothing changed, if the trajectory is empty, not finite, not in
  /// the order of its stamps, has none in common with the filter's or is not in the map's frame
  Pose2 followTrajectory(const Trajectory& corrected) override;

  /// Gives every particle nodes of its own. Changes no result: what a filter without sharing would
  /// be.
  void unshare();
  /// Bytes of all particles' maps together, shared nodes counted once.
  std::size_t landmarkBytes() const;

private:
  /// Associates in every particle, corrects it and estimates the pose.
  std::vector<Evidence> weigh(const std::vector<Observation>& observations);
  void samplePoses(const std::vector<Evidence>& evidence);
  void updateMaps(const FeatureList& list,
                  const std::vector<DescriptorPointer>& descriptors,
                  const std::vector<Observation>& observations,
                  const std::vector<Evidence>& evidence);
  /// The landmark that other particles already have where this feature is and this one has not.
  std::optional<LandmarkId> idUsedElsewhere(const Observation& observation,
                                            const Particle& particle) const;
  /// Makes the estimate's covariance that of a pose in the frame of the start.
  /// \param moved_m  since the list before
  void coverErrors(double moved_m);
  void resample();
  void remove(LandmarkId id);
  /// Landmarks that no particle holds any more.
  void forgetAbandoned();

  FastSlamParameters parameters_;
  FeatureMatchers matchers_;
  std::shared_ptr<const Proposal> proposal_;  ///< of the mode; shared by copies
  LandmarkRegistry registry_;
  std::vector<Particle> particles_;
  std::size_t best_ = 0;
  PoseWithCovariance2 estimate_;
  MapDrift drift_;
  SharedError shared_error_;
  FastSlamQuality quality_;
  std::vector<Association> associations_;
  bool is_map_fixed_ = false;
  bool is_map_loaded_ = false;  ///< so that its frame is not that of the path's first pose
  std::int64_t stamp_ns_ = 0;
  std::uint64_t update_count_ = 0;
  std::int64_t updated_ns_ = 0;       ///< when poses were sampled and maps updated last
  PoseWithCovariance2 since_update_;  ///< the motion since then
};

/// For the registry of estimators.
FilterEntry fastSlamEntry();
/// Makes filters with these settings.
LandmarkFilterFactory fastSlamFactory(const FastSlamParameters& parameters,
                                      FeatureMatchers matchers = {});

}  // namespace ram_slam
