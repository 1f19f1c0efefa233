// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/corner_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>

namespace ramscout_feature_detector {
namespace {

constexpr double kTangentLengthM = 0.2;
constexpr std::size_t kSmallestTangentPoints = 3;

constexpr int kSearchRadius = 8;   // pixels around the place where a maximum may lie
constexpr int kWindowRadius = 10;  // 2.5 standard deviations of the window
constexpr float kWindowSigma = 4.0F;
constexpr int kResponses = 2 * (kSearchRadius + 1) + 1;  // a maximum needs neighbours
constexpr int kGradients = kResponses + 2 * kWindowRadius;
constexpr int kPixels = kGradients + 2;
constexpr float kKernelReach2 = 3.5F * 3.5F;  // squared Mahalanobis distance where the kernel ends
constexpr float kSmallestSigma = 0.7F;        // pixels; narrower kernels alias

template <int kRows, int kColumns>
using Grid = std::array<std::array<float, kColumns>, kRows>;

/// exp(-x) for x in [0, 8) within 1e-4, in a form that compilers vectorise.
inline float expNegative(float x) {
  const float y = x * 0.125F;
  float p = 1.0F - y * (1.0F - y * (0.5F - y * (1.0F / 6.0F - y * (1.0F / 24.0F))));
  p *= p;
  p *= p;
  return p * p;
}

/// Standard deviations of the kernel along and across the beam, in pixels of the level.
struct KernelSigmas {
  float range;
  float bearing;
};

KernelSigmas kernelSigmas(double range_m, int level, const FeatureDetectorParameters& parameters) {
  const double ppm = std::ldexp(parameters.ppm, -level);
  // l times a binomial filter (variance 1) and decimation by two, in pixels of the level.
  const double level_variance = (std::pow(4.0, level) - 1.0) / 3.0 / std::pow(4.0, level);
  const auto sigma = [&](double sensor_m) {
    const double sensor = sensor_m * ppm;
    return std::max(kSmallestSigma,
                    static_cast<float>(std::sqrt(sensor * sensor + level_variance)));
  };
  return {sigma(parameters.laser_range_sigma), sigma(range_m * parameters.laser_angular_sigma)};
}

/// Squared Mahalanobis distances to the polyline around a pixel.
class DistancePatch {
public:
  /// \param column, row  global indices of the patch's first pixel
  DistancePatch(int column, int row) : column_(column), row_(row) {
    for (auto& line : squared_) line.fill(kKernelReach2);
  }

  /// Lowers the distances to those from the edge a-b, in pixels; the kernel is that of the edge's
  /// middle.
  void draw(const Eigen::Vector2d& a,
            const Eigen::Vector2d& b,
            double pixel_m,
            int level,
            const FeatureDetectorParameters& parameters) {
    const double margin = parameters.kernel_radius;
    if (std::max(a.x(), b.x()) < column_ - margin ||
        std::min(a.x(), b.x()) > column_ + kPixels + margin ||
        std::max(a.y(), b.y()) < row_ - margin ||
        std::min(a.y(), b.y()) > row_ + kPixels + margin) {
      return;
    }
    const Eigen::Vector2d middle = 0.5 * (a + b);
    const double range = std::max(middle.norm(), 1e-6);
    const KernelSigmas sigmas = kernelSigmas(range * pixel_m, level, parameters);
    const float beam_x = static_cast<float>(middle.x() / range);
    const float beam_y = static_cast<float>(middle.y() / range);
    const int reach =
        std::min(parameters.kernel_radius,
                 static_cast<int>(std::ceil(3.5F * std::max(sigmas.range, sigmas.bearing))));

    const int first_column = std::max(0, pixelOf(std::min(a.x(), b.x())) - reach - column_);
    const int last_column =
        std::min(kPixels - 1, pixelOf(std::max(a.x(), b.x())) + reach - column_);
    const int first_row = std::max(0, pixelOf(std::min(a.y(), b.y())) - reach - row_);
    const int last_row = std::min(kPixels - 1, pixelOf(std::max(a.y(), b.y())) + reach - row_);

    const float along = 1.0F / sigmas.range;
    const float across = 1.0F / sigmas.bearing;
    const Eigen::Vector2f edge = (b - a).cast<float>();
    const float edge_along = along * (beam_x * edge.x() + beam_y * edge.y());
    const float edge_across = across * (beam_x * edge.y() - beam_y * edge.x());
    const float length2 = edge_along * edge_along + edge_across * edge_across;
    const float inverse2 = length2 > 0.0F ? 1.0F / length2 : 0.0F;
    for (int row = first_row; row <= last_row; ++row) {
      const float y = static_cast<float>(row + row_ + 0.5 - a.y());
      const float x = static_cast<float>(first_column + column_ + 0.5 - a.x());
      const float along_first = along * (beam_x * x + beam_y * y);
      const float across_first = across * (beam_x * y - beam_y * x);
      float* squared = squared_[row].data() + first_column;
      const int count = last_column - first_column + 1;
      for (int i = 0; i < count; ++i) {
        const float step = static_cast<float>(i);
        const float q_along = along_first + along * beam_x * step;
        const float q_across = across_first - across * beam_y * step;
        const float t = (q_along * edge_along + q_across * edge_across) * inverse2;
        const float clamped = std::min(std::max(t, 0.0F), 1.0F);
        const float d_along = q_along - clamped * edge_along;
        const float d_across = q_across - clamped * edge_across;
        squared[i] = std::min(squared[i], d_along * d_along + d_across * d_across);
      }
    }
  }

