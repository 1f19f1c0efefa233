// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "ramscout_feature_detector/feature_detector.hpp"
#include "ramscout_feature_detector/rasterisation.hpp"
#include "ramscout_feature_detector/segmentation.hpp"

namespace ramscout_feature_detector {

/// The image function evaluated everywhere, plainly and slowly, and lines fitted at every bend of
/// every contour: what the detector's screening and patches must agree with. Shares with it only
/// how contours are made, prolonged and split, how lines are fitted, and how corners are selected.
class DenseReference {
public:
  explicit DenseReference(const FeatureDetectorParameters& parameters) : parameters_(parameters) {}

  std::vector<Corner> corners(const ram_slam::LaserScan& scan) const {
    std::vector<Corner> all;
    for (const Contour& contour : splitIntoContours(scan, parameters_)) {
      std::vector<std::vector<ResponsePeak>> peaks(parameters_.scale_levels);
      for (int level = 0; level < parameters_.scale_levels; ++level)
        addPeaks(contour, level, peaks[level]);
      std::vector<Corner> corners;
      for (const std::size_t split : findSplits(contour, parameters_.two_lines)) {
        const auto lines = fitCorner(contour, split, parameters_.cornerModel());
        if (!lines || !isAdmissible(*lines, contour, parameters_)) continue;
        const auto corner = confirm(
            *lines, [&](int level) { return peaks[level]; }, parameters_);
        if (corner) corners.push_back(*corner);
      }
      const auto selected = select(std::move(corners), parameters_);
      all.insert(all.end(), selected.begin(), selected.end());
    }
    return suppressNeighbours(std::move(all), parameters_.feature_distance);
  }

  /// One pixel of the image of a polyline.
  double intensity(const std::vector<Eigen::Vector2d>& line_m,
                   int column,
                   int row,
                   int level) const {
    const Image image = raster(line_m, level);
    const int r = row - image.first_row;
    const int c = column - image.first_column;
    return r < 0 || r >= image.rows || c < 0 || c >= image.columns ? 0.0 : image.at(r, c);
  }

private:
  static constexpr int kMargin = 40;
  static constexpr int kWindow = 10;

  struct Image {
    int first_column, first_row, columns, rows;
    std::vector<float> pixels;
    Image(int column, int row, int width, int height)
        : first_column(column),
          first_row(row),
          columns(width),
          rows(height),
          pixels(width * height) {}
    float& at(int row, int column) { return pixels[row * columns + column]; }
    float at(int row, int column) const { return pixels[row * columns + column]; }
  };

  Image raster(const std::vector<Eigen::Vector2d>& line_m, int level) const {
    const double ppm = parameters_.ppm / std::pow(2.0, level);
    Eigen::Vector2d low = line_m.front();
    Eigen::Vector2d high = low;
    for (const Eigen::Vector2d& p : line_m) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    const int column = static_cast<int>(std::floor(low.x() * ppm)) - kMargin;
    const int row = static_cast<int>(std::floor(low.y() * ppm)) - kMargin;
    Image image(column, row, static_cast<int>(std::ceil(high.x() * ppm)) + kMargin - column,
                static_cast<int>(std::ceil(high.y() * ppm)) + kMargin - row);
    for (std::size_t i = 1; i < line_m.size(); ++i)
      draw(ppm * line_m[i - 1], ppm * line_m[i], level, image);
    return image;
  }

  void draw(const Eigen::Vector2d& a, const Eigen::Vector2d& b, int level, Image& image) const {
    const double ppm = parameters_.ppm / std::pow(2.0, level);
    const Eigen::Vector2d middle = 0.5 * (a + b);
    const double bearing_rad = std::atan2(middle.y(), middle.x());
    const double blur = (std::pow(4.0, level) - 1.0) / 3.0 / std::pow(4.0, level);
    const double sigma_range =
        std::max(0.7, std::hypot(parameters_.laser_range_sigma * ppm, std::sqrt(blur)));
    const double sigma_side =
        std::max(0.7, std::hypot(middle.norm() * parameters_.laser_angular_sigma, std::sqrt(blur)));
    Eigen::Matrix2d whiten;
    whiten << std::cos(bearing_rad) / sigma_range, std::sin(bearing_rad) / sigma_range,
        -std::sin(bearing_rad) / sigma_side, std::cos(bearing_rad) / sigma_side;
    const Eigen::Vector2d edge = whiten * (b - a);
    const double reach = std::min<double>(parameters_.kernel_radius,
                                          std::ceil(3.5 * std::max(sigma_range, sigma_side)));
    const Eigen::Vector2d low = a.cwiseMin(b).array() - reach - 1.0;
    const Eigen::Vector2d high = a.cwiseMax(b).array() + reach + 1.0;
    for (int row = 0; row < image.rows; ++row) {
      const double y = image.first_row + row + 0.5;
      if (y < low.y() || y > high.y()) continue;
      const int first = std::max(0, static_cast<int>(low.x()) - image.first_column - 1);
      const int last =
          std::min(image.columns - 1, static_cast<int>(high.x()) - image.first_column + 1);
      for (int column = first; column <= last; ++column) {
        const Eigen::Vector2d q =
            whiten * (Eigen::Vector2d(image.first_column + column + 0.5, y) - a);
        const double t = std::clamp(q.dot(edge) / std::max(edge.squaredNorm(), 1e-12), 0.0, 1.0);
        const double squared = (q - t * edge).squaredNorm();
        if (squared >= 3.5 * 3.5) continue;
        image.at(row, column) =
            std::max(image.at(row, column), static_cast<float>(std::exp(-0.5 * squared)));
      }
    }
  }

