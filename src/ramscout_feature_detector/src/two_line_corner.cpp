// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/two_line_corner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

namespace ramscout_feature_detector {
namespace {

/// The fewest that define a line.
constexpr std::size_t kDefiningPoints = 2;

double cornernessOf(const LineFit& a, const LineFit& b) {
  return 0.5 * (1.0 - std::abs(a.direction.dot(b.direction)));
}

/// chi square of equal directions; the chord stands for the angle.
double significanceOf(const LineFit& a, const LineFit& b, const CornerModel& model) {
  const double chord2 = 2.0 * (1.0 - a.direction.dot(b.direction));
  return chord2 / (a.angleVariance(noiseOf(a, model)) + b.angleVariance(noiseOf(b, model)));
}

/// Whether two lines bend enough for a corner, and significantly. Less is asked than of the corner:
/// points counted to the wrong leg straighten it.
bool isBend(const LineFit& a, const LineFit& b, const CornerModel& model) {
  return cornernessOf(a, b) >= model.tuning.cornerness_share * model.corner_threshold &&
         significanceOf(a, b, model) > model.tuning.significance_share * model.significance_min;
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
  return {std::min(first, point - std::min(point, LineFit::kFewestPoints - 1)),
          std::max(last, std::min(point + LineFit::kFewestPoints, contour.size() - 1))};
}

/// How much better two lines describe the surroundings than one does, at every point; 0 where there
/// are too few points.
std::vector<double> bendsOf(const Contour& contour, double window_m) {
  std::vector<double> bends_m2(contour.size(), 0.0);
  std::size_t first = 0;
  std::size_t last = 0;
  for (std::size_t i = LineFit::kFewestPoints - 1; i + LineFit::kFewestPoints < contour.size();
       ++i) {
    while (contour.arc_m(first) < contour.arc_m(i) - window_m) ++first;
    while (last + 1 < contour.size() && contour.arc_m(last) < contour.arc_m(i) + window_m) {
      ++last;
    }
    const Window window = windowAround(contour, i, first, last);
    bends_m2[i] = contour.residual_m2(window.first, window.last) -
                  contour.residual_m2(window.first, i) - contour.residual_m2(i + 1, window.last);
  }
  return bends_m2;
}

/// The split near a bend that leaves the least squared distance from two lines.
std::size_t bestSplit(const Contour& contour, std::size_t bend, const TwoLineParameters& tuning) {
  const Window window =
      windowAround(contour, bend, contour.indexAt(contour.arc_m(bend) - tuning.split_window_m),
                   contour.indexAt(contour.arc_m(bend) + tuning.split_window_m));
  std::size_t best = bend;
  double best_m2 = std::numeric_limits<double>::infinity();
  for (std::size_t split = contour.indexAt(contour.arc_m(bend) - 0.5 * tuning.split_spacing_m);
       split <= bend || contour.arc_m(split) < contour.arc_m(bend) + 0.5 * tuning.split_spacing_m;
       ++split) {
    if (split + 1 < window.first + LineFit::kFewestPoints) continue;
    if (split + LineFit::kFewestPoints > window.last) break;
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
bool isStraight(const LineFit& line, const CornerModel& model) {
  const double sigma_m = model.tuning.straight_sigma_ratio * model.range_sigma_m;
  const double freedom = line.count - 2;
  return line.residual_m2 <=
         sigma_m * sigma_m * (freedom + model.tuning.straight_sigmas * std::sqrt(2.0 * freedom));
}

/// Whether two lines, meeting anywhere, explain the points first..last better than one does by more
/// than noise accounts for: a likelihood ratio test, far more sensitive to a bend near the end than
/// the size of the residuals is.
bool isBent(const Contour& contour,
            std::size_t first,
            std::size_t last,
            double noise_m2,
            const TwoLineParameters& tuning) {
  const double whole_m2 = contour.residual_m2(first, last);
  const std::size_t count = last - first + 1;
  const auto splits = static_cast<std::size_t>(tuning.bent_splits);
  for (std::size_t i = 1; i < splits; ++i) {
    const std::size_t split = first + i * count / splits;
    if (split + 1 < first + LineFit::kFewestPoints || last < split + LineFit::kFewestPoints)
      continue;
    const double parts_m2 =
        contour.residual_m2(first, split) + contour.residual_m2(split + 1, last);
    if (whole_m2 - parts_m2 > tuning.bent_significance * noise_m2) return true;
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
  if (last + 1 < first + LineFit::kFewestPoints) return std::nullopt;
  return Leg{before, first, last, contour.fit(first, last)};
}

/// Whether the leg is seen up to the corner: else one surface ends in front of another, and the
/// lines cross where nothing was seen.
bool reaches(const Contour& contour,
             const Leg& leg,
             const Eigen::Vector2d& corner_m,
             const CornerModel& model) {
  const double length_m = leg.line.direction.dot(contour[leg.last] - contour[leg.first]);
  const double spacing_m = length_m / (leg.line.count - 1);
  const Eigen::Vector2d& end = contour[leg.before ? leg.last : leg.first];
  return (end - corner_m).norm() <= model.tuning.unseen_spacings * spacing_m +
                                        model.tuning.unseen_sigmas * model.range_sigma_m;
}

/// The leg's line without the points closer to the corner than noise reaches: which leg they were
/// counted to depended on their noise.
/// \return nothing if too few points are left and all of them must be certain
std::optional<LineFit> trimmedLine(const Contour& contour,
                                   Leg leg,
                                   const Eigen::Vector2d& corner_m,
                                   double margin_m,
                                   Contested contested) {
  const std::size_t smallest =
      contested == Contested::kNever ? kDefiningPoints : LineFit::kFewestPoints;
  const auto isTooClose = [&](std::size_t index) {
    return std::abs(leg.line.direction.dot(contour[index] - corner_m)) < margin_m;
  };
  while (isTooClose(leg.before ? leg.last : leg.first)) {
    if (leg.last + 1 <= leg.first + smallest) {
      if (contested == Contested::kNever) return std::nullopt;
      break;
    }
    if (leg.before) {
      --leg.last;
    } else {
      ++leg.first;
    }
  }
  return contour.refine(contour.fit(leg.first, leg.last), leg.first, leg.last);
}

std::optional<TwoLineCorner> cross(const LineFit& before,
                                   const LineFit& after,
                                   const CornerModel& model) {
  Eigen::Matrix2d normals;
  normals << before.normal().transpose(), after.normal().transpose();
  if (std::abs(normals.determinant()) < model.tuning.min_sin_opening) return std::nullopt;
  const Eigen::Matrix2d inverse = normals.inverse();

  TwoLineCorner corner;
  corner.position_m = inverse * Eigen::Vector2d(before.normal().dot(before.centroid_m),
                                                after.normal().dot(after.centroid_m));
  const double noise_before_m2 = noiseOf(before, model);
  const double noise_after_m2 = noiseOf(after, model);
  const Eigen::Vector2d variances_m2(before.offsetVariance(noise_before_m2, corner.position_m),
                                     after.offsetVariance(noise_after_m2, corner.position_m));
  corner.covariance_m2 = inverse * variances_m2.asDiagonal() * inverse.transpose() +
                         model.tuning.model_variance_m2 * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d bisector = after.direction - before.direction;
  corner.orientation_rad = std::atan2(bisector.y(), bisector.x());
  corner.orientation_variance_rad2 =
      0.25 * (before.angleVariance(noise_before_m2) + after.angleVariance(noise_after_m2)) +
      model.tuning.orientation_model_variance_rad2;
  corner.cornerness = cornernessOf(before, after);
  corner.significance = significanceOf(before, after, model);
  return corner;
}

}  // namespace

double noiseOf(const LineFit& line, const CornerModel& model) {
  const double range_m = line.centroid_m.norm();
  const double cos_incidence =
      range_m > 0.0 ? std::abs(line.normal().dot(line.centroid_m)) / range_m : 1.0;
  const double sigma_m =
      model.range_sigma_m * std::max(cos_incidence, model.tuning.min_cos_incidence);
  return line.noiseVariance(sigma_m * sigma_m, model.tuning.line.noise_prior_points);
}

std::optional<Leg> longestLeg(const Contour& contour,
                              std::size_t end,
                              bool before,
                              const CornerModel& model) {
  std::optional<Leg> longest;
  for (const double length_m : model.tuning.leg_lengths_m) {
    if (length_m < model.tuning.shortest_leg_sigmas * model.range_sigma_m) continue;
    const auto leg = legOf(contour, end, before, length_m);
    if (!leg) continue;
    if (longest &&
        isBent(contour, leg->first, leg->last, noiseOf(longest->line, model), model.tuning)) {
      break;
    }
    if (!isStraight(leg->line, model)) break;
    longest = leg;
  }
  return longest;
}

std::vector<std::size_t> findSplits(const Contour& contour, const TwoLineParameters& tuning) {
  const std::vector<double> bends_m2 = bendsOf(contour, tuning.split_window_m);
  std::vector<std::size_t> splits;
  for (std::size_t i = 1; i + 1 < contour.size(); ++i) {
    if (!(bends_m2[i] > bends_m2[i - 1] && bends_m2[i] >= bends_m2[i + 1])) continue;
    bool is_greatest = true;
    for (std::size_t j = contour.indexAt(contour.arc_m(i) - tuning.split_spacing_m);
         is_greatest && j < contour.size() &&
         contour.arc_m(j) <= contour.arc_m(i) + tuning.split_spacing_m;
         ++j) {
      is_greatest = j < i ? bends_m2[j] < bends_m2[i] : bends_m2[j] <= bends_m2[i];
    }
    if (!is_greatest) continue;
    const std::size_t split = bestSplit(contour, i, tuning);
    if (splits.empty() || split > splits.back()) splits.push_back(split);
  }
  return splits;
}

bool isPromising(const Contour& contour, std::size_t split, const CornerModel& model) {
  std::vector<LineFit> lines_after;
  for (const double length_m : model.tuning.leg_lengths_m) {
    if (length_m < model.tuning.shortest_leg_sigmas * model.range_sigma_m) continue;
    if (const auto leg = legOf(contour, split + 1, false, length_m))
      lines_after.push_back(leg->line);
  }
  for (const double length_m : model.tuning.leg_lengths_m) {
    if (length_m < model.tuning.shortest_leg_sigmas * model.range_sigma_m) continue;
    const auto before = legOf(contour, split, true, length_m);
    if (!before) continue;
    for (const LineFit& after : lines_after) {
      if (isBend(before->line, after, model)) return true;
    }
  }
  return false;
}

std::optional<TwoLineCorner> fitCorner(const Contour& contour,
                                       std::size_t split,
                                       const CornerModel& model,
                                       Contested contested) {
  const auto before = longestLeg(contour, split, true, model);
  const auto after = longestLeg(contour, split + 1, false, model);
  if (!before || !after) return std::nullopt;
  if (!isBend(before->line, after->line, model)) return std::nullopt;
  const auto rough = cross(before->line, after->line, model);
  if (!rough || !reaches(contour, *before, rough->position_m, model) ||
      !reaches(contour, *after, rough->position_m, model)) {
    return std::nullopt;
  }
  const double sin_opening = std::abs(before->line.normal().dot(after->line.direction));
  const double margin_m = model.tuning.margin_sigmas * model.range_sigma_m / sin_opening;
  const auto line_before = trimmedLine(contour, *before, rough->position_m, margin_m, contested);
  const auto line_after = trimmedLine(contour, *after, rough->position_m, margin_m, contested);
  if (!line_before || !line_after) return std::nullopt;
  auto corner = cross(*line_before, *line_after, model);
  if (!corner) return std::nullopt;
  corner->split = split;
  return corner;
}

}  // namespace ramscout_feature_detector
