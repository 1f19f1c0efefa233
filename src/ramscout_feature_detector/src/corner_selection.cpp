// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/corner_selection.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "uncertainty.hpp"

namespace ramscout_feature_detector {
namespace {

bool isCertain(const Eigen::Matrix2d& covariance_m2, const FeatureDetectorParameters& parameters) {
  if (covariance_m2.cwiseAbs().maxCoeff() > parameters.covariance_limit) return false;
  return largestVariance(covariance_m2) <= square(parameters.position_sigma_limit);
}

/// Whether the ridges in the image cross where the lines do, and the maximum is there.
bool agrees(const ResponsePeak& peak,
            const TwoLineCorner& lines,
            const FeatureDetectorParameters& parameters) {
  const double ppm = std::ldexp(parameters.ppm, -peak.level);
  const auto isNear = [ppm](int pixel, double place_m) {
    return std::abs(pixel - static_cast<int>(std::floor(place_m * ppm))) <= kPeakSearchPixels;
  };
  return isNear(peak.column, lines.position_m.x()) && isNear(peak.row, lines.position_m.y()) &&
         (peak.point_m - lines.position_m).norm() * ppm <= parameters.max_peak_offset_px;
}

/// The strongest of the peaks that support a corner.
const ResponsePeak* supportOf(const TwoLineCorner& lines,
                              const std::vector<ResponsePeak>& peaks,
                              const FeatureDetectorParameters& parameters) {
  const ResponsePeak* strongest = nullptr;
  for (const ResponsePeak& peak : peaks) {
    if (peak.cornerness < parameters.corner_threshold || !agrees(peak, lines, parameters)) continue;
    if (strongest == nullptr || peak.min_eigenvalue > strongest->min_eigenvalue) strongest = &peak;
  }
  return strongest;
}

bool sharePeak(const Corner& a, const Corner& b) {
  return a.peak.level == b.peak.level && a.peak.column == b.peak.column && a.peak.row == b.peak.row;
}

/// Of the crossings of lines that one peak supports the most significant one.
std::vector<Corner> onePerPeak(const std::vector<Corner>& corners) {
  std::vector<Corner> kept;
  for (const Corner& corner : corners) {
    const auto same = std::find_if(kept.begin(), kept.end(),
                                   [&](const Corner& other) { return sharePeak(other, corner); });
    if (same == kept.end()) {
      kept.push_back(corner);
    } else if (corner.lines.significance > same->lines.significance) {
      *same = corner;
    }
  }
  return kept;
}

void sortStrongestFirst(std::vector<Corner>& corners) {
  // Not stable_sort: its buffer is not aligned for fixed-size matrices if built for wider
  // registers.
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return std::make_pair(a.peak.min_eigenvalue, a.lines.significance) >
           std::make_pair(b.peak.min_eigenvalue, b.lines.significance);
  });
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

std::optional<Corner> confirm(const TwoLineCorner& lines,
                              const std::function<std::vector<ResponsePeak>(int level)>& peaks_on,
                              const FeatureDetectorParameters& parameters) {
  std::optional<Corner> corner;
  bool finer_agrees = false;
  for (int level = 0; level < parameters.scale_levels; ++level) {
    const std::vector<ResponsePeak> peaks = peaks_on(level);
    const ResponsePeak* peak = supportOf(lines, peaks, parameters);
    if (peak != nullptr) {
      if (!corner) corner = Corner{lines, *peak};
      if (finer_agrees || parameters.scale_levels == 1 ||
          lines.significance >= parameters.single_level_significance) {
        return corner;
      }
    }
    finer_agrees = peak != nullptr;
  }
  return std::nullopt;
}

std::vector<Corner> select(std::vector<Corner> corners,
                           const FeatureDetectorParameters& parameters) {
  corners = onePerPeak(corners);
  if (parameters.relative_threshold) {
    double best = 0.0;
    for (const Corner& corner : corners) best = std::max(best, corner.peak.min_eigenvalue);
    corners.erase(std::remove_if(corners.begin(), corners.end(),
                                 [&](const Corner& corner) {
                                   return corner.peak.min_eigenvalue <
                                          parameters.feature_threshold * best;
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
