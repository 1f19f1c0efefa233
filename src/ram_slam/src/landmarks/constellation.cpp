// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/landmarks/constellation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <tuple>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "ram_slam/landmarks/feature.hpp"

namespace ram_slam {
namespace {

void requireFinite(const Constellation& constellation) {
  for (const ConstellationPoint& point : constellation) {
    if (!point.position_m.allFinite() || !point.covariance_m2.allFinite()) {
      throw std::invalid_argument("positions and covariances of a constellation must be finite");
    }
  }
}

/// A pair of points that may be the same thing.
struct Putative {
  std::size_t target = 0;
  std::size_t source = 0;
  double likeness = 0.0;  ///< log-likelihood ratio of the appearances
};

/// A pose that two putatives agree on.
struct Vote {
  std::tuple<std::int64_t, std::int64_t, std::int64_t> cell;
  Pose2 target_from_source;
  double baseline_m = 0.0;
  double weight = 0.0;
};

/// Lays one source over one target.
class Overlay {
public:
  Overlay(const Constellation& target,
          const Constellation& source,
          const FeatureMatchers& matchers,
          const ConstellationParameters& parameters)
      : target_(target),
        source_(source),
        parameters_(parameters),
        search_(parameters.search),
        likeness_(source.size()) {
    for (std::size_t s = 0; s < source.size(); ++s) {
      likeness_[s].reserve(target.size());
      for (const ConstellationPoint& other : target)
        likeness_[s].push_back(likeness(other, source[s], matchers));
    }
  }

  std::vector<PoseHypothesis> hypotheses() const {
    std::vector<PoseHypothesis> all;
    for (const Pose2& pose : candidates(votes(putatives()))) all.push_back(refined(pose));
    return distinct(std::move(all));
  }

  PoseHypothesis refined(const Pose2& pose) const {
    PoseHypothesis best = scored(pose);
    for (int i = 0; i < search_.refinements && best.pairs.size() >= 2; ++i) {
      PoseHypothesis next = scored(fitted(best));
      if (next.score <= best.score) break;
      best = std::move(next);
    }
    if (best.pairs.size() >= 2) best.target_from_source.covariance = covarianceOf(best);
    return best;
  }

private:
  static constexpr double kImpossible = -std::numeric_limits<double>::infinity();

  static double likeness(const ConstellationPoint& a,
                         const ConstellationPoint& b,
                         const FeatureMatchers& matchers) {
    if (a.type != b.type) return kImpossible;
    const auto matcher = matchers.find(a.type);
    if (matcher == matchers.end()) return 0.0;
    double best = kImpossible;
    for (const DescriptorPointer& descriptor : b.descriptors) {
      if (descriptor == nullptr || a.descriptors.empty()) continue;
      best = std::max(best, logLikelihoodRatio(matcher->second.get(), descriptor, a.descriptors));
    }
    return best == kImpossible ? 0.0 : best;
  }

  /// The most alike first; ties in the order of the points.
  std::vector<Putative> putatives() const {
    std::vector<Putative> all;
    for (std::size_t s = 0; s < source_.size(); ++s) {
      for (std::size_t t = 0; t < target_.size(); ++t) {
        if (likeness_[s][t] >= parameters_.minimum_likeness) all.push_back({t, s, likeness_[s][t]});
      }
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.likeness > b.likeness; });
    const auto max_count = static_cast<std::size_t>(search_.max_putatives);
    if (all.size() > max_count) all.resize(max_count);
    return all;
  }

  std::vector<Vote> votes(const std::vector<Putative>& putatives) const {
    std::vector<Vote> all;
    for (std::size_t b = 1; b < putatives.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a) {
        if (static_cast<int>(all.size()) >= search_.max_votes) return all;
        if (agree(putatives[a], putatives[b])) all.push_back(vote(putatives[a], putatives[b]));
      }
    }
    return all;
  }

