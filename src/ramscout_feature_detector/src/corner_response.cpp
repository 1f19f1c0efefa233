// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/corner_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "ramscout_feature_detector/rasterisation.hpp"

#include "wide_registers.hpp"

namespace ramscout_feature_detector {
namespace {

/// Of the window [pixels], as in Li & Olson.
constexpr float kWindowSigma = 4.0F;
/// Of the window, 2.5 standard deviations: what a response needs on each side besides the one pixel
/// of a gradient.
constexpr int kWindowRadius = kResponseBorder - 1;
static_assert(kWindowRadius == 10);
static_assert(kResponsePixels == 2 * (kPeakSearchPixels + 1) + 1, "a maximum needs neighbours");
constexpr int kGradients = kPatchPixels - 2;  // a gradient needs neighbours
// Loops run over whole registers of the processor; what they compute beyond is not used.
constexpr int kGradientColumns = 40;
constexpr int kResponseColumns = 24;
static_assert(kGradientColumns >= kGradients && kGradientColumns + 2 <= kPatchColumns);
static_assert(kResponseColumns >= kResponsePixels);
static_assert(kPatchColumns >= kResponseColumns + 2 * kWindowRadius);
using Products = Grid<kGradients, kPatchColumns>;
using Responses = Grid<kResponsePixels, kResponseColumns>;

/// Products of the gradient's components: [[xx, xy], [xy, yy]] summed over a window is the
/// structure tensor.
struct GradientProducts {
  Products xx, xy, yy;
};

/// Scharr / 32 gradients.
RAMSCOUT_WIDE_REGISTERS
GradientProducts gradientProducts(const ImagePatch& image) {
  GradientProducts g{};
  for (int row = 0; row < kGradients; ++row) {
    const auto& up = image[row];
    const auto& here = image[row + 1];
    const auto& down = image[row + 2];
    for (int i = 0; i < kGradientColumns; ++i) {
      const float x =
          (3.0F * (up[i + 2] - up[i] + down[i + 2] - down[i]) + 10.0F * (here[i + 2] - here[i])) /
          32.0F;
      const float y =
          (3.0F * (down[i] - up[i] + down[i + 2] - up[i + 2]) + 10.0F * (down[i + 1] - up[i + 1])) /
          32.0F;
      g.xx[row][i] = x * x;
      g.xy[row][i] = x * y;
      g.yy[row][i] = y * y;
    }
  }
  return g;
}

using Window = std::array<float, 2 * kWindowRadius + 1>;

const Window& window() {
  static const Window weights = [] {
    Window w{};
    float sum = 0.0F;
    for (int i = -kWindowRadius; i <= kWindowRadius; ++i) {
      const float t = static_cast<float>(i) / kWindowSigma;
      w[i + kWindowRadius] = std::exp(-0.5F * t * t);
      sum += w[i + kWindowRadius];
    }
    for (float& weight : w) weight /= sum;
    return w;
  }();
  return weights;
}

/// Gaussian mean of the products around every pixel that has a whole window.
RAMSCOUT_WIDE_REGISTERS
Responses smooth(const Products& products) {
  const Window& w = window();
  Grid<kResponsePixels, kPatchColumns> columns{};
  for (int row = 0; row < kResponsePixels; ++row) {
    float* sum = columns[row].data();
    const float* middle = products[row + kWindowRadius].data();
    for (int i = 0; i < kGradientColumns; ++i) sum[i] = w[kWindowRadius] * middle[i];
    for (int k = 0; k < kWindowRadius; ++k) {  // the window is symmetric
      const float* above = products[row + k].data();
      const float* below = products[row + 2 * kWindowRadius - k].data();
      for (int i = 0; i < kGradientColumns; ++i) sum[i] += w[k] * (above[i] + below[i]);
    }
  }
  Responses result;
  for (int row = 0; row < kResponsePixels; ++row) {
    float* sum = result[row].data();
    const float* line = columns[row].data();
    for (int i = 0; i < kResponseColumns; ++i) sum[i] = w[kWindowRadius] * line[i + kWindowRadius];
    for (int k = 0; k < kWindowRadius; ++k) {
      for (int i = 0; i < kResponseColumns; ++i)
        sum[i] += w[k] * (line[i + k] + line[i + 2 * kWindowRadius - k]);
    }
  }
  return result;
}

struct Tensors {
  Responses xx, xy, yy, min_eigenvalue;
};

RAMSCOUT_WIDE_REGISTERS
Tensors structureTensors(const GradientProducts& g) {
  Tensors t{smooth(g.xx), smooth(g.xy), smooth(g.yy), {}};
  for (int row = 0; row < kResponsePixels; ++row) {
    for (int i = 0; i < kResponseColumns; ++i) {
      const float difference = t.xx[row][i] - t.yy[row][i];
      t.min_eigenvalue[row][i] =
          0.5F * (t.xx[row][i] + t.yy[row][i] -
                  std::sqrt(difference * difference + 4.0F * t.xy[row][i] * t.xy[row][i]));
    }
  }
  return t;
}

/// Of neighbours that are equal the first one counts.
bool isLocalMaximum(const Responses& response, int row, int column) {
  const float here = response[row][column];
  const auto beats = [here](float before, float after) { return here > before && here >= after; };
  return here > 0.0F && beats(response[row - 1][column - 1], response[row + 1][column + 1]) &&
         beats(response[row - 1][column], response[row + 1][column]) &&
         beats(response[row - 1][column + 1], response[row + 1][column - 1]) &&
         beats(response[row][column - 1], response[row][column + 1]);
}

/// Foerstner's point relative to the pixel (row, column) of the responses [pixels]: the place
/// nearest to all the gradients' lines in the window.
std::optional<Eigen::Vector2d> foerstnerOffset(const GradientProducts& g, int row, int column) {
  const Window& w = window();
  double xx = 0.0, xy = 0.0, yy = 0.0, right_x = 0.0, right_y = 0.0;
  for (int y = -kWindowRadius; y <= kWindowRadius; ++y) {
    const int gradient_row = row + y + kWindowRadius;
    for (int x = -kWindowRadius; x <= kWindowRadius; ++x) {
      const int i = column + x + kWindowRadius;
      const float weight = w[y + kWindowRadius] * w[x + kWindowRadius];
      const double gxx = weight * g.xx[gradient_row][i];
      const double gxy = weight * g.xy[gradient_row][i];
      const double gyy = weight * g.yy[gradient_row][i];
      xx += gxx;
      xy += gxy;
      yy += gyy;
      right_x += gxx * x + gxy * y;
      right_y += gxy * x + gyy * y;
    }
  }
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 0.0)) return std::nullopt;
  return Eigen::Vector2d((yy * right_x - xy * right_y) / determinant,
                         (xx * right_y - xy * right_x) / determinant);
}

}  // namespace

