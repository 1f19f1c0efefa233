// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "ramscout_feature_detector/parameters.hpp"
#include "ramscout_feature_detector/rasterisation.hpp"

namespace ramscout_feature_detector {

/// Side of the square of responses that a square of the image yields, and the rim of it that yields
/// none [pixels].
inline constexpr int kResponsePixels = 19;
inline constexpr int kResponseBorder = (kPatchPixels - kResponsePixels) / 2;
using ResponsePatch = Grid<kResponsePixels, kResponsePixels>;

/// Smaller eigenvalues of the structure tensor for the middle of a square of the image.
ResponsePatch cornerResponses(const ImagePatch& image);

/// Maxima that belong to a place lie this near [pixels of the level, along each axis].
inline constexpr int kPeakSearchPixels = 8;

/// A local maximum of the corner response on one level of the pyramid.
struct ResponsePeak {
  int level = 0;
  /// Pixel of the maximum on that level.
  int column = 0;
  int row = 0;
  /// Of the structure tensor; intensities in [0, 1], pixels of this level.
  double min_eigenvalue = 0.0;
  /// min_eigenvalue / trace, in [0, 1/2]: independent of scale and contrast.
  double cornerness = 0.0;
  /// Foerstner point: where the ridges' axes cross.
  Eigen::Vector2d point_m = Eigen::Vector2d::Zero();
};

/// The corner response of Li & Olson (Sensors 10(11), 2010) near a place: the smaller eigenvalue of
/// the structure tensor of the image's Scharr gradients in a Gaussian window of 4 pixels (Shi &
/// Tomasi, CVPR 1994).
///
/// The pixels belong to one grid fixed to the laser, so that this equals the response of the whole
/// image, wherever `near_m` lies.
///
/// \param polyline_m  the prolonged contour, in the laser's frame
/// \return the local maxima within kPeakSearchPixels of `near_m`
std::vector<ResponsePeak> findResponsePeaks(const std::vector<Eigen::Vector2d>& polyline_m,
                                            const Eigen::Vector2d& near_m,
                                            int level,
                                            const FeatureDetectorParameters& parameters);

}  // namespace ramscout_feature_detector