  Grid<kPixels, kPixels> intensities() const {
    Grid<kPixels, kPixels> image;
    for (int row = 0; row < kPixels; ++row) {
      for (int column = 0; column < kPixels; ++column) {
        const float d2 = squared_[row][column];
        image[row][column] = d2 < kKernelReach2 ? expNegative(0.5F * d2) : 0.0F;
      }
    }
    return image;
  }

private:
  static int pixelOf(double coordinate) { return static_cast<int>(std::floor(coordinate)); }

  int column_;
  int row_;
  Grid<kPixels, kPixels> squared_;
};

/// Products of the gradient's components: [[xx, xy], [xy, yy]] summed over a window is the
/// structure tensor.
struct GradientProducts {
  Grid<kGradients, kGradients> xx, xy, yy;
};

/// Scharr / 32 gradients.
GradientProducts gradientProducts(const Grid<kPixels, kPixels>& image) {
  GradientProducts g;
  for (int row = 0; row < kGradients; ++row) {
    const auto& up = image[row];
    const auto& here = image[row + 1];
    const auto& down = image[row + 2];
    for (int i = 0; i < kGradients; ++i) {
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
Grid<kResponses, kResponses> smooth(const Grid<kGradients, kGradients>& products) {
  const Window& w = window();
  Grid<kResponses, kGradients> columns{};
  for (int row = 0; row < kResponses; ++row) {
    for (int k = 0; k < static_cast<int>(w.size()); ++k) {
      for (int i = 0; i < kGradients; ++i) columns[row][i] += w[k] * products[row + k][i];
    }
  }
  Grid<kResponses, kResponses> result{};
  for (int row = 0; row < kResponses; ++row) {
    for (int k = 0; k < static_cast<int>(w.size()); ++k) {
      for (int i = 0; i < kResponses; ++i) result[row][i] += w[k] * columns[row][i + k];
    }
  }
  return result;
}

struct Tensors {
  Grid<kResponses, kResponses> xx, xy, yy, min_eigenvalue;
};

Tensors structureTensors(const GradientProducts& g) {
  Tensors t{smooth(g.xx), smooth(g.xy), smooth(g.yy), {}};
  for (int row = 0; row < kResponses; ++row) {
    for (int i = 0; i < kResponses; ++i) {
      const float difference = t.xx[row][i] - t.yy[row][i];
      t.min_eigenvalue[row][i] =
          0.5F * (t.xx[row][i] + t.yy[row][i] -
                  std::sqrt(difference * difference + 4.0F * t.xy[row][i] * t.xy[row][i]));
    }
  }
  return t;
}

/// Of neighbours that are equal the first one counts.
bool isLocalMaximum(const Grid<kResponses, kResponses>& response, int row, int column) {
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
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (int y = -kWindowRadius; y <= kWindowRadius; ++y) {
    for (int x = -kWindowRadius; x <= kWindowRadius; ++x) {
      const int gy = row + y + kWindowRadius;
      const int gx = column + x + kWindowRadius;
      const double weight = w[y + kWindowRadius] * w[x + kWindowRadius];
      Eigen::Matrix2d tensor;
      tensor << g.xx[gy][gx], g.xy[gy][gx], g.xy[gy][gx], g.yy[gy][gx];
      normal += weight * tensor;
      right += weight * tensor * Eigen::Vector2d(x, y);
    }
  }
  const double determinant = normal.determinant();
  if (!(determinant > 0.0)) return std::nullopt;
  return Eigen::Vector2d((normal(1, 1) * right.x() - normal(0, 1) * right.y()) / determinant,
                         (normal(0, 0) * right.y() - normal(0, 1) * right.x()) / determinant);
}

}  // namespace

std::vector<Eigen::Vector2d> extrapolate(const Contour& contour, double distance_m) {
  const std::size_t count = contour.size();
  const std::size_t front_last =
      std::min(count - 1, std::max(contour.indexAt(kTangentLengthM), kSmallestTangentPoints - 1));
  const std::size_t back_first =
      std::min(contour.indexAt(contour.length_m() - kTangentLengthM),
               count > kSmallestTangentPoints ? count - kSmallestTangentPoints : 0);
  std::vector<Eigen::Vector2d> polyline_m;
  polyline_m.reserve(count + 2);
  polyline_m.push_back(contour.front() - distance_m * contour.fit(0, front_last).direction);
  for (std::size_t i = 0; i < count; ++i) polyline_m.push_back(contour[i]);
  polyline_m.push_back(contour.back() + distance_m * contour.fit(back_first, count - 1).direction);
  return polyline_m;
}

std::optional<ResponsePeak> findResponsePeak(const std::vector<Eigen::Vector2d>& polyline_m,
                                             const Eigen::Vector2d& near_m,
                                             int level,
                                             const FeatureDetectorParameters& parameters) {
  const double ppm = std::ldexp(parameters.ppm, -level);
  const int margin = kPixels / 2;
  const int first_column = static_cast<int>(std::floor(near_m.x() * ppm)) - margin;
  const int first_row = static_cast<int>(std::floor(near_m.y() * ppm)) - margin;
  DistancePatch distances(first_column, first_row);
  Eigen::Vector2d previous = ppm * polyline_m.front();
  for (std::size_t i = 1; i < polyline_m.size(); ++i) {
    const Eigen::Vector2d current = ppm * polyline_m[i];
    distances.draw(previous, current, 1.0 / ppm, level, parameters);
    previous = current;
  }
  const GradientProducts gradients = gradientProducts(distances.intensities());
  const Tensors tensors = structureTensors(gradients);

  int best_row = 0;
  int best_column = 0;
  float best = 0.0F;
  for (int row = 1; row + 1 < kResponses; ++row) {
    for (int column = 1; column + 1 < kResponses; ++column) {
      const float here = tensors.min_eigenvalue[row][column];
      if (here <= best || !isLocalMaximum(tensors.min_eigenvalue, row, column)) continue;
      best = here;
      best_row = row;
      best_column = column;
    }
  }
  if (best_row == 0) return std::nullopt;
  const auto offset = foerstnerOffset(gradients, best_row, best_column);
  if (!offset) return std::nullopt;
  ResponsePeak peak;
  peak.level = level;
  peak.min_eigenvalue = tensors.min_eigenvalue[best_row][best_column];
  peak.cornerness =
      peak.min_eigenvalue / (tensors.xx[best_row][best_column] + tensors.yy[best_row][best_column]);
  const int border = kWindowRadius + 1;
  peak.point_m = (Eigen::Vector2d(first_column + border + best_column + 0.5,
                                  first_row + border + best_row + 0.5) +
                  *offset) /
                 ppm;
  return peak;
}

}  // namespace ramscout_feature_detector
