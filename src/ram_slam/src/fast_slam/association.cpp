// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/association.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ram_slam/landmarks/assignment.hpp"

namespace ram_slam {
namespace {

bool isMatched(const std::vector<Association>& associations, LandmarkId id) {
  return std::any_of(
      associations.begin(), associations.end(), [id](const Association& association) {
        return association.outcome == AssociationOutcome::kMatched && association.id == id;
      });
}

/// One particle's association while it is being worked out.
class Associator {
public:
  Associator(const std::vector<Observation>& observations,
             const LandmarkTree& landmarks,
             const PoseWithCovariance2& map_from_base,
             const FastSlamParameters& parameters)
      : observations_(observations),
        landmarks_(landmarks),
        parameters_(parameters),
        log_unknown_density_(std::log(parameters.unknown_feature_density)) {
    evidence_.map_from_base = map_from_base;
    evidence_.associations.resize(observations.size());
  }

  /// Pairs what can be paired; false if nothing was left to pair.
  bool pass() {
    findPairs();
    for (const Choice& choice : bestAssignment(pairs_)) {
      if (choice.margin >= parameters_.ambiguity_margin) use(pairs_[choice.candidate]);
    }
    return !pairs_.empty();
  }

  /// Samples one of the ways to pair the features left over, in proportion to their
  /// likelihood: of each feature for itself, or of several together.
  void sample(Random& random) {
    std::vector<std::size_t> open;
    std::size_t count = 1;
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      if (evidence_.associations[i].outcome == AssociationOutcome::kMatched) continue;
      const std::size_t alternatives = 1 + pairsOf(i).size();
      const bool full =
          !parameters_.draw_jointly ||
          count * alternatives > static_cast<std::size_t>(parameters_.maximum_hypotheses);
      if (full && !open.empty()) {
        sampleOne(open, random);
        open.clear();
        count = 1;
      }
      open.push_back(i);
      count *= alternatives;
    }
    if (!open.empty()) sampleOne(open, random);
  }

  Evidence finish() {
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      if (evidence_.associations[i].outcome != AssociationOutcome::kMatched && standsAlone(i)) {
        evidence_.associations[i].outcome = AssociationOutcome::kNew;
      }
    }
    return std::move(evidence_);
  }

private:
  /// One way to pair the features left over.
  struct Hypothesis {
    double score = 0.0;
    bool confirmed = true;  ///< pairs confirmed landmarks only
    Evidence evidence;
  };

  /// Samples one of the ways to pair these features.
  void sampleOne(const std::vector<std::size_t>& open, Random& random) {
    const double before = evidence_.log_likelihood_ratio;
    std::vector<Hypothesis> hypotheses;
    branch(open, 0, 0.0, true, hypotheses);
    double best = 0.0;
    for (const Hypothesis& hypothesis : hypotheses) best = std::max(best, hypothesis.score);
    double sum = 0.0;
    double confirmed_sum = 0.0;
    for (const Hypothesis& hypothesis : hypotheses) {
      const double likelihood = std::exp(hypothesis.score - best);
      sum += likelihood;
      if (hypothesis.confirmed) confirmed_sum += likelihood;
    }
    double place = random.uniform() * sum;
    std::size_t sampled = 0;
    for (; sampled + 1 < hypotheses.size(); ++sampled) {
      place -= std::exp(hypotheses[sampled].score - best);
      if (place < 0.0) break;
    }
    evidence_ = std::move(hypotheses[sampled].evidence);
    // What was sampled has happened with its probability already: the weight is what all have.
    // Alternatives with landmarks that are not confirmed weigh nothing.
    if (parameters_.draw_jointly)
      evidence_.log_likelihood_ratio = before + best + std::log(confirmed_sum);
  }

  /// All ways to pair open[depth] and those after it, each seen from the pose that the pairs before
  /// it have corrected.
  void branch(const std::vector<std::size_t>& open,
              std::size_t depth,
              double score,
              bool confirmed,
              std::vector<Hypothesis>& hypotheses) {
    if (depth == open.size()) {
      hypotheses.push_back({score, confirmed, evidence_});
      return;
    }
    for (const Candidate& pair : pairsOf(open[depth])) {
      const Evidence before = evidence_;
      use(pair);
      branch(open, depth + 1, score + pair.score, confirmed && candidateOf(pair).confirmed,
             hypotheses);
      evidence_ = before;
    }
    branch(open, depth + 1, score, confirmed, hypotheses);
  }

