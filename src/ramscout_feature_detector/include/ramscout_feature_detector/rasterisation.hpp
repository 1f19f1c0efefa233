// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "ramscout_feature_detector/contour.hpp"
#include "ramscout_feature_detector/parameters.hpp"

namespace ramscout_feature_detector {

template <int kRows, int kColumns>
using Grid = std::array<std::array<float, kColumns>, kRows>;

/// Side of the squares in which the image is computed [pixels].
inline constexpr int kPatchPixels = 41;
/// Its rows are some pixels longer: whole registers of the processor.
inline constexpr int kPatchColumns = 48;
using ImagePatch = Grid<kPatchPixels, kPatchColumns>;

/// The contour with its ends prolonged by `distance_m` along their tangents, so that the ridge in
/// the image does not stop where the surface leaves the view: the end of a ridge is itself a
/// corner.
std::vector<Eigen::Vector2d> extrapolate(const Contour& contour,
                                         double distance_m,
                                         double tangent_length_m);

/// A square of the image of a contour on one level of the pyramid, row by row, intensities in [0,
/// 1].
///
/// Every point of the contour is blurred with the sensor's range and bearing noise, the brightest
/// blur counts: I(u) = exp(-1/2 min D^2(u)), D the Mahalanobis distance of u from the polyline, cut
/// off at 3.5 and at kernel_radius. Level l has ppm / 2^l pixels per metre and the additional blur
/// of l binomial decimations.
///
/// \param polyline_m  the prolonged contour, in the laser's frame
/// \param first_column, first_row  the square's first pixel; pixel (0, 0) has its corner at the
/// laser
ImagePatch rasterise(const std::vector<Eigen::Vector2d>& polyline_m,
                     int first_column,
                     int first_row,
                     int level,
                     const FeatureDetectorParameters& parameters);

}  // namespace ramscout_feature_detector
