// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/corner_selection.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <Eigen/LU>

namespace ramscout_feature_detector {
namespace {

constexpr double kFarthestFromSurfaceM = 0.15;
constexpr double kFarthestPeakPixels = 5.0;
constexpr double kSameCornerM = 0.03;
constexpr double kSignificantOnOneLevel = 25.0;

bool isCertain(const Eigen::Matrix2d& covariance_m2, const FeatureDetectorParameters& parameters) {
  if (covariance_m2.cwiseAbs().maxCoeff() > parameters.covariance_limit) return false;
  const double mean = 0.5 * covariance_m2.trace();
  const double largest = mean + std::sqrt(std::max(mean * mean - covariance_m2.determinant(), 0.0));
  return largest <= parameters.position_sigma_limit * parameters.position_sigma_limit;
}

/// Whether the ridges in the image cross where the lines do.
bool agrees(const ResponsePeak& peak,
            const TwoLineCorner& lines,
            const FeatureDetectorParameters& parameters) {
  const double ppm = std::ldexp(parameters.ppm, -peak.level);
  return (peak.point_m - lines.position_m).norm() * ppm <= kFarthestPeakPixels;
}

/// Two splits some points apart may stand for one corner.
bool isSame(const TwoLineCorner& a, const TwoLineCorner& b) {
  return a.split == b.split || (a.position_m - b.position_m).norm() < kSameCornerM;
}

void sortStrongestFirst(std::vector<Corner>& corners) {
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.response > b.response; });
}

}  // namespace

bool isAdmissible(const TwoLineCorner& corner,
                  const Contour& contour,
                  const FeatureDetectorParameters& parameters) {
  const auto nearEnd = [&](const Eigen::Vector2d& end_m) {
    return (corner.position_m - end_m).norm() < parameters.occlude_limit;
  };
  if (!contour.closed() && (nearEnd(contour.front()) || nearEnd(contour.back()))) return false;
  return corner.cornerness >= parameters.corner_threshold &&
         corner.significance >= parameters.significance_min &&
         isCertain(corner.covariance_m2, parameters);
}

const std::optional<TwoLineCorner>& CornerCollection::linesAt(std::size_t near_index) {
  static const std::optional<TwoLineCorner> none;
  const auto split = findSplit(contour_, near_index);
  if (!split) return none;
  const auto known = lines_.find(*split);
  if (known != lines_.end()) return known->second;
  auto lines = fitCorner(contour_, *split, parameters_);
  if (lines && !isAdmissible(*lines, contour_, parameters_)) lines.reset();
  return lines_.emplace(*split, lines).first->second;
}

void CornerCollection::add(const ResponsePeak& peak) {
  if (peak.cornerness < parameters_.corner_threshold) return;
  const std::size_t nearest = contour_.nearest(peak.point_m);
  if ((contour_[nearest] - peak.point_m).norm() > kFarthestFromSurfaceM) return;
  const auto& lines = linesAt(nearest);
  if (!lines || !agrees(peak, *lines, parameters_)) return;
  auto same = std::find_if(candidates_.begin(), candidates_.end(), [&](const auto& candidate) {
    return isSame(candidate.corner.lines, *lines);
  });
  if (same == candidates_.end()) {
    candidates_.push_back({{*lines, peak.level}, 0});
    same = candidates_.end() - 1;
  }
  same->levels |= 1U << peak.level;
  Corner& corner = same->corner;
  if (peak.level < corner.level ||
      (peak.level == corner.level && peak.min_eigenvalue > corner.response)) {
    corner.level = peak.level;
    corner.response = peak.min_eigenvalue;
    corner.cornerness = peak.cornerness;
  }
}

bool CornerCollection::isAccepted(const Candidate& candidate) const {
  return parameters_.scale_levels == 1 || (candidate.levels & (candidate.levels >> 1)) != 0 ||
         candidate.corner.lines.significance >= kSignificantOnOneLevel;
}

bool CornerCollection::isSettled(const TwoLineCorner& lines) const {
  return std::any_of(candidates_.begin(), candidates_.end(), [&](const Candidate& candidate) {
    return isSame(candidate.corner.lines, lines) && isAccepted(candidate);
  });
}

std::vector<Corner> CornerCollection::select() const {
  std::vector<Corner> corners;
  double best = 0.0;
  for (const Candidate& candidate : candidates_) {
    if (!isAccepted(candidate)) continue;
    corners.push_back(candidate.corner);
    best = std::max(best, candidate.corner.response);
  }
  if (parameters_.relative_threshold) {
    corners.erase(std::remove_if(corners.begin(), corners.end(),
                                 [&](const Corner& corner) {
                                   return corner.response < parameters_.feature_threshold * best;
                                 }),
                  corners.end());
  }
  corners = suppressNeighbours(std::move(corners), parameters_.feature_distance);
  if (corners.size() > static_cast<std::size_t>(parameters_.max_features)) {
    corners.resize(parameters_.max_features);
  }
  return corners;
}

std::vector<Corner> suppressNeighbours(std::vector<Corner> corners, double distance_m) {
  sortStrongestFirst(corners);
  std::vector<Corner> kept;
  for (const Corner& corner : corners) {
    const bool is_free = std::none_of(kept.begin(), kept.end(), [&](const Corner& stronger) {
      return (stronger.lines.position_m - corner.lines.position_m).norm() < distance_m;
    });
    if (is_free) kept.push_back(corner);
  }
  return kept;
}

}  // namespace ramscout_feature_detector
