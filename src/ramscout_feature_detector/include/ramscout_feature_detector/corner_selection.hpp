// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
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
  ResponsePeak peak;  ///< on the finest level on which it is one: the corner's scale
};

/// Whether a corner of two lines lies on seen surface, away from the contour's ends (S088), is
/// significant and certain enough.
bool isAdmissible(const TwoLineCorner& corner,
                  const Contour& contour,
                  const FeatureDetectorParameters& parameters);

/// Whether the image agrees that two lines make a corner: there is a peak of at least
/// corner_threshold where they cross on two consecutive levels, or on one if their significance is
/// at least single_level_significance (or there is one level only). Each crossing is tested on its
/// own, whatever else is in the image.
///
/// \param peaks_on  the peaks around the crossing on a level; called from the finest level on until
///        the matter is settled
std::optional<Corner> confirm(const TwoLineCorner& lines,
                              const std::function<std::vector<ResponsePeak>(int level)>& peaks_on,
                              const FeatureDetectorParameters& parameters);

/// Of the corners of one contour the strongest max_features, none closer than feature_distance to a
/// stronger one; of those that share a peak the most significant one. relative_threshold: of those
/// with feature_threshold times the best response, as in the report.
std::vector<Corner> select(std::vector<Corner> corners,
                           const FeatureDetectorParameters& parameters);

/// Of corners closer than `distance_m` the one with the highest response; strongest first.
std::vector<Corner> suppressNeighbours(std::vector<Corner> corners, double distance_m);

}  // namespace ramscout_feature_detector