  static Image windowed(const Image& products) {
    double weights[2 * kWindow + 1];
    double sum = 0.0;
    for (int i = -kWindow; i <= kWindow; ++i)
      sum += weights[i + kWindow] = std::exp(-0.5 * i * i / 16.0);
    Image half = products;
    Image whole = products;
    for (int row = 0; row < products.rows; ++row) {
      for (int column = kWindow; column < products.columns - kWindow; ++column) {
        double mean = 0.0;
        for (int i = -kWindow; i <= kWindow; ++i)
          mean += weights[i + kWindow] / sum * products.at(row, column + i);
        half.at(row, column) = static_cast<float>(mean);
      }
    }
    for (int row = kWindow; row < products.rows - kWindow; ++row) {
      for (int column = 0; column < products.columns; ++column) {
        double mean = 0.0;
        for (int i = -kWindow; i <= kWindow; ++i)
          mean += weights[i + kWindow] / sum * half.at(row + i, column);
        whole.at(row, column) = static_cast<float>(mean);
      }
    }
    return whole;
  }

  void addPeaks(const Contour& contour, int level, std::vector<ResponsePeak>& peaks) const {
    const Image image = raster(
        extrapolate(contour, parameters_.extrapolation_distance, parameters_.tangent_length_m),
        level);
    Image xx = image, xy = image, yy = image;
    for (int r = 1; r + 1 < image.rows; ++r) {
      for (int c = 1; c + 1 < image.columns; ++c) {
        const double gx = (3.0 * (image.at(r - 1, c + 1) - image.at(r - 1, c - 1)) +
                           10.0 * (image.at(r, c + 1) - image.at(r, c - 1)) +
                           3.0 * (image.at(r + 1, c + 1) - image.at(r + 1, c - 1))) /
                          32.0;
        const double gy = (3.0 * (image.at(r + 1, c - 1) - image.at(r - 1, c - 1)) +
                           10.0 * (image.at(r + 1, c) - image.at(r - 1, c)) +
                           3.0 * (image.at(r + 1, c + 1) - image.at(r - 1, c + 1))) /
                          32.0;
        xx.at(r, c) = static_cast<float>(gx * gx);
        xy.at(r, c) = static_cast<float>(gx * gy);
        yy.at(r, c) = static_cast<float>(gy * gy);
      }
    }
    const Image txx = windowed(xx), txy = windowed(xy), tyy = windowed(yy);
    Image response = image;
    for (std::size_t i = 0; i < response.pixels.size(); ++i) {
      const double a = txx.pixels[i], b = txy.pixels[i], c = tyy.pixels[i];
      response.pixels[i] = static_cast<float>(0.5 * (a + c - std::hypot(a - c, 2.0 * b)));
    }
    const double ppm = parameters_.ppm / std::pow(2.0, level);
    for (int r = kWindow + 2; r < image.rows - kWindow - 2; ++r) {
      for (int c = kWindow + 2; c < image.columns - kWindow - 2; ++c) {
        if (!(response.at(r, c) > 1e-6F)) continue;
        bool highest = true;
        for (int y = -1; y <= 1; ++y) {
          for (int x = -1; x <= 1; ++x)
            highest = highest && response.at(r + y, c + x) <= response.at(r, c);
        }
        if (!highest) continue;
        Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
        Eigen::Vector2d right = Eigen::Vector2d::Zero();
        for (int y = -kWindow; y <= kWindow; ++y) {
          for (int x = -kWindow; x <= kWindow; ++x) {
            Eigen::Matrix2d tensor;
            tensor << xx.at(r + y, c + x), xy.at(r + y, c + x), xy.at(r + y, c + x),
                yy.at(r + y, c + x);
            tensor *= std::exp(-0.5 * (x * x + y * y) / 16.0);
            normal += tensor;
            right += tensor * Eigen::Vector2d(x, y);
          }
        }
        ResponsePeak peak;
        peak.level = level;
        peak.column = image.first_column + c;
        peak.row = image.first_row + r;
        peak.min_eigenvalue = response.at(r, c);
        peak.cornerness = response.at(r, c) / (txx.at(r, c) + tyy.at(r, c));
        peak.point_m =
            (Eigen::Vector2d(peak.column + 0.5, peak.row + 0.5) + normal.inverse() * right) / ppm;
        peaks.push_back(peak);
      }
    }
  }

  FeatureDetectorParameters parameters_;
};

}  // namespace ramscout_feature_detector
