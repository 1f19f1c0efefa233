// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/two_line_corner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/LU>

namespace ramscout_feature_detector {
namespace {

constexpr double kBendCornernessShare = 0.6;
constexpr double kBendSignificanceShare = 0.5;
constexpr std::size_t kSmallestLegPoints = 3;
constexpr std::size_t kSmallestCertainPoints = 2;

constexpr double kSplitWindowM = 0.2;
constexpr double kBendSpacingM = 0.1;
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

/// Whether two lines bend enough for a corner, and significantly. Less is asked than of the corner:
/// points counted to the wrong leg straighten it.
bool isBend(const LineFit& a, const LineFit& b, const FeatureDetectorParameters& parameters) {
  return cornernessOf(a, b) >= kBendCornernessShare * parameters.corner_threshold &&
         significanceOf(a, b, parameters) > kBendSignificanceShare * parameters.significance_min;
}

/// A range of points, both included.
struct Window {
  std::size_t first, last;
};

/// The points from `first` to `last` around a point, at least those of two short legs that meet
/// there.
Window windowAround(const Contour& contour,
                    std::size_t point,
                    std::size_t first,
                    std::size_t last) {
  return {std::min(first, point - std::min(point, kSmallestLegPoints - 1)),
          std::max(last, std::min(point + kSmallestLegPoints, contour.size() - 1))};
}

/// How much better two lines describe the surroundings than one does, at every point; 0 where there
/// are too few points.
std::vector<double> bendsOf(const Contour& contour) {
  std::vector<double> bends_m2(contour.size(), 0.0);
  std::size_t first = 0;
  std::size_t last = 0;
  for (std::size_t i = kSmallestLegPoints - 1; i + kSmallestLegPoints < contour.size(); ++i) {
    while (contour.arc_m(first) < contour.arc_m(i) - kSplitWindowM) ++first;
    while (last + 1 < contour.size() && contour.arc_m(last) < contour.arc_m(i) + kSplitWindowM) {
      ++last;
    }
    const Window window = windowAround(contour, i, first, last);
    bends_m2[i] = contour.residual_m2(window.first, window.last) -
                  contour.residual_m2(window.first, i) - contour.residual_m2(i + 1, window.last);
  }
  return bends_m2;
}

/// The split near a bend that leaves the least squared distance from two lines.
std::size_t bestSplit(const Contour& contour, std::size_t bend) {
  const Window window =
      windowAround(contour, bend, contour.indexAt(contour.arc_m(bend) - kSplitWindowM),
                   contour.indexAt(contour.arc_m(bend) + kSplitWindowM));
  std::size_t best = bend;
  double best_m2 = std::numeric_limits<double>::infinity();
  for (std::size_t split = contour.indexAt(contour.arc_m(bend) - 0.5 * kBendSpacingM);
       split <= bend || contour.arc_m(split) < contour.arc_m(bend) + 0.5 * kBendSpacingM; ++split) {
    if (split + 1 < window.first + kSmallestLegPoints) continue;
    if (split + kSmallestLegPoints > window.last) break;
    const double residual_m2 =
        contour.residual_m2(window.first, split) + contour.residual_m2(split + 1, window.last);
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

/// The points of the contour within a distance before one, or after it, itself included.
std::optional<Leg> legOf(const Contour& contour, std::size_t end, bool before, double length_m) {
  std::size_t first = end;
  std::size_t last = end;
  if (before) {
    first = contour.indexAt(contour.arc_m(end) - length_m);
  } else {
    last = contour.indexAt(contour.arc_m(end) + length_m);
    if (contour.arc_m(last) > contour.arc_m(end) + length_m) --last;
  }
  if (last + 1 < first + kSmallestLegPoints) return std::nullopt;
  return Leg{first, last, contour.fit(first, last)};
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
/// \return nothing if too few points are left and all of them must be certain
std::optional<LineFit> trimmedLine(const Contour& contour,
                                   Leg leg,
                                   bool before,
                                   const Eigen::Vector2d& corner_m,
                                   double margin_m,
                                   Contested contested) {
  const std::size_t smallest =
      contested == Contested::kNever ? kSmallestCertainPoints : kSmallestLegPoints;
  const auto isTooClose = [&](std::size_t index) {
    return std::abs(leg.line.direction.dot(contour[index] - corner_m)) < margin_m;
  };
  while (isTooClose(before ? leg.last : leg.first)) {
    if (leg.last + 1 <= leg.first + smallest) {
      if (contested == Contested::kNever) return std::nullopt;
      break;
    }
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

std::optional<Leg> longestLeg(const Contour& contour,
                              std::size_t end,
                              bool before,
                              const FeatureDetectorParameters& parameters) {
  std::optional<Leg> longest;
  for (const double length_m : kLegLengthsM) {
    if (length_m < kShortestLineSigmas * parameters.laser_range_sigma) continue;
    const auto leg = legOf(contour, end, before, length_m);
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

std::vector<std::size_t> findSplits(const Contour& contour) {
  const std::vector<double> bends_m2 = bendsOf(contour);
  std::vector<std::size_t> splits;
  for (std::size_t i = 1; i + 1 < contour.size(); ++i) {
    if (!(bends_m2[i] > bends_m2[i - 1] && bends_m2[i] >= bends_m2[i + 1])) continue;
    bool is_greatest = true;
    for (std::size_t j = contour.indexAt(contour.arc_m(i) - kBendSpacingM);
         is_greatest && j < contour.size() && contour.arc_m(j) <= contour.arc_m(i) + kBendSpacingM;
         ++j) {
      is_greatest = j < i ? bends_m2[j] < bends_m2[i] : bends_m2[j] <= bends_m2[i];
    }
    if (!is_greatest) continue;
    const std::size_t split = bestSplit(contour, i);
    if (splits.empty() || split > splits.back()) splits.push_back(split);
  }
  return splits;
}

bool isPromising(const Contour& contour,
                 std::size_t split,
                 const FeatureDetectorParameters& parameters) {
  std::vector<LineFit> lines_after;
  for (const double length_m : kLegLengthsM) {
    if (length_m < kShortestLineSigmas * parameters.laser_range_sigma) continue;
    if (const auto leg = legOf(contour, split + 1, false, length_m))
      lines_after.push_back(leg->line);
  }
  for (const double length_m : kLegLengthsM) {
    if (length_m < kShortestLineSigmas * parameters.laser_range_sigma) continue;
    const auto before = legOf(contour, split, true, length_m);
    if (!before) continue;
    for (const LineFit& after : lines_after) {
      if (isBend(before->line, after, parameters)) return true;
    }
  }
  return false;
}

std::optional<TwoLineCorner> fitCorner(const Contour& contour,
                                       std::size_t split,
                                       const FeatureDetectorParameters& parameters,
                                       Contested contested) {
  const auto before = longestLeg(contour, split, true, parameters);
  const auto after = longestLeg(contour, split + 1, false, parameters);
  if (!before || !after) return std::nullopt;
  if (!isBend(before->line, after->line, parameters)) return std::nullopt;
  const auto rough = cross(before->line, after->line, parameters);
  if (!rough || !reaches(contour, *before, true, rough->position_m, parameters) ||
      !reaches(contour, *after, false, rough->position_m, parameters)) {
    return std::nullopt;
  }
  const double sin_opening = std::abs(normalOf(before->line).dot(after->line.direction));
  const double margin_m = kMarginSigmas * parameters.laser_range_sigma / sin_opening;
  const auto line_before =
      trimmedLine(contour, *before, true, rough->position_m, margin_m, contested);
  const auto line_after =
      trimmedLine(contour, *after, false, rough->position_m, margin_m, contested);
  if (!line_before || !line_after) return std::nullopt;
  auto corner = cross(*line_before, *line_after, parameters);
  if (!corner) return std::nullopt;
  corner->split = split;
  return corner;
}

}  // namespace ramscout_feature_detector
