// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/processing_picture.hpp"

#include <algorithm>
#include <cmath>

#include "ramscout_feature_detector/corner_response.hpp"
#include "ramscout_feature_detector/rasterisation.hpp"

namespace ramscout_feature_detector {
namespace {

using Colour = std::array<std::uint8_t, 3>;
/// Dark grey, also of the borders of panels, and red: as the documents describe the picture.
constexpr Colour kExcluded = {90, 90, 90};
constexpr Colour kCorner = {255, 0, 0};

/// Values of one level of the pyramid around the laser.
struct Panel {
  explicit Panel(int half) : half_pixels(half), values(4 * half * half, 0.0F) {}

  /// \param column, row  pixel of the level's grid
  void raise(int row, int column, float value) {
    if (std::abs(2 * row + 1) > 2 * half_pixels || std::abs(2 * column + 1) > 2 * half_pixels)
      return;
    float& pixel = values[(row + half_pixels) * 2 * half_pixels + column + half_pixels];
    pixel = std::max(pixel, value);
  }

  int half_pixels;
  std::vector<float> values;
};

/// Adds a contour's image and response, square by square.
void addContour(const std::vector<Eigen::Vector2d>& polyline_m,
                int level,
                const FeatureDetectorParameters& parameters,
                Panel& image,
                Panel& response) {
  const int half = image.half_pixels;
  for (int first_row = -half - kResponseBorder; first_row < half; first_row += kResponsePixels) {
    for (int first_column = -half - kResponseBorder; first_column < half;
         first_column += kResponsePixels) {
      const ImagePatch patch = rasterise(polyline_m, first_column, first_row, level, parameters);
      const ResponsePatch responses = cornerResponses(patch);
      for (int row = 0; row < kResponsePixels; ++row) {
        for (int column = 0; column < kResponsePixels; ++column) {
          const int global_row = first_row + kResponseBorder + row;
          const int global_column = first_column + kResponseBorder + column;
          image.raise(global_row, global_column,
                      patch[row + kResponseBorder][column + kResponseBorder]);
          response.raise(global_row, global_column, responses[row][column]);
        }
      }
    }
  }
}

void drawPanel(const Panel& panel, float brightest, int first_column, Picture& picture) {
  const int side = 2 * panel.half_pixels;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const float value = std::min(panel.values[row * side + column] / brightest, 1.0F);
      const auto grey = static_cast<std::uint8_t>(255.0F * value);
      picture.set(side - 1 - row, first_column + column, {grey, grey, grey});
    }
    if (first_column > 0) picture.set(side - 1 - row, first_column, kExcluded);
  }
}

/// Draws where nothing is accepted, and the corners, into the third panel.
void markResult(const FeatureDetector::Analysis& analysis,
                const FeatureDetectorParameters& parameters,
                double ppm,
                int half_pixels,
                Picture& picture) {
  const auto mark = [&](double x, double y, const Colour& colour) {
    if (std::abs(x) >= half_pixels || std::abs(y) >= half_pixels) return;
    picture.set(half_pixels - 1 - static_cast<int>(std::floor(y)),
                5 * half_pixels + static_cast<int>(std::floor(x)), colour);
  };
  for (const Contour& contour : analysis.contours) {
    if (contour.closed()) continue;
    for (const Eigen::Vector2d& end_m : {contour.front(), contour.back()}) {
      const double radius = parameters.occlude_limit * ppm;
      for (double angle_rad = 0.0; angle_rad < 2.0 * M_PI; angle_rad += 0.5 / radius) {
        mark(end_m.x() * ppm + radius * std::cos(angle_rad),
             end_m.y() * ppm + radius * std::sin(angle_rad), kExcluded);
      }
    }
  }
  const int arm = parameters.picture.cross_pixels;
  for (const Corner& corner : analysis.corners) {
    for (int i = -arm; i <= arm; ++i) {
      mark(corner.lines.position_m.x() * ppm + i, corner.lines.position_m.y() * ppm, kCorner);
      mark(corner.lines.position_m.x() * ppm, corner.lines.position_m.y() * ppm + i, kCorner);
    }
  }
}

}  // namespace

void Picture::set(int row, int column, const Colour& colour) {
  if (row < 0 || row >= rows || column < 0 || column >= columns) return;
  std::copy(colour.begin(), colour.end(), rgb.begin() + 3 * (row * columns + column));
}

Picture pictureOfProcessing(const FeatureDetector& detector, const ram_slam::LaserScan& scan) {
  const FeatureDetectorParameters& parameters = detector.parameters();
  const FeatureDetector::Analysis analysis = detector.analyse(scan);
  const int level = parameters.scale_levels - 1;
  const double ppm = std::ldexp(parameters.ppm, -level);
  const int half = std::min(static_cast<int>(parameters.picture.reach_m * ppm),
                            parameters.picture.max_pixels / 2);
  const int side = 2 * half;
  Panel image(half);
  Panel response(half);
  for (const Contour& contour : analysis.contours) {
    addContour(extrapolate(contour, parameters.extrapolation_distance, parameters.tangent_length_m),
               level, parameters, image, response);
  }

  Picture picture{3 * side, side, std::vector<std::uint8_t>(9 * side * side, 0)};
  drawPanel(image, 1.0F, 0, picture);
  drawPanel(response, static_cast<float>(parameters.picture.brightest_response), side, picture);
  drawPanel(image, 1.0F, 2 * side, picture);
  markResult(analysis, parameters, ppm, half, picture);
  return picture;
}

}  // namespace ramscout_feature_detector