  /// Whether the points of the two pairs are as far apart in the target as in the source.
  bool agree(const Putative& a, const Putative& b) const {
    if (a.source == b.source || a.target == b.target) return false;
    const double in_source_m = (source_[a.source].position_m - source_[b.source].position_m).norm();
    if (in_source_m < parameters_.minimum_baseline) return false;
    const double in_target_m = (target_[a.target].position_m - target_[b.target].position_m).norm();
    const double variance_m2 =
        4.0 * parameters_.position_sigma * parameters_.position_sigma +
        0.5 * (source_[a.source].covariance_m2 + source_[b.source].covariance_m2 +
               target_[a.target].covariance_m2 + target_[b.target].covariance_m2)
                  .trace();
    const double difference_m = in_source_m - in_target_m;
    return difference_m * difference_m <
           search_.rigidity_sigmas * search_.rigidity_sigmas * variance_m2;
  }

  double orientationEvidence(double yaw_rad, std::size_t t, std::size_t s) const {
    const double variance_rad2 = target_[t].orientation_variance_rad2 +
                                 source_[s].orientation_variance_rad2 +
                                 search_.orientation_sigma_rad * search_.orientation_sigma_rad;
    return orientationLogRatio(yaw_rad + source_[s].orientation_rad - target_[t].orientation_rad,
                               variance_rad2, search_.wrong_orientations);
  }

  Vote vote(const Putative& a, const Putative& b) const {
    Vote result;
    result.target_from_source =
        alignPoints({target_[a.target].position_m, target_[b.target].position_m},
                    {source_[a.source].position_m, source_[b.source].position_m}, {1.0, 1.0});
    const Pose2& pose = result.target_from_source;
    const Eigen::Vector2d middle_m = pose * middle();
    const auto cells = static_cast<std::int64_t>(std::ceil(2.0 * M_PI / search_.vote_cell_rad));
    const auto turn = static_cast<std::int64_t>(
        std::floor((pose.yaw_rad + M_PI) / (2.0 * M_PI) * static_cast<double>(cells)));
    result.cell = {static_cast<std::int64_t>(std::floor(middle_m.x() / search_.vote_cell_m)),
                   static_cast<std::int64_t>(std::floor(middle_m.y() / search_.vote_cell_m)),
                   turn % cells};
    result.baseline_m = (source_[a.source].position_m - source_[b.source].position_m).norm();
    result.weight =
        std::max(search_.min_vote, search_.vote_base + a.likeness + b.likeness +
                                       orientationEvidence(pose.yaw_rad, a.target, a.source) +
                                       orientationEvidence(pose.yaw_rad, b.target, b.source));
    return result;
  }

  Eigen::Vector2d middle() const {
    Eigen::Vector2d sum_m = Eigen::Vector2d::Zero();
    for (const ConstellationPoint& point : source_) sum_m += point.position_m;
    return sum_m / static_cast<double>(source_.size());
  }

  /// Of each cell the pose with the longest baseline; the cells with the most votes first.
  std::vector<Pose2> candidates(std::vector<Vote> votes) const {
    std::stable_sort(votes.begin(), votes.end(),
                     [](const Vote& a, const Vote& b) { return a.cell < b.cell; });
    std::vector<Vote> best;
    for (const Vote& vote : votes) {
      if (best.empty() || best.back().cell != vote.cell) {
        best.push_back(vote);
        continue;
      }
      const double weight = best.back().weight + vote.weight;
      if (vote.baseline_m > best.back().baseline_m) best.back() = vote;
      best.back().weight = weight;
    }
    std::stable_sort(best.begin(), best.end(),
                     [](const Vote& a, const Vote& b) { return a.weight > b.weight; });
    const auto max_count = static_cast<std::size_t>(search_.max_scored);
    if (best.size() > max_count) best.resize(max_count);
    std::vector<Pose2> poses;
    for (const Vote& vote : best) poses.push_back(vote.target_from_source);
    return poses;
  }

  Eigen::Matrix2d covarianceOf(const Pose2& pose, std::size_t t, std::size_t s) const {
    const double floor_m2 = 2.0 * parameters_.position_sigma * parameters_.position_sigma;
    return target_[t].covariance_m2 +
           pose.rotation() * source_[s].covariance_m2 * pose.rotation().transpose() +
           floor_m2 * Eigen::Matrix2d::Identity();
  }