  /// Pairs within the gate, of features and landmarks that are still free. The column is the
  /// landmark's identifier.
  void findPairs() {
    pairs_.clear();
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      if (evidence_.associations[i].outcome == AssociationOutcome::kMatched) continue;
      findPairs(i, pairs_);
    }
  }

  std::vector<Candidate> pairsOf(std::size_t i) const {
    std::vector<Candidate> pairs;
    findPairs(i, pairs);
    return pairs;
  }

  void findPairs(std::size_t i, std::vector<Candidate>& pairs) const {
    for (const AssociationCandidate& candidate : observations_[i].candidates) {
      const Landmark* landmark = landmarks_.find(candidate.id);
      if (landmark == nullptr || isMatched(evidence_.associations, candidate.id)) continue;
      const Innovation found =
          innovation(evidence_.map_from_base, *landmark, observations_[i].measured);
      if (!(found.squaredMahalanobis() < parameters_.association_gate)) continue;
      pairs.push_back({i, candidate.id, score(found, candidate)});
    }
  }

  double score(const Innovation& found, const AssociationCandidate& candidate) const {
    return found.logLikelihood() + candidate.log_likelihood_ratio - log_unknown_density_;
  }

  const AssociationCandidate& candidateOf(const Candidate& pair) const {
    const std::vector<AssociationCandidate>& candidates = observations_[pair.row].candidates;
    return *std::find_if(candidates.begin(), candidates.end(),
                         [&pair](const AssociationCandidate& other) {
                           return other.id == static_cast<LandmarkId>(pair.column);
                         });
  }

  /// Matches the pair unless the corrections before it have moved it out of the gate.
  void use(const Candidate& pair) {
    const LandmarkId id = static_cast<LandmarkId>(pair.column);
    const AssociationCandidate& candidate = candidateOf(pair);
    const Innovation found =
        innovation(evidence_.map_from_base, *landmarks_.find(id), observations_[pair.row].measured);
    const double squared_mahalanobis = found.squaredMahalanobis();
    if (!(squared_mahalanobis < parameters_.association_gate)) return;
    evidence_.associations[pair.row] = {AssociationOutcome::kMatched, id};
    if (!candidate.confirmed) return;
    evidence_.log_likelihood_ratio += score(found, candidate);
    evidence_.squared_mahalanobis += squared_mahalanobis;
    ++evidence_.correction_count;
    evidence_.map_from_base = corrected(evidence_.map_from_base, found);
  }

  /// Whether a feature is far enough from every landmark to be another thing. Near a landmark that
  /// is matched by another feature of the same reading, "far enough" means that the two can be
  /// distinguished.
  bool standsAlone(std::size_t i) const {
    const PointMeasurement& measured = observations_[i].measured;
    const Eigen::Vector2d place_m = evidence_.map_from_base.pose * measured.position_m;
    for (const AssociationCandidate& candidate : observations_[i].candidates) {
      const Landmark* landmark = landmarks_.find(candidate.id);
      if (landmark == nullptr) continue;
      const auto match =
          std::find_if(evidence_.associations.begin(), evidence_.associations.end(),
                       [&candidate](const Association& association) {
                         return association.outcome == AssociationOutcome::kMatched &&
                                association.id == candidate.id;
                       });
      if (match == evidence_.associations.end()) {
        if ((landmark->mean_m - place_m).norm() < parameters_.minimum_feature_separation)
          return false;
        const Innovation apart = innovation(evidence_.map_from_base, *landmark, measured);
        if (apart.squaredMahalanobis() < parameters_.creation_gate) return false;
        continue;
      }
      const auto j = static_cast<std::size_t>(match - evidence_.associations.begin());
      if (maybeSame(i, j)) return false;
    }
    return !isDuplicate(i);
  }

  /// Whether an earlier new feature of the same reading may be the same thing.
  bool isDuplicate(std::size_t i) const {
    for (std::size_t j = 0; j < i; ++j) {
      if (evidence_.associations[j].outcome != AssociationOutcome::kNew) continue;
      if (observations_[j].type == observations_[i].type && maybeSame(i, j)) return true;
    }
    return false;
  }

  /// Whether two features of one reading may show the same thing; the pose does not matter.
  bool maybeSame(std::size_t i, std::size_t j) const {
    const PointMeasurement& other = observations_[j].measured;
    const Landmark there{other.position_m, other.covariance_m2};
    return innovation(Pose2{}, there, observations_[i].measured).squaredMahalanobis() <
           parameters_.duplicate_gate;
  }

  const std::vector<Observation>& observations_;
  const LandmarkTree& landmarks_;
  const FastSlamParameters& parameters_;
  double log_unknown_density_;
  std::vector<Candidate> pairs_;
  Evidence evidence_;
};

}  // namespace

Evidence associate(const std::vector<Observation>& observations,
                   const LandmarkTree& landmarks,
                   const PoseWithCovariance2& map_from_base,
                   const FastSlamParameters& parameters,
                   Random random) {
  Associator associator(observations, landmarks, map_from_base, parameters);
  bool left = true;
  for (int i = 0; i < parameters.association_passes && left; ++i) left = associator.pass();
  if (left) associator.sample(random);
  return associator.finish();
}

Evidence associateByDistance(const std::vector<Observation>& observations,
                             const LandmarkTree& landmarks,
                             const Pose2& map_from_base,
                             const FastSlamParameters& parameters) {
  Evidence evidence;
  evidence.map_from_base.pose = map_from_base;
  for (const Observation& observation : observations) {
    const Eigen::Vector2d place_m = map_from_base * observation.measured.position_m;
    const AssociationCandidate* nearest = nullptr;
    double distance_m = std::numeric_limits<double>::infinity();
    for (const AssociationCandidate& candidate : observation.candidates) {
      const Landmark* landmark = landmarks.find(candidate.id);
      if (landmark == nullptr || isMatched(evidence.associations, candidate.id)) continue;
      if ((landmark->mean_m - place_m).norm() >= distance_m) continue;
      distance_m = (landmark->mean_m - place_m).norm();
      nearest = &candidate;
    }
    Association association;
    if (distance_m < parameters.feature_match_distance) {
      association = {AssociationOutcome::kMatched, nearest->id};
      const Innovation found =
          innovation(map_from_base, *landmarks.find(nearest->id), observation.measured);
      evidence.log_likelihood_ratio +=
          found.logLikelihood() - std::log(parameters.unknown_feature_density);
      evidence.squared_mahalanobis += found.squaredMahalanobis();
      ++evidence.correction_count;
    } else if (distance_m >= parameters.minimum_feature_separation) {
      association.outcome = AssociationOutcome::kNew;
    }
    evidence.associations.push_back(association);
  }
  return evidence;
}

}  // namespace ram_slam
