// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ram_slam/ekf_slam/ekf_slam_parameters.hpp"
#include "ram_slam/ekf_slam/joint_belief.hpp"
#include "ram_slam/fast_slam/association.hpp"
#include "ram_slam/fast_slam/landmark_filter.hpp"
#include "ram_slam/fast_slam/landmark_records.hpp"
#include "ram_slam/fast_slam/shared_error.hpp"

namespace ram_slam {

/// Simultaneous localisation and mapping with one normal distribution over the pose and all
/// landmarks together (Smith, Self and Cheeseman, 1990), with the consistent error of JointBelief.
///
/// Features are associated one after the other, the most certain first, each within the gate given
/// those before it: a set of pairs is accepted only if it is jointly compatible. What stays
/// uncertain is ignored, since there is one hypothesis only. A landmark corrects the pose once it
/// is confirmed; until then its sightings count for its existence alone. docs/ekf_slam.md has the
/// equations.
class EkfSlam : public LandmarkFilter {
public:
  /// \throws std::invalid_argument as EkfSlamParameters::validate()
  explicit EkfSlam(const EkfSlamParameters& parameters,
                   FeatureMatchers matchers = {},
                   const PoseWithCovariance2& map_from_base = {});
  std::unique_ptr<LandmarkFilter> clone() const override {
    return std::make_unique<EkfSlam>(*this);
  }

  void update(const FeatureList& list,
              const MotionStep& step,
              const FieldOfView* view = nullptr) override;
  void check(const FeatureList& list) const override { requireGood(list, stamp_ns_); }

  std::int64_t stamp_ns() const override { return stamp_ns_; }
  /// The covariance is that of the pose in the frame of the start, and SharedError.
  const PoseWithCovariance2& estimate() const override { return estimate_; }
  Trajectory trajectory() const override { return best().path.poses(); }
  /// Covariances between landmarks fall to 0 over the distance up to which they are stated, so that
  /// the joint covariance stays positive semi-definite when what is not stated is 0 (Furrer et al.,
  /// J. Comput. Graph. Stat. 15(3), 2006).
  LandmarkMap landmarks() const override;
  const Particle& best() const override { return hypotheses_.front(); }
  const LandmarkRegistry& registry() const override { return registry_; }
  const std::vector<Association>& associations() const override { return associations_; }
  double confirm_log_odds() const override { return common().confirm_log_odds; }
  std::vector<std::pair<std::string, double>> health() const override;
  /// Pose and landmarks at the last update of the map.
  const JointBelief& belief() const { return belief_; }

  void setPose(const PoseWithCovariance2& map_from_base) override;
  void setPose(const PoseWithCovariance2& map_from_base, std::int64_t stamp_ns) override;
  void movePose(const Pose2& new_from_old) override;
  /// Covariances between the landmarks are taken over if all of them together are positive
  /// definite.
  void setMap(const LandmarkMap& map, const Trajectory& path) override;
  void fixMap() override { is_map_fixed_ = true; }
  bool isMapFixed() const override { return is_map_fixed_; }
  /// Each landmark moves with the pose from which it was first seen; no information is added.
  Pose2 followTrajectory(const Trajectory& corrected) override;

private:
  const FastSlamParameters& common() const { return parameters_.common; }
  Particle& hypothesis() { return hypotheses_.front(); }
  /// Position of a landmark in belief_: that of its record.
  std::size_t indexOf(LandmarkId id) const;
  Evidence associate(const std::vector<Observation>& observations,
                     const PoseWithCovariance2& since_update) const;
  /// Takes in the evidence for good.
  void updateMap(const FeatureList& list,
                 const std::vector<DescriptorPointer>& descriptors,
                 const std::vector<Observation>& observations,
                 const Evidence& evidence);
  void remove(const std::vector<LandmarkId>& ids);
  /// Makes hypothesis() and the bounds of the records agree with belief_.
  void publish();

  EkfSlamParameters parameters_;
  FeatureMatchers matchers_;
  JointBelief belief_;  ///< at the last update of the map; its landmarks are the registry's records
  LandmarkRegistry registry_;
  /// One: what belief_ says, for what works with particles.
  std::vector<Particle> hypotheses_ = std::vector<Particle>(1);
  PoseWithCovariance2 estimate_;
  SharedError shared_error_;
  MatchQuality quality_;
  std::vector<Association> associations_;
  int left_out_count_ = 0;  ///< features of new landmarks beyond max_landmarks
  bool is_map_fixed_ = false;
  bool is_map_loaded_ = false;  ///< so that its frame is not that of the path's first pose
  std::int64_t stamp_ns_ = 0;
  std::int64_t updated_ns_ = 0;       ///< when the map was updated last
  PoseWithCovariance2 since_update_;  ///< the motion since then
};

/// For the registry of estimators.
FilterEntry ekfSlamEntry();

}  // namespace ram_slam