  /// The pairs that a pose brings together, each point once, the likeliest first.
  PoseHypothesis scored(const Pose2& pose) const {
    struct Found {
      double score;
      ConstellationPair pair;
    };
    std::vector<Found> found;
    for (std::size_t s = 0; s < source_.size(); ++s) {
      const Eigen::Vector2d place_m = pose * source_[s].position_m;
      for (std::size_t t = 0; t < target_.size(); ++t) {
        if (likeness_[s][t] == kImpossible) continue;
        const Eigen::Vector2d difference_m = target_[t].position_m - place_m;
        if (difference_m.squaredNorm() > search_.max_pair_distance_m * search_.max_pair_distance_m)
          continue;
        const Eigen::Matrix2d covariance_m2 = covarianceOf(pose, t, s);
        const double squared = difference_m.dot(covariance_m2.inverse() * difference_m);
        if (!(squared < search_.pair_gate)) continue;
        const double score =
            -0.5 * squared - std::log(2.0 * M_PI * std::sqrt(covariance_m2.determinant())) +
            likeness_[s][t] + orientationEvidence(pose.yaw_rad, t, s) -
            std::log(parameters_.unknown_feature_density) + std::log(parameters_.expected_overlap);
        if (score > 0.0) found.push_back({score, {t, s}});
      }
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Found& a, const Found& b) { return a.score > b.score; });
    PoseHypothesis result;
    result.target_from_source.pose = pose;
    std::vector<bool> source_used(source_.size(), false);
    std::vector<bool> target_used(target_.size(), false);
    for (const Found& candidate : found) {
      if (source_used[candidate.pair.source] || target_used[candidate.pair.target]) continue;
      source_used[candidate.pair.source] = target_used[candidate.pair.target] = true;
      result.pairs.push_back(candidate.pair);
      result.score += candidate.score;
    }
    result.score += static_cast<double>(source_.size() - result.pairs.size()) *
                    std::log(1.0 - parameters_.expected_overlap);
    return result;
  }

  Pose2 fitted(const PoseHypothesis& hypothesis) const {
    std::vector<Eigen::Vector2d> targets_m;
    std::vector<Eigen::Vector2d> sources_m;
    std::vector<double> weights;
    for (const ConstellationPair& pair : hypothesis.pairs) {
      targets_m.push_back(target_[pair.target].position_m);
      sources_m.push_back(source_[pair.source].position_m);
      weights.push_back(
          1.0 / covarianceOf(hypothesis.target_from_source.pose, pair.target, pair.source).trace());
    }
    return alignPoints(targets_m, sources_m, weights);
  }

  /// (sum H^T S^-1 H)^-1, H = [I, J R s].
  Eigen::Matrix3d covarianceOf(const PoseHypothesis& hypothesis) const {
    const Pose2& pose = hypothesis.target_from_source.pose;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    for (const ConstellationPair& pair : hypothesis.pairs) {
      const Eigen::Vector2d arm_m = pose.rotation() * source_[pair.source].position_m;
      Eigen::Matrix<double, 2, 3> by_pose;
      by_pose << 1.0, 0.0, -arm_m.y(), 0.0, 1.0, arm_m.x();
      information +=
          by_pose.transpose() * covarianceOf(pose, pair.target, pair.source).inverse() * by_pose;
    }
    return information.inverse();
  }

  std::vector<PoseHypothesis> distinct(std::vector<PoseHypothesis> all) const {
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.score > b.score; });
    std::vector<PoseHypothesis> kept;
    for (PoseHypothesis& hypothesis : all) {
      if (static_cast<int>(kept.size()) >= parameters_.most_hypotheses) break;
      const Pose2& pose = hypothesis.target_from_source.pose;
      const bool known = std::any_of(kept.begin(), kept.end(), [&](const PoseHypothesis& other) {
        const Pose2& better = other.target_from_source.pose;
        return (pose * middle() - better * middle()).norm() < parameters_.distinct_distance &&
               std::abs(wrapAngle(pose.yaw_rad - better.yaw_rad)) < parameters_.distinct_angle;
      });
      if (!known && hypothesis.pairs.size() >= 2) kept.push_back(std::move(hypothesis));
    }
    return kept;
  }

  const Constellation& target_;
  const Constellation& source_;
  const ConstellationParameters& parameters_;
  const ConstellationParameters::Search& search_;
  std::vector<std::vector<double>> likeness_;  ///< by source, then target
};

}  // namespace

