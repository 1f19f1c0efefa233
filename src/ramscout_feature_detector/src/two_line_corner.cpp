// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/two_line_corner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <Eigen/LU>

namespace ramscout_feature_detector {
namespace {

constexpr std::array kScreenScalesM = {0.1, 0.2, 0.4};
constexpr double kScreenCornernessShare = 0.6;
constexpr double kScreenSignificanceShare = 0.5;
constexpr double kScreenSpacingScales = 0.25;
/// Splits are searched from here on both sides of a bend, too: clutter has several near by.
constexpr double kScreenOffsetM = 0.1;
constexpr std::size_t kSmallestLegPoints = 3;

constexpr double kSplitWindowM = 0.2;
constexpr int kMostRecentrings = 5;
constexpr std::array kLegLengthsM = {0.1, 0.2, 0.4, 0.8};
constexpr double kContinuationSigmas = 4.0;
/// Shorter lines than this many standard deviations of the range have no direction.
constexpr double kShortestLineSigmas = 10.0;
constexpr std::size_t kBendSplits = 8;
/// Chi square (2 dof) exceeded once in 1100 straight legs.
constexpr double kBendSignificance = 14.0;
constexpr double kStraightSigmas = 1.2;
constexpr double kUnseenSpacings = 2.0;
constexpr double kUnseenSigmas = 4.0;
constexpr double kMarginSigmas = 3.0;
constexpr double kSmallestSinOpening = 0.1;
constexpr double kSmallestCosIncidence = 0.3;
/// What the model of two straight lines leaves out (0.5 mm), such as readings in steps of 1 mm.
constexpr double kModelVarianceM2 = 2.5e-7;
constexpr double kOrientationModelVarianceRad2 = 1e-5;

Eigen::Vector2d normalOf(const LineFit& line) {
  return {-line.direction.y(), line.direction.x()};
}

/// Variance across the line that the sensor's range noise makes, at the line's incidence.
double expectedNoise(const LineFit& line, const FeatureDetectorParameters& parameters) {
  const double range_m = line.centroid_m.norm();
  const double cos_incidence =
      range_m > 0.0 ? std::abs(normalOf(line).dot(line.centroid_m)) / range_m : 1.0;
  const double sigma_m =
      parameters.laser_range_sigma * std::max(cos_incidence, kSmallestCosIncidence);
  return sigma_m * sigma_m;
}

double cornernessOf(const LineFit& a, const LineFit& b) {
  return 0.5 * (1.0 - std::abs(a.direction.dot(b.direction)));
}

/// chi square of equal directions; the chord stands for the angle.
double significanceOf(const LineFit& a,
                      const LineFit& b,
                      const FeatureDetectorParameters& parameters) {
  const double chord2 = 2.0 * (1.0 - a.direction.dot(b.direction));
  return chord2 / (a.angleVariance(a.noiseVariance(expectedNoise(a, parameters))) +
                   b.angleVariance(b.noiseVariance(expectedNoise(b, parameters))));
}

/// Significance of a bend with legs of `scale_m` at every point; 0 where the legs are too short,
/// too straight or not significant.
std::vector<double> screen(const Contour& contour,
                           double scale_m,
                           const FeatureDetectorParameters& parameters) {
  std::vector<double> significance(contour.size(), 0.0);
  // Cornerness is 1/2 (1 - |cos(angle)|).
  const double cosine = 1.0 - 2.0 * kScreenCornernessShare * parameters.corner_threshold;
  const double cos_twice = 2.0 * cosine * cosine - 1.0;
  std::size_t first = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < contour.size(); ++i) {
    while (contour.arc_m(first) < contour.arc_m(i) - scale_m) ++first;
    while (last + 1 < contour.size() && contour.arc_m(last + 1) <= contour.arc_m(i) + scale_m) {
      ++last;
    }
    if (i + 1 < first + kSmallestLegPoints || last + 1 < i + kSmallestLegPoints) continue;
    if (!contour.bendsAt(first, i, last, cos_twice)) continue;
    significance[i] = significanceOf(contour.fit(first, i), contour.fit(i, last), parameters);
  }
  return significance;
}

/// Adds the points whose value exceeds `least` and that of all points within half of `scale_m`.
void addPeaks(const Contour& contour,
              const std::vector<double>& values,
              double least,
              double scale_m,
              std::set<std::size_t>& peaks) {
  const double spacing_m = kScreenSpacingScales * scale_m;
  for (std::size_t i = 0; i < contour.size(); ++i) {
    if (values[i] <= least) continue;
    bool is_peak = true;
    for (std::size_t j = contour.indexAt(contour.arc_m(i) - spacing_m);
         is_peak && j < contour.size() && contour.arc_m(j) <= contour.arc_m(i) + spacing_m; ++j) {
      is_peak = j < i ? values[j] < values[i] : values[j] <= values[i];
    }
    if (!is_peak) continue;
    for (const double offset_m : {-kScreenOffsetM, 0.0, kScreenOffsetM}) {
      peaks.insert(contour.indexAt(contour.arc_m(i) + offset_m));
    }
  }
}

/// The split of the points first..last into two lines that leaves the least squared distance.
std::size_t bestSplit(const Contour& contour, std::size_t first, std::size_t last) {
  std::size_t best = first + kSmallestLegPoints - 1;
  double best_m2 = std::numeric_limits<double>::infinity();
  for (std::size_t split = best; split + kSmallestLegPoints <= last; ++split) {
    const double residual_m2 =
        contour.residual_m2(first, split) + contour.residual_m2(split + 1, last);
    if (residual_m2 < best_m2) {
      best_m2 = residual_m2;
      best = split;
    }
  }
  return best;
}

/// Whether the distances from the line are no larger than noise makes them: chi square of the
/// distances.
bool isStraight(const LineFit& line, const FeatureDetectorParameters& parameters) {
  const double sigma_m = kStraightSigmas * parameters.laser_range_sigma;
  const double freedom = line.count - 2;
  return line.residual_m2 <=
         sigma_m * sigma_m * (freedom + kContinuationSigmas * std::sqrt(2.0 * freedom));
}

/// Whether two lines, meeting anywhere, explain the points first..last better than one does by more
/// than noise accounts for: a likelihood ratio test, far more sensitive to a bend near the end than
/// the size of the residuals is.
bool isBent(const Contour& contour, std::size_t first, std::size_t last, double noise_m2) {
  const double whole_m2 = contour.residual_m2(first, last);
  const std::size_t count = last - first + 1;
  for (std::size_t i = 1; i < kBendSplits; ++i) {
    const std::size_t split = first + i * count / kBendSplits;
    if (split + 1 < first + kSmallestLegPoints || last < split + kSmallestLegPoints) continue;
    const double parts_m2 =
        contour.residual_m2(first, split) + contour.residual_m2(split + 1, last);
    if (whole_m2 - parts_m2 > kBendSignificance * noise_m2) return true;
  }
  return false;
}

/// A straight run of points of the contour.
struct Leg {
  std::size_t first;
  std::size_t last;
  LineFit line;
};

/// The points of the contour within a distance before the split, or after it.
std::optional<Leg> legOf(const Contour& contour, std::size_t split, bool before, double length_m) {
  std::size_t first = split + 1;
  std::size_t last = split;
  if (before) {
    first = contour.indexAt(contour.arc_m(split) - length_m);
  } else {
    last = contour.indexAt(contour.arc_m(first) + length_m);
    if (contour.arc_m(last) > contour.arc_m(first) + length_m) --last;
  }
  if (last + 1 < first + kSmallestLegPoints) return std::nullopt;
  return Leg{first, last, contour.fit(first, last)};
}

/// The longest straight leg that ends (before) or begins (after) at the split.
std::optional<Leg> longestLeg(const Contour& contour,
                              std::size_t split,
                              bool before,
                              const FeatureDetectorParameters& parameters) {
  std::optional<Leg> longest;
  for (const double length_m : kLegLengthsM) {
    if (length_m < kShortestLineSigmas * parameters.laser_range_sigma) continue;
    const auto leg = legOf(contour, split, before, length_m);
    if (!leg) continue;
    if (longest && isBent(contour, leg->first, leg->last,
                          longest->line.noiseVariance(expectedNoise(longest->line, parameters)))) {
      break;
    }
    if (!isStraight(leg->line, parameters)) break;
    longest = leg;
  }
  return longest;
}

/// Whether the leg is seen up to the corner: else one surface ends in front of another, and the
/// lines cross where nothing was seen.
bool reaches(const Contour& contour,
             const Leg& leg,
             bool before,
             const Eigen::Vector2d& corner_m,
             const FeatureDetectorParameters& parameters) {
  const double length_m = leg.line.direction.dot(contour[leg.last] - contour[leg.first]);
  const double spacing_m = length_m / (leg.line.count - 1);
  const Eigen::Vector2d& end = contour[before ? leg.last : leg.first];
  return (end - corner_m).norm() <=
         kUnseenSpacings * spacing_m + kUnseenSigmas * parameters.laser_range_sigma;
}

/// The leg's line without the points closer to the corner than noise reaches: which leg they were
/// counted to depended on their noise.
LineFit trimmedLine(const Contour& contour,
                    Leg leg,
                    bool before,
                    const Eigen::Vector2d& corner_m,
                    double margin_m) {
  const auto isTooClose = [&](std::size_t index) {
    return std::abs(leg.line.direction.dot(contour[index] - corner_m)) < margin_m;
  };
  while (leg.last + 1 > leg.first + kSmallestLegPoints &&
         isTooClose(before ? leg.last : leg.first)) {
    if (before) {
      --leg.last;
    } else {
      ++leg.first;
    }
  }
  return contour.refine(contour.fit(leg.first, leg.last), leg.first, leg.last);
}

/// Variance of the line's distance from a point in its prolongation.
double offsetVariance(const LineFit& line, double noise_m2, const Eigen::Vector2d& point_m) {
  const double along_m = line.direction.dot(point_m - line.centroid_m);
  return noise_m2 * (1.0 / line.count + along_m * along_m / line.spread_m2);
}

std::optional<TwoLineCorner> cross(const LineFit& before,
                                   const LineFit& after,
                                   const FeatureDetectorParameters& parameters) {
  Eigen::Matrix2d normals;
  normals << normalOf(before).transpose(), normalOf(after).transpose();
  if (std::abs(normals.determinant()) < kSmallestSinOpening) return std::nullopt;
  const Eigen::Matrix2d inverse = normals.inverse();

  TwoLineCorner corner;
  corner.position_m = inverse * Eigen::Vector2d(normalOf(before).dot(before.centroid_m),
                                                normalOf(after).dot(after.centroid_m));
  const double noise_before_m2 = before.noiseVariance(expectedNoise(before, parameters));
  const double noise_after_m2 = after.noiseVariance(expectedNoise(after, parameters));
  const Eigen::Vector2d variances_m2(offsetVariance(before, noise_before_m2, corner.position_m),
                                     offsetVariance(after, noise_after_m2, corner.position_m));
  corner.covariance_m2 = inverse * variances_m2.asDiagonal() * inverse.transpose() +
                         kModelVarianceM2 * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d bisector = after.direction - before.direction;
  corner.orientation_rad = std::atan2(bisector.y(), bisector.x());
  corner.orientation_variance_rad2 =
      0.25 * (before.angleVariance(noise_before_m2) + after.angleVariance(noise_after_m2)) +
      kOrientationModelVarianceRad2;
  corner.cornerness = cornernessOf(before, after);
  corner.significance = significanceOf(before, after, parameters);
  return corner;
}

}  // namespace

