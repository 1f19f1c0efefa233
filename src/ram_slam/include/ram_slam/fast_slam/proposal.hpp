// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "ram_slam/fast_slam/association.hpp"
#include "ram_slam/fast_slam/parameters.hpp"
#include "ram_slam/fast_slam/particle.hpp"
#include "ram_slam/geometry/random.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/motion/motion_step.hpp"

namespace ram_slam {

/// The distribution from which FastSLAM samples poses, and what depends on it: everything in which
/// versions 1.0 and 2.0 differ.
class Proposal {
public:
  virtual ~Proposal() = default;

  /// Where each particle is before the features are used, with the covariance from which it has
  /// still to be sampled.
  /// \param step  since the last list; from_ns is 0 before the first
  /// \param since_update  since the maps were updated last
  /// \throws std::invalid_argument if the model's poses are not finite or not one per particle
  /// \throws std::out_of_range as MotionModel::sample()
  virtual std::vector<PoseWithCovariance2> predict(const std::vector<Particle>& particles,
                                                   const MotionStep& step,
                                                   const PoseWithCovariance2& since_update,
                                                   std::uint64_t seed) const = 0;

  /// Associates the features with the particle's map from its predicted pose.
  virtual Evidence associate(const std::vector<Observation>& observations,
                             const Particle& particle,
                             Random random) const = 0;

  /// Whether poses are sampled and the maps updated with this list, which is not the first.
  /// \param is_at_last_update  the list has the stamp of the last update
  virtual bool isUpdateDue(const FeatureList& list,
                           const Pose2& since_update,
                           bool is_at_last_update) const = 0;

  /// \param effective_count  1 / sum of squares of the normalised weights
  virtual bool isResamplingDue(double effective_count, std::size_t particle_count) const = 0;

  /// Whether the estimate's covariance shall be that in the frame of the start, errors that all
  /// particles share included.
  virtual bool coversSharedErrors() const = 0;
};

/// FastSLAM 1.0 (Montemerlo et al., AAAI 2002): poses are sampled from the motion model alone.
class FastSlam1Proposal : public Proposal {
public:
  explicit FastSlam1Proposal(const FastSlamParameters& parameters) : parameters_(parameters) {}
  std::vector<PoseWithCovariance2> predict(const std::vector<Particle>& particles,
                                           const MotionStep& step,
                                           const PoseWithCovariance2& since_update,
                                           std::uint64_t seed) const override;
  Evidence associate(const std::vector<Observation>& observations,
                     const Particle& particle,
                     Random random) const override;
  bool isUpdateDue(const FeatureList&, const Pose2&, bool) const override { return true; }
  bool isResamplingDue(double, std::size_t) const override { return true; }
  bool coversSharedErrors() const override { return false; }

private:
  FastSlamParameters parameters_;
};

/// FastSLAM 2.0 (Montemerlo et al., IJCAI 2003): poses are sampled with the features in view taken
/// into account.
class FastSlam2Proposal : public Proposal {
public:
  explicit FastSlam2Proposal(const FastSlamParameters& parameters) : parameters_(parameters) {}
  std::vector<PoseWithCovariance2> predict(const std::vector<Particle>& particles,
                                           const MotionStep& step,
                                           const PoseWithCovariance2& since_update,
                                           std::uint64_t seed) const override;
  Evidence associate(const std::vector<Observation>& observations,
                     const Particle& particle,
                     Random random) const override;
  bool isUpdateDue(const FeatureList& list,
                   const Pose2& since_update,
                   bool is_at_last_update) const override;
  bool isResamplingDue(double effective_count, std::size_t particle_count) const override;
  bool coversSharedErrors() const override { return true; }

private:
  FastSlamParameters parameters_;
};

/// That of the mode.
std::shared_ptr<const Proposal> makeProposal(const FastSlamParameters& parameters);

}  // namespace ram_slam
