// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/rasterisation.hpp"

#include <algorithm>
#include <cmath>

#include "wide_registers.hpp"

namespace ramscout_feature_detector {
namespace {

/// Mahalanobis distance where the kernel ends: at 0.2 % of its height, less than a step of 8 bits.
constexpr float kKernelReach = 3.5F;
/// [pixels] A narrower Gaussian has more than 10 % of its amplitude beyond the pixels' Nyquist
/// frequency.
constexpr float kSmallestSigma = 0.7F;
/// 256 bits of single precision.
constexpr int kRegisterPixels = 8;
/// Runs of points closer than this [pixels] to the one drawn before are left out: a gap that is
/// less than 2 % darker than the line would be.
constexpr float kSmallestEdge = 0.3F;

/// exp(-x) for x in [0, 8) within 1e-4, in a form that compilers vectorise.
inline float expNegative(float x) {
  const float y = x * 0.125F;
  float p = 1.0F - y * (1.0F - y * (0.5F - y * (1.0F / 6.0F - y * (1.0F / 24.0F))));
  p *= p;
  p *= p;
  return p * p;
}

/// The kernel on one level, in its pixels.
struct Kernel {
  Kernel(int level, const FeatureDetectorParameters& parameters)
      // l times a binomial filter (variance 1) and decimation by two.
      : level_variance(static_cast<float>((1.0 - std::ldexp(1.0, -2 * level)) / 3.0)),
        range_sigma(sigma(
            static_cast<float>(parameters.laser_range_sigma * std::ldexp(parameters.ppm, -level)))),
        angular_sigma(static_cast<float>(parameters.laser_angular_sigma)),
        radius(parameters.kernel_radius) {}

  float sigma(float sensor) const {
    return std::max(kSmallestSigma, std::sqrt(sensor * sensor + level_variance));
  }