ResponsePatch cornerResponses(const ImagePatch& image) {
  const Responses responses = structureTensors(gradientProducts(image)).min_eigenvalue;
  ResponsePatch patch;
  for (int row = 0; row < kResponsePixels; ++row) {
    std::copy_n(responses[row].begin(), kResponsePixels, patch[row].begin());
  }
  return patch;
}

std::vector<ResponsePeak> findResponsePeaks(const std::vector<Eigen::Vector2d>& polyline_m,
                                            const Eigen::Vector2d& near_m,
                                            int level,
                                            const FeatureDetectorParameters& parameters) {
  const double ppm = std::ldexp(parameters.ppm, -level);
  const int margin = kPatchPixels / 2;
  const int first_column = static_cast<int>(std::floor(near_m.x() * ppm)) - margin;
  const int first_row = static_cast<int>(std::floor(near_m.y() * ppm)) - margin;
  const GradientProducts gradients =
      gradientProducts(rasterise(polyline_m, first_column, first_row, level, parameters));
  const Tensors tensors = structureTensors(gradients);

  std::vector<ResponsePeak> peaks;
  for (int row = 1; row + 1 < kResponsePixels; ++row) {
    for (int column = 1; column + 1 < kResponsePixels; ++column) {
      if (!isLocalMaximum(tensors.min_eigenvalue, row, column)) continue;
      const auto offset = foerstnerOffset(gradients, row, column);
      if (!offset) continue;
      const int border = kWindowRadius + 1;
      ResponsePeak peak;
      peak.level = level;
      peak.column = first_column + border + column;
      peak.row = first_row + border + row;
      peak.min_eigenvalue = tensors.min_eigenvalue[row][column];
      peak.cornerness = peak.min_eigenvalue / (tensors.xx[row][column] + tensors.yy[row][column]);
      peak.point_m = (Eigen::Vector2d(peak.column + 0.5, peak.row + 0.5) + *offset) / ppm;
      peaks.push_back(peak);
    }
  }
  return peaks;
}

}  // namespace ramscout_feature_detector
