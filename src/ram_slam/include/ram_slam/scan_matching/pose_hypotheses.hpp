// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/scan_matching/correlative_search.hpp"
#include "ram_slam/scan_matching/pose_likelihood.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"

namespace ram_slam {

/// The search for the pose of a scan of which too little matches.
struct PoseSearchParameters {
  double resolution_m = 0.05;  ///< side of a cell of the likelihood grid
  double deviation_m = 0.06;   ///< of the readings in it
  int levels = 4;              ///< of the grid pyramid
  int max_points = 150;        ///< of the scan that are used, evenly spread
  int min_points = 20;         ///< without which no pose is searched
  double max_range_m = 30.0;   ///< readings beyond are not used: the grid would be large
  double min_score = 0.35;     ///< mean likelihood that a pose needs
  double angle_step_rad = 0.01;
  double wide_angle_rad = 3.2;    ///< to each side, when search_angle_rad has found nothing
  MotionGate distinct{0.2, 0.2};  ///< poses farther apart than this are different places
  double min_odds = 20.0;         ///< of the best place found over the second best
  /// Least share of what the best place gains over the wheels that it gains over the second best.
  double uniqueness = 0.3;

  static const ram_parameters::ParameterTable<PoseSearchParameters>& table();
};

/// The poses from which a scan may have been taken, each with its likelihood given the scan, the
/// scans before and the motion of the wheels.
///
/// ln p(pose | scan, wheels) = ln p(scan | pose) + ln[N(Q) + s N(R) + s a / V]: the scan's
/// likelihood is poseLogLikelihood(), N(Q) the normal distribution about the prediction with its
/// covariance, s the probability that the wheels slipped, after which their covariance is R, or,
/// with probability a, the robot anywhere in a volume V about the prediction.
class PoseHypotheses {
public:
  struct Settings {
    ScanMatcherParameters matcher;
    PoseLikelihoodParameters likelihood;
    PoseSearchParameters search;
    double slip_probability = 0.01;
    double anywhere_probability = 0.01;  ///< of a slip that leads anywhere
    double contradiction = 0.2;          ///< beyond this a pose does not belong to the scan
    double search_distance_m = 0.5;
  };
  /// What the wheels show of the laser's pose.
  struct Wheels {
    PosePrior prior;                   ///< with the inverse of Q
    Eigen::Matrix3d slip_information;  ///< the inverse of R
  };
  struct Hypothesis {
    ScanMatch match;
    double log_likelihood = 0.0;  ///< of scan and wheels, up to a constant
    bool searched = false;
    /// How much scan and references contradict each other: mean over the readings, 1 if all were
    /// seen through.
    double contradiction = 0.0;
  };

  /// Begins with the pose that the wheels predict, of which the scan knows nothing.
  /// The scans outlive this.
  PoseHypotheses(const SurfaceScan& surfaces,
                 std::vector<ReferenceScan> references,
                 const Wheels& wheels,
                 const Settings& settings);

  void add(const ScanMatch& match, bool searched = false);
  /// Adds the alignment from a guess.
  void alignFrom(const Pose2& guess, const PosePrior& prior);
  /// Searches around the prediction and adds what it finds, unless a second place is as likely. If
  /// the best pose so far contradicts the scan, and the two places differ along a corridor only,
  /// the one nearer to the prediction is added, without information about the direction along it.
  void search(double angle_rad);

  const Hypothesis& best() const { return best_; }

private:
  /// A pose as it is, of which the scan shows nothing.
  ScanMatch unaligned(const Pose2& map_from_laser) const;
  Hypothesis weighed(const ScanMatch& match, bool searched) const;
  /// The alignment from the best place in the window.
  std::optional<Hypothesis> found(const LikelihoodPyramid& pyramid,
                                  const SearchWindow& window) const;
  /// Of two places the one nearer to the prediction; which of them it is stays open.
  Hypothesis nearerOf(const Hypothesis& a, const Hypothesis& b) const;
  double logPrior(const Pose2& map_from_laser) const;

  const SurfaceScan& surfaces_;
  std::vector<ReferenceScan> references_;
  Wheels wheels_;
  const Settings& settings_;
  double slip_weight_ = 0.0;      ///< peak of s N(R) over that of N(Q)
  double anywhere_weight_ = 0.0;  ///< s a / V over the peak of N(Q)
  Hypothesis best_;
};

}  // namespace ram_slam