  float level_variance;
  float range_sigma;
  float angular_sigma;
  int radius;
};

/// An edge of the contour on a patch: where it may reach, and its frame along and across the beam,
/// whitened.
struct Edge {
  int first_column, last_column, first_row, last_row;
  float beam_x, beam_y;  ///< along the beam, divided by its sigma
  float side_x, side_y;  ///< across the beam, likewise
  float start_x, start_y;
  float along, across;  ///< the edge itself in that frame
};

int pixelOf(float coordinate) {
  return static_cast<int>(std::floor(coordinate));
}

/// Widens the columns to whole registers: the kernel is 0 there anyway.
void fillRegisters(Edge& edge) {
  const int count = edge.last_column - edge.first_column + 1;
  const int whole = (count + kRegisterPixels - 1) / kRegisterPixels * kRegisterPixels;
  edge.first_column = std::min(edge.first_column, kPatchColumns - whole);
  edge.last_column = edge.first_column + whole - 1;
}

/// \param a, b  the edge's ends in pixels from the patch's corner
/// \param laser  the laser in the same coordinates
Edge makeEdge(const Eigen::Vector2f& a,
              const Eigen::Vector2f& b,
              const Eigen::Vector2f& laser,
              const Kernel& kernel) {
  const Eigen::Vector2f middle = 0.5F * (a + b) - laser;
  const float range = std::max(middle.norm(), 1e-6F);
  const float bearing_sigma = kernel.sigma(range * kernel.angular_sigma);
  // The kernel is an ellipse along the beam.
  const Eigen::Vector2f beam = middle / range;
  const auto reach = [&](float along, float across) {
    const float extent = std::hypot(along * kernel.range_sigma, across * bearing_sigma);
    return std::min(kernel.radius, static_cast<int>(std::ceil(kKernelReach * extent)));
  };
  const int reach_x = reach(beam.x(), beam.y());
  const int reach_y = reach(beam.y(), beam.x());
  Edge edge;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled below, where it is used
  edge.first_column = std::max(0, pixelOf(std::min(a.x(), b.x())) - reach_x);
  edge.last_column = std::min(kPatchColumns - 1, pixelOf(std::max(a.x(), b.x())) + reach_x);
  edge.first_row = std::max(0, pixelOf(std::min(a.y(), b.y())) - reach_y);
  edge.last_row = std::min(kPatchPixels - 1, pixelOf(std::max(a.y(), b.y())) + reach_y);
  const bool whole = reach_x < kernel.radius;
  if (whole && edge.first_column <= edge.last_column) fillRegisters(edge);
  edge.beam_x = middle.x() / (range * kernel.range_sigma);
  edge.beam_y = middle.y() / (range * kernel.range_sigma);
  edge.side_x = -middle.y() / (range * bearing_sigma);
  edge.side_y = middle.x() / (range * bearing_sigma);
  edge.start_x = a.x();
  edge.start_y = a.y();
  edge.along = edge.beam_x * (b.x() - a.x()) + edge.beam_y * (b.y() - a.y());
  edge.across = edge.side_x * (b.x() - a.x()) + edge.side_y * (b.y() - a.y());
  return edge;
}

/// Lowers squared Mahalanobis distances to those from the edge.
RAMSCOUT_WIDE_REGISTERS
void draw(const Edge& edge, ImagePatch& squared) {
  const float length2 = edge.along * edge.along + edge.across * edge.across;
  const float inverse2 = length2 > 0.0F ? 1.0F / length2 : 0.0F;
  const float edge_along = edge.along;
  const float edge_across = edge.across;
  const float beam_x = edge.beam_x;
  const float side_x = edge.side_x;
  const int count = edge.last_column - edge.first_column + 1;
  for (int row = edge.first_row; row <= edge.last_row; ++row) {
    const float x = static_cast<float>(edge.first_column) + 0.5F - edge.start_x;
    const float y = static_cast<float>(row) + 0.5F - edge.start_y;
    const float along_first = beam_x * x + edge.beam_y * y;
    const float across_first = side_x * x + edge.side_y * y;
    float* line = squared[row].data() + edge.first_column;
    const auto lower = [&](int i) {
      const float step = static_cast<float>(i);
      const float along = along_first + beam_x * step;
      const float across = across_first + side_x * step;
      const float t = (along * edge_along + across * edge_across) * inverse2;
      const float clamped = std::min(std::max(t, 0.0F), 1.0F);
      const float d_along = along - clamped * edge_along;
      const float d_across = across - clamped * edge_across;
      line[i] = std::min(line[i], d_along * d_along + d_across * d_across);
    };
    int i = 0;
    for (; i + kRegisterPixels <= count; i += kRegisterPixels) {
      for (int j = 0; j < kRegisterPixels; ++j) lower(i + j);
    }
    for (; i < count; ++i) lower(i);
  }
}

RAMSCOUT_WIDE_REGISTERS
void toIntensities(ImagePatch& squared) {
  for (auto& line : squared) {
    for (float& pixel : line) {
      pixel = pixel < kKernelReach * kKernelReach ? expNegative(0.5F * pixel) : 0.0F;
    }
  }
}

}  // namespace

std::vector<Eigen::Vector2d> extrapolate(const Contour& contour,
                                         double distance_m,
                                         double tangent_length_m) {
  const std::size_t count = contour.size();
  const std::size_t front_last =
      std::min(count - 1, std::max(contour.indexAt(tangent_length_m), LineFit::kFewestPoints - 1));
  const std::size_t back_first =
      std::min(contour.indexAt(contour.length_m() - tangent_length_m),
               count > LineFit::kFewestPoints ? count - LineFit::kFewestPoints : 0);
  std::vector<Eigen::Vector2d> polyline_m;
  polyline_m.reserve(count + 2);
  polyline_m.push_back(contour.front() - distance_m * contour.fit(0, front_last).direction);
  for (std::size_t i = 0; i < count; ++i) polyline_m.push_back(contour[i]);
  polyline_m.push_back(contour.back() + distance_m * contour.fit(back_first, count - 1).direction);
  return polyline_m;
}

ImagePatch rasterise(const std::vector<Eigen::Vector2d>& polyline_m,
                     int first_column,
                     int first_row,
                     int level,
                     const FeatureDetectorParameters& parameters) {
  const double ppm = std::ldexp(parameters.ppm, -level);
  const Kernel kernel(level, parameters);
  const Eigen::Vector2d corner(first_column, first_row);
  const Eigen::Vector2f laser = (-corner).cast<float>();
  const auto toPatch = [&](const Eigen::Vector2d& point_m) -> Eigen::Vector2f {
    return (ppm * point_m - corner).cast<float>();
  };
  const auto margin = static_cast<float>(parameters.kernel_radius);
  const float end = kPatchColumns + margin;

  ImagePatch patch;
  for (auto& line : patch) line.fill(kKernelReach * kKernelReach);
  Eigen::Vector2f previous = toPatch(polyline_m.front());
  Eigen::Vector2f drawn = previous;
  for (std::size_t i = 1; i < polyline_m.size(); ++i) {
    const Eigen::Vector2f current = toPatch(polyline_m[i]);
    if ((current - drawn).squaredNorm() < kSmallestEdge * kSmallestEdge) {
      previous = current;
      continue;
    }
    const bool misses = (previous.x() < -margin && current.x() < -margin) ||
                        (previous.y() < -margin && current.y() < -margin) ||
                        (previous.x() > end && current.x() > end) ||
                        (previous.y() > end && current.y() > end);
    if (!misses) {
      const Edge edge = makeEdge(previous, current, laser, kernel);
      if (edge.first_column <= edge.last_column) draw(edge, patch);
    }
    previous = current;
    drawn = current;
  }
  toIntensities(patch);
  return patch;
}

}  // namespace ramscout_feature_detector
