// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <Eigen/Eigenvalues>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <png.h>

#include "ramscout_bringup/evaluation.hpp"

namespace ramscout_bringup {
namespace {

using ram_slam::OccupancyGrid;
using ram_slam::Pose2;

constexpr int kFractionBits = 4;  // OpenCV draws to 1/16 pixel

const cv::Scalar kFree(255, 255, 255);
const cv::Scalar kUnknown(222, 222, 222);
const cv::Scalar kOccupied(30, 30, 30);
const cv::Scalar kEstimate(200, 90, 0);
const cv::Scalar kTruth(60, 160, 60);
const cv::Scalar kLandmark(40, 40, 220);
const cv::Scalar kText(0, 0, 0);

/// An axis-aligned box in the map frame [m]; empty by default.
struct Box {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-1e9);

  void include(const Eigen::Vector2d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
};

/// Everything that is drawn, in the map frame.
struct Scene {
  const Results& results;
  Trajectory truth;
  Box box;
};

/// Around all cells that are known, in cells.
Box knownCells(const OccupancyGrid& map) {
  Box known;
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      if (map.at(x, y) == ram_slam::kUnknownCell) continue;
      known.include(Eigen::Vector2d(x, y));
      known.include(Eigen::Vector2d(x + 1, y + 1));
    }
  }
  return known;
}

Scene sceneOf(const Results& results, double margin_m) {
  Scene scene{results, truthInMap(results.trajectory, results.ground_truth), {}};
  const OccupancyGrid& map = results.map;
  const Box known = knownCells(map);
  if (known.low.x() <= known.high.x()) {
    for (const double x : {known.low.x(), known.high.x()}) {
      for (const double y : {known.low.y(), known.high.y()})
        scene.box.include(map.map_from_grid *
                          Eigen::Vector2d(map.resolution_m * x, map.resolution_m * y));
    }
  }
  for (const auto& pose : results.trajectory) scene.box.include(pose.pose.translation());
  for (const auto& pose : scene.truth) scene.box.include(pose.pose.translation());
  if (scene.box.low.x() > scene.box.high.x()) scene.box.include(Eigen::Vector2d::Zero());
  scene.box.low.array() -= margin_m;
  scene.box.high.array() += margin_m;
  return scene;
}

/// Draws in the map frame: x to the right, y up.
class Canvas {
public:
  Canvas(const Box& box, double resolution_m, const PictureLayout& layout)
      : low_(box.low), high_(box.high), layout_(layout) {
    const Eigen::Vector2d size_m = box.high - box.low;
    const double cells = size_m.maxCoeff() / resolution_m;
    const double cell_pixels = std::clamp(std::floor(layout.longest_edge_px / cells), 1.0,
                                          static_cast<double>(layout.largest_cell_px));
    pixels_per_m_ = std::min(cell_pixels / resolution_m, layout.max_edge_px / size_m.maxCoeff());
    const int width = static_cast<int>(std::ceil(size_m.x() * pixels_per_m_));
    const int height = static_cast<int>(std::ceil(size_m.y() * pixels_per_m_));
    image_ = cv::Mat(height + layout.legend_height_px, std::max(width, layout.legend_width_px),
                     CV_8UC3, kFree);
    map_height_ = height;
    image_(cv::Rect(0, 0, width, height)).setTo(kUnknown);
  }

  cv::Mat& image() { return image_; }
  const PictureLayout& layout() const { return layout_; }
  double pixelsPerM() const { return pixels_per_m_; }
  int mapHeight() const { return map_height_; }

  /// The pixel's centre in the map frame.
  Eigen::Vector2d pointAt(int column, int row) const {
    return {low_.x() + (column + 0.5) / pixels_per_m_, high_.y() - (row + 0.5) / pixels_per_m_};
  }
  /// In 1/16 pixels.
  cv::Point pixelAt(const Eigen::Vector2d& point_m) const {
    const Eigen::Vector2d pixel =
        Eigen::Vector2d(point_m.x() - low_.x(), high_.y() - point_m.y()) * pixels_per_m_;
    return {cvRound(pixel.x() * (1 << kFractionBits)), cvRound(pixel.y() * (1 << kFractionBits))};
  }

private:
  Eigen::Vector2d low_;
  Eigen::Vector2d high_;
  PictureLayout layout_;
  double pixels_per_m_ = 1.0;
  int map_height_ = 0;
  cv::Mat image_;
};