std::vector<std::size_t> findCandidates(const Contour& contour,
                                        const FeatureDetectorParameters& parameters) {
  std::set<std::size_t> candidates;
  for (const double scale_m : kScreenScalesM) {
    if (scale_m < kShortestLineSigmas * parameters.laser_range_sigma) continue;
    addPeaks(contour, screen(contour, scale_m, parameters),
             kScreenSignificanceShare * parameters.significance_min, scale_m, candidates);
  }
  return {candidates.begin(), candidates.end()};
}

std::optional<std::size_t> findSplit(const Contour& contour, std::size_t near_index) {
  std::size_t split = near_index;
  for (int i = 0; i < kMostRecentrings; ++i) {
    const std::size_t first = std::min(contour.indexAt(contour.arc_m(split) - kSplitWindowM),
                                       split - std::min(split, kSmallestLegPoints - 1));
    const std::size_t last = std::max(contour.indexAt(contour.arc_m(split) + kSplitWindowM),
                                      std::min(split + kSmallestLegPoints, contour.size() - 1));
    if (last + 1 < first + 2 * kSmallestLegPoints) return std::nullopt;
    const std::size_t better = bestSplit(contour, first, last);
    if (better == split) break;
    split = better;
  }
  return split;
}

std::optional<TwoLineCorner> fitCorner(const Contour& contour,
                                       std::size_t split,
                                       const FeatureDetectorParameters& parameters) {
  const auto before = longestLeg(contour, split, true, parameters);
  const auto after = longestLeg(contour, split, false, parameters);
  if (!before || !after) return std::nullopt;
  const auto rough = cross(before->line, after->line, parameters);
  if (!rough || !reaches(contour, *before, true, rough->position_m, parameters) ||
      !reaches(contour, *after, false, rough->position_m, parameters)) {
    return std::nullopt;
  }
  const double sin_opening = std::abs(normalOf(before->line).dot(after->line.direction));
  const double margin_m = kMarginSigmas * parameters.laser_range_sigma / sin_opening;
  auto corner = cross(trimmedLine(contour, *before, true, rough->position_m, margin_m),
                      trimmedLine(contour, *after, false, rough->position_m, margin_m), parameters);
  if (!corner) return std::nullopt;
  corner->split = split;
  return corner;
}

}  // namespace ramscout_feature_detector
