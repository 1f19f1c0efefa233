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
constexpr double kSignificantOnOneLevel = 25.0;

/// A corner and the levels that speak for it, one bit each.
struct Candidate {
  Corner corner;
  std::uint32_t levels = 0;
};

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

bool onEnoughLevels(const Candidate& candidate, const FeatureDetectorParameters& parameters) {
  if (candidate.levels == 0) return false;
  return parameters.scale_levels == 1 || (candidate.levels & (candidate.levels >> 1)) != 0 ||
         candidate.corner.lines.significance >= kSignificantOnOneLevel;
}

void merge(const TwoLineCorner& lines,
           const ResponsePeak& peak,
           const FeatureDetectorParameters& parameters,
           std::vector<Candidate>& candidates) {
  auto same = std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& candidate) {
    return candidate.corner.lines.split == lines.split;
  });
  if (same == candidates.end()) {
    candidates.push_back({});
    same = candidates.end() - 1;
    same->corner.lines = lines;
  }
  if (peak.cornerness >= parameters.corner_threshold) same->levels |= 1U << peak.level;
  if (peak.cornerness > same->corner.cornerness) {
    same->corner.cornerness = peak.cornerness;
    same->corner.response = peak.min_eigenvalue;
    same->corner.level = peak.level;
  }
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

std::vector<Corner> selectCorners(const Contour& contour,
                                  const std::vector<ResponsePeak>& peaks,
                                  const FeatureDetectorParameters& parameters) {
  std::vector<Candidate> candidates;
  for (const ResponsePeak& peak : peaks) {
    const std::size_t nearest = contour.nearest(peak.point_m);
    if ((contour[nearest] - peak.point_m).norm() > kFarthestFromSurfaceM) continue;
    const auto lines = fitCorner(contour, nearest, parameters);
    if (lines && agrees(peak, *lines, parameters) && isAdmissible(*lines, contour, parameters)) {
      merge(*lines, peak, parameters, candidates);
    }
  }
  std::vector<Corner> corners;
  double best = 0.0;
  for (const Candidate& candidate : candidates) {
    if (!onEnoughLevels(candidate, parameters)) continue;
    corners.push_back(candidate.corner);
    best = std::max(best, candidate.corner.response);
  }
  if (parameters.relative_threshold) {
    corners.erase(std::remove_if(corners.begin(), corners.end(),
                                 [&](const Corner& corner) {
                                   return corner.response < parameters.feature_threshold * best;
                                 }),
                  corners.end());
  }
  corners = suppressNeighbours(std::move(corners), parameters.feature_distance);
  if (corners.size() > static_cast<std::size_t>(parameters.max_features)) {
    corners.resize(parameters.max_features);
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