void drawMap(Canvas& canvas, const OccupancyGrid& map) {
  std::array<cv::Vec3b, 101> colors;  // by occupancy
  for (std::size_t value = 0; value < colors.size(); ++value) {
    const cv::Scalar color = kFree + (kOccupied - kFree) * (static_cast<double>(value) / 100.0);
    for (int channel = 0; channel < 3; ++channel)
      colors[value][channel] = cv::saturate_cast<unsigned char>(color[channel]);
  }
  const Pose2 grid_from_map = map.map_from_grid.inverse();
  const Eigen::Matrix2d cells_per_m = grid_from_map.rotation() / map.resolution_m;
  const Eigen::Vector2d origin = grid_from_map.translation() / map.resolution_m;
  const Eigen::Vector2d cells_per_column =
      cells_per_m * (canvas.pointAt(1, 0) - canvas.pointAt(0, 0));
  for (int row = 0; row < canvas.mapHeight(); ++row) {
    const Eigen::Vector2d first_cell = cells_per_m * canvas.pointAt(0, row) + origin;
    for (int column = 0; column < canvas.image().cols; ++column) {
      const Eigen::Vector2d cell = first_cell + column * cells_per_column;
      if (cell.minCoeff() < 0.0) continue;
      const std::int8_t value = map.at(static_cast<int>(cell.x()), static_cast<int>(cell.y()));
      if (value == ram_slam::kUnknownCell) continue;
      canvas.image().at<cv::Vec3b>(row, column) =
          colors[static_cast<std::size_t>(std::clamp<int>(value, 0, 100))];
    }
  }
}

void drawPath(Canvas& canvas, const Trajectory& path, const cv::Scalar& color, int thickness) {
  std::vector<cv::Point> points;
  for (const auto& pose : path) points.push_back(canvas.pixelAt(pose.pose.translation()));
  cv::polylines(canvas.image(), points, false, color, thickness, cv::LINE_AA, kFractionBits);
}

void drawLandmarks(Canvas& canvas, const std::vector<MapLandmark>& landmarks) {
  for (const MapLandmark& landmark : landmarks) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(landmark.covariance_m2);
    const Eigen::Vector2d sigma_m = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    const Eigen::Vector2d major = axes.eigenvectors().col(1);
    const double to_units = canvas.pixelsPerM() * (1 << kFractionBits);
    const cv::Size half_axes(cvRound(sigma_m[1] * to_units), cvRound(sigma_m[0] * to_units));
    // The picture's y points down, so that angles turn the other way.
    const double angle_deg = -std::atan2(major.y(), major.x()) * 180.0 / M_PI;
    const cv::Point centre = canvas.pixelAt(landmark.position_m);
    cv::ellipse(canvas.image(), centre, half_axes, angle_deg, 0.0, 360.0, kLandmark, 1, cv::LINE_AA,
                kFractionBits);
    cv::circle(canvas.image(), centre, 3 << kFractionBits, kLandmark, cv::FILLED, cv::LINE_AA,
               kFractionBits);
  }
}

/// The longest of 1, 2, 5, 10 ... m that fits the space for the scale bar.
double scaleBarM(double pixels_per_m, double longest_px) {
  double length_m = 0.1;
  for (double decade_m = 0.1; decade_m < 1e6; decade_m *= 10.0) {
    for (const double step : {1.0, 2.0, 5.0}) {
      if (step * decade_m * pixels_per_m <= longest_px) length_m = step * decade_m;
    }
  }
  return length_m;
}

void write(Canvas& canvas, const std::string& text, const cv::Point& at) {
  cv::putText(canvas.image(), text, at, cv::FONT_HERSHEY_SIMPLEX, canvas.layout().font_scale, kText,
              1, cv::LINE_AA);
}

