// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ramscout_feature_detector/contour.hpp"
#include "ramscout_feature_detector/corner_response.hpp"
#include "ramscout_feature_detector/parameters.hpp"
#include "ramscout_feature_detector/two_line_corner.hpp"

namespace ramscout_feature_detector {

/// A corner that the image function and the fitted lines agree on, in the laser's frame.
struct Corner {
  TwoLineCorner lines;
  double response = 0.0;    ///< smaller eigenvalue at the level of the highest cornerness
  double cornerness = 0.0;  ///< of the image, highest of the levels
  int level = 0;            ///< where it is highest: the corner's scale
};

/// Whether a corner of two lines lies on seen surface, away from the contour's ends (S088), is
/// significant and certain enough.
bool isAdmissible(const TwoLineCorner& corner,
                  const Contour& contour,
                  const FeatureDetectorParameters& parameters);

/// The corners of one contour that its response peaks stand for, the strongest max_features of
/// them.
///
/// Peaks on prolonged ends and inadmissible ones are left out first: a maximum that does not count
/// must not decide what the best is. Peaks of several levels that stand for the same corner are
/// merged: it needs a cornerness of corner_threshold on two consecutive levels, or on one if its
/// significance is at least 25 (or there is one level only). relative_threshold: then also
/// feature_threshold times the contour's best response, as in the report.
std::vector<Corner> selectCorners(const Contour& contour,
                                  const std::vector<ResponsePeak>& peaks,
                                  const FeatureDetectorParameters& parameters);

/// Of corners closer than `distance_m` the one with the highest response; strongest first.
std::vector<Corner> suppressNeighbours(std::vector<Corner> corners, double distance_m);

}  // namespace ramscout_feature_detector
