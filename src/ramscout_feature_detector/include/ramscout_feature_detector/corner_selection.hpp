// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "ramscout_feature_detector/contour.hpp"
#include "ramscout_feature_detector/corner_response.hpp"
#include "ramscout_feature_detector/parameters.hpp"
#include "ramscout_feature_detector/two_line_corner.hpp"

namespace ramscout_feature_detector {

/// A corner that the image function and the fitted lines agree on, in the laser's frame.
struct Corner {
  TwoLineCorner lines;
  int level = 0;            ///< the finest on which it is one: the corner's scale
  double response = 0.0;    ///< smaller eigenvalue on that level
  double cornerness = 0.0;  ///< of the image on that level
};

/// Whether a corner of two lines lies on seen surface, away from the contour's ends (S088), is
/// significant and certain enough.
bool isAdmissible(const TwoLineCorner& corner,
                  const Contour& contour,
                  const FeatureDetectorParameters& parameters);

/// Collects the corners of one contour that response peaks stand for.
///
/// Peaks on prolonged ends and inadmissible ones are left out first: a maximum that does not count
/// must not decide what the best is. Peaks of several levels that stand for the same corner are
/// merged: it needs a cornerness of corner_threshold on two consecutive levels, or on one if its
/// significance is at least 25 (or there is one level only).
class CornerCollection {
public:
  /// Keeps references to both.
  CornerCollection(const Contour& contour, const FeatureDetectorParameters& parameters)
      : contour_(contour), parameters_(parameters) {}

  /// The admissible corner of two lines next to a point of the contour, nothing if there is none.
  const std::optional<TwoLineCorner>& linesAt(std::size_t near_index);

  void add(const ResponsePeak& peak);

  /// Whether peaks on coarser levels than those added would change nothing about the corner of
  /// these lines.
  bool isSettled(const TwoLineCorner& lines) const;

  /// The strongest max_features corners, none closer than feature_distance to a stronger one.
  /// relative_threshold: of those with feature_threshold times the contour's best response, as in
  /// the report.
  std::vector<Corner> select() const;

private:
  /// A corner and the levels that speak for it, one bit each.
  struct Candidate {
    Corner corner;
    std::uint32_t levels = 0;
  };
  bool isAccepted(const Candidate& candidate) const;

  const Contour& contour_;
  const FeatureDetectorParameters& parameters_;
  std::map<std::size_t, std::optional<TwoLineCorner>> lines_;  ///< by split
  std::vector<Candidate> candidates_;
};

/// Of corners closer than `distance_m` the one with the highest response; strongest first.
std::vector<Corner> suppressNeighbours(std::vector<Corner> corners, double distance_m);

}  // namespace ramscout_feature_detector