void drawLegend(Canvas& canvas, bool has_truth) {
  cv::Mat& image = canvas.image();
  const int y = canvas.mapHeight() + canvas.layout().legend_height_px / 2;
  const double bar_m = scaleBarM(canvas.pixelsPerM(), canvas.layout().scale_bar_px);
  const int bar_end = 20 + cvRound(bar_m * canvas.pixelsPerM());
  cv::rectangle(image, {20, y - 3}, {bar_end, y + 3}, kText, cv::FILLED);
  std::array<char, 32> label{};
  std::snprintf(label.data(), label.size(), "%g m", bar_m);
  write(canvas, label.data(), {bar_end + 8, y + 5});

  int x = 260;
  cv::line(image, {x, y}, {x + 30, y}, kEstimate, 2, cv::LINE_AA);
  write(canvas, "estimated path", {x + 38, y + 5});
  x += 190;
  if (has_truth) {
    cv::line(image, {x, y}, {x + 30, y}, kTruth, 4, cv::LINE_AA);
    write(canvas, "true path", {x + 38, y + 5});
    x += 150;
  }
  cv::circle(image, {x + 15, y}, 3, kLandmark, cv::FILLED, cv::LINE_AA);
  cv::ellipse(image, {x + 15, y}, {14, 8}, 0.0, 0.0, 360.0, kLandmark, 1, cv::LINE_AA);
  write(canvas, "landmark, 1 sigma", {x + 38, y + 5});
}

// OpenCV's own encoder would bring some hundred shared libraries with it.
std::string toPng(const cv::Mat& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.cols);
  header.height = static_cast<png_uint_32>(image.rows);
  const bool is_grey = image.channels() == 1;
  header.format = is_grey ? PNG_FORMAT_GRAY : PNG_FORMAT_BGR;
  header.flags = is_grey ? 0 : PNG_IMAGE_FLAG_FAST;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string png(size, '\0');
  const int row_bytes = static_cast<int>(image.step);
  if (png_image_write_to_memory(&header, png.data(), &size, 0, image.data, row_bytes, nullptr) == 0)
    throw std::runtime_error("the picture could not be encoded: " + std::string(header.message));
  png.resize(size);
  return png;
}

/// \param step  cells that become a pixel, each way: the most occupied one counts
cv::Mat greyMap(const OccupancyGrid& map, const cv::Rect& cells, int step) {
  cv::Mat image((cells.height + step - 1) / step, (cells.width + step - 1) / step, CV_8UC1,
                cv::Scalar(kUnknown[0]));
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      std::int8_t value = ram_slam::kUnknownCell;
      for (int v = 0; v < step; ++v) {
        for (int u = 0; u < step; ++u)
          value = std::max(value, map.at(cells.x + x * step + u, cells.y + y * step + v));
      }
      if (value == ram_slam::kUnknownCell) continue;
      const double occupancy = std::clamp<int>(value, 0, 100) / 100.0;
      image.at<unsigned char>(image.rows - 1 - y, x) =
          cv::saturate_cast<unsigned char>(kFree[0] + (kOccupied[0] - kFree[0]) * occupancy);
    }
  }
  return image;
}

}  // namespace

MapImage drawMapImage(const OccupancyGrid& map, std::size_t max_bytes, int max_edge_px) {
  const Box known = knownCells(map);
  if (known.low.x() > known.high.x()) return {};
  const Eigen::Vector2i low = known.low.cast<int>();
  const Eigen::Vector2i size = (known.high - known.low).cast<int>();
  const cv::Rect cells(low.x(), low.y(), size.x(), size.y());
  MapImage result;
  int step = (size.maxCoeff() + max_edge_px - 1) / max_edge_px;
  result.png = toPng(greyMap(map, cells, step));
  while (result.png.size() > max_bytes && step < size.maxCoeff()) {
    step *= 2;
    result.png = toPng(greyMap(map, cells, step));
  }
  result.resolution_m = map.resolution_m * step;
  const Eigen::Vector2d corner_m = map.resolution_m * known.low;
  result.map_from_image = map.map_from_grid * Pose2{corner_m.x(), corner_m.y(), 0.0};
  return result;
}

std::string drawPicture(const Results& results, const PictureLayout& layout) {
  const Scene scene = sceneOf(results, layout.margin_m);
  Canvas canvas(scene.box, results.map.resolution_m, layout);
  drawMap(canvas, results.map);
  drawPath(canvas, scene.truth, kTruth, 4);
  drawPath(canvas, results.trajectory, kEstimate, 2);
  drawLandmarks(canvas, results.landmarks);
  drawLegend(canvas, !scene.truth.empty());
  return toPng(canvas.image());
}

}  // namespace ramscout_bringup