Pose2 alignPoints(const std::vector<Eigen::Vector2d>& targets_m,
                  const std::vector<Eigen::Vector2d>& sources_m,
                  const std::vector<double>& weights) {
  if (targets_m.size() < 2 || sources_m.size() != targets_m.size() ||
      weights.size() != targets_m.size() ||
      !std::all_of(weights.begin(), weights.end(), [](double w) { return w > 0.0; })) {
    throw std::invalid_argument("aligning takes two or more pairs of points of positive weights");
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  Eigen::Vector2d target_mean_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d source_mean_m = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    target_mean_m += weights[i] / sum * targets_m[i];
    source_mean_m += weights[i] / sum * sources_m[i];
  }
  double cross = 0.0;
  double dot = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Eigen::Vector2d a = sources_m[i] - source_mean_m;
    const Eigen::Vector2d b = targets_m[i] - target_mean_m;
    cross += weights[i] * (a.x() * b.y() - a.y() * b.x());
    dot += weights[i] * a.dot(b);
  }
  Pose2 pose{0.0, 0.0, std::atan2(cross, dot)};
  const Eigen::Vector2d shift_m = target_mean_m - pose.rotation() * source_mean_m;
  pose.x_m = shift_m.x();
  pose.y_m = shift_m.y();
  return pose;
}

std::vector<PoseHypothesis> matchConstellations(const Constellation& target,
                                                const Constellation& source,
                                                const FeatureMatchers& matchers,
                                                const ConstellationParameters& parameters) {
  parameters.validate();
  requireFinite(target);
  requireFinite(source);
  if (target.size() < 2 || source.size() < 2) return {};
  return Overlay(target, source, matchers, parameters).hypotheses();
}

PoseHypothesis hypothesisAt(const Constellation& target,
                            const Constellation& source,
                            const FeatureMatchers& matchers,
                            const ConstellationParameters& parameters,
                            const Pose2& target_from_source) {
  parameters.validate();
  requireFinite(target);
  requireFinite(source);
  return Overlay(target, source, matchers, parameters).refined(target_from_source);
}

double chanceScore(const Constellation& target, const ConstellationParameters& parameters) {
  if (target.empty()) return 0.0;
  Eigen::AlignedBox2d bounds_m;
  for (const ConstellationPoint& point : target) bounds_m.extend(point.position_m);
  const double cell_m = parameters.search.chance_cell_sigmas * parameters.position_sigma;
  const Eigen::Vector2d cells = (bounds_m.sizes().array() / cell_m + 1.0).matrix();
  const double turns = 2.0 * M_PI / (cell_m / parameters.search.chance_arm_m);
  return std::log(cells.prod() * turns);
}

const PoseHypothesis* uniqueHypothesis(const std::vector<PoseHypothesis>& hypotheses,
                                       std::size_t source_size,
                                       double chance_score,
                                       const ConstellationParameters& parameters) {
  const auto by_score = [](const PoseHypothesis& a, const PoseHypothesis& b) {
    return a.score < b.score;
  };
  const auto best = std::max_element(hypotheses.begin(), hypotheses.end(), by_score);
  if (best == hypotheses.end()) return nullptr;
  const auto pairs = static_cast<double>(best->pairs.size());
  if (pairs < parameters.minimum_pairs ||
      pairs < parameters.minimum_overlap * static_cast<double>(source_size) ||
      best->score < chance_score + parameters.minimum_score) {
    return nullptr;
  }
  for (auto other = hypotheses.begin(); other != hypotheses.end(); ++other) {
    if (other != best && other->score > best->score - parameters.minimum_lead) return nullptr;
  }
  return &*best;
}

}  // namespace ram_slam
