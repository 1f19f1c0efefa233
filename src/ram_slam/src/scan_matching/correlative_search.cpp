// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/correlative_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace ram_slam {
namespace {

/// Readings between two checks whether a score is out of reach: changes the time only, not the
/// result.
constexpr std::size_t kBlock = 16;

struct Cell {
  int column = 0;
  int row = 0;
};

/// One stamp of the readings' Gaussian, (2 radius + 1) cells wide.
std::vector<std::uint8_t> makeKernel(int radius, double deviation_cells) {
  std::vector<std::uint8_t> kernel;
  for (int row = -radius; row <= radius; ++row) {
    for (int column = -radius; column <= radius; ++column) {
      const double squared = (row * row + column * column) / (deviation_cells * deviation_cells);
      kernel.push_back(static_cast<std::uint8_t>(std::lround(255.0 * std::exp(-0.5 * squared))));
    }
  }
  return kernel;
}

/// Each cell becomes the greatest of itself and the one `shift` cells after it, beyond the end 0.
void spreadAlongRows(int shift, int columns, std::vector<std::uint8_t>& cells) {
  for (std::size_t begin = 0; begin < cells.size(); begin += static_cast<std::size_t>(columns)) {
    std::uint8_t* row = cells.data() + begin;
    for (int column = 0; column + shift < columns; ++column)
      row[column] = std::max(row[column], row[column + shift]);
  }
}

void spreadAcrossRows(int shift, int columns, std::vector<std::uint8_t>& cells) {
  const std::size_t distance = static_cast<std::size_t>(shift) * static_cast<std::size_t>(columns);
  for (std::size_t i = 0; i + distance < cells.size(); ++i)
    cells[i] = std::max(cells[i], cells[i + distance]);
}

/// A square of shifts, 2^level cells wide, at one angle.
struct Node {
  std::size_t angle = 0;
  int level = 0;
  Cell shift;
  double score = 0.0;  ///< bound on the score of every shift within
};

class Search {
public:
  Search(const LikelihoodPyramid& pyramid,
         const std::vector<Eigen::Vector2f>& points,
         const Pose2& centre,
         const SearchWindow& window)
      : pyramid_(pyramid), centre_(centre), window_(window) {
    const int angle_steps = static_cast<int>(std::ceil(window.angle_rad / window.angle_step_rad));
    for (int step = -angle_steps; step <= angle_steps; ++step)
      addAngle(points, step * window.angle_step_rad);
    reach_ = static_cast<int>(std::ceil(window.distance_m / pyramid.resolution_m()));
  }

  std::optional<CorrelativeMatch> run(double min_score) {
    best_.score = min_score;
    descend(makeRoots());
    if (!found_) return std::nullopt;
    CorrelativeMatch match;
    match.score = best_.score;
    match.map_from_laser = poseOf(best_);
    return match;
  }

private:
  Pose2 poseOf(const Node& leaf) const {
    return {centre_.x_m + leaf.shift.column * pyramid_.resolution_m(),
            centre_.y_m + leaf.shift.row * pyramid_.resolution_m(),
            wrapAngle(centre_.yaw_rad + angles_rad_[leaf.angle])};
  }

  bool isExcluded(const Node& leaf) const {
    return window_.excluded &&
           !window_.excluded_gate.isExceededBy(window_.excluded->inverse() * poseOf(leaf));
  }

  void addAngle(const std::vector<Eigen::Vector2f>& points, double angle_rad) {
    const Eigen::Matrix2f rotation =
        Eigen::Rotation2Df(static_cast<float>(centre_.yaw_rad + angle_rad)).toRotationMatrix();
    const Eigen::Vector2f shift = centre_.translation().cast<float>() - pyramid_.origin_m();
    const auto cells_per_m = static_cast<float>(1.0 / pyramid_.resolution_m());
    std::vector<Cell> cells;
    cells.reserve(points.size());
    // Spread, so that each block of them samples the whole scan.
    const std::size_t stride = (points.size() + kBlock - 1) / kBlock;
    for (std::size_t first = 0; first < stride; ++first) {
      for (std::size_t i = first; i < points.size(); i += stride) {
        const Eigen::Vector2f place = (rotation * points[i] + shift) * cells_per_m;
        cells.push_back(
            {static_cast<int>(std::floor(place.x())), static_cast<int>(std::floor(place.y()))});
      }
    }
    angles_rad_.push_back(angle_rad);
    cells_of_angle_.push_back(std::move(cells));
  }

  /// Appends those of four neighbouring squares of shifts whose bound is above the best score.
  /// \param first  the lower left one
  void addBlock(std::size_t angle, int level, Cell first, std::vector<Node>& nodes) const {
    const std::vector<Cell>& cells = cells_of_angle_[angle];
    const double scale = 1.0 / (255.0 * static_cast<double>(cells.size()));
    // What a sum may lack of a full score and still be above the best.
    const double best_sum = best_.score / scale;
    const std::uint8_t* grid = pyramid_.level(level);
    const int step = 1 << level;
    const std::ptrdiff_t up = static_cast<std::ptrdiff_t>(step) * pyramid_.stride();
    std::array<unsigned, 4> sums{};
    for (std::size_t i = 0; i < cells.size();) {
      const std::size_t end = std::min(i + kBlock, cells.size());
      for (; i < end; ++i) {
        const std::uint8_t* cell =
            grid + pyramid_.indexOf(cells[i].column + first.column, cells[i].row + first.row);
        sums[0] += cell[0];
        sums[1] += cell[step];
        sums[2] += cell[up];
        sums[3] += cell[up + step];
      }
      const unsigned greatest = *std::max_element(sums.begin(), sums.end());
      if (greatest + 255.0 * static_cast<double>(cells.size() - i) <= best_sum) return;
    }
    for (int k = 0; k < 4; ++k) {
      const Cell shift{first.column + (k & 1) * step, first.row + (k >> 1) * step};
      const double bound = sums[static_cast<std::size_t>(k)] * scale;
      if (shift.column <= reach_ && shift.row <= reach_ && bound > best_.score)
        nodes.push_back({angle, level, shift, bound});
    }
  }

  std::vector<Node> makeRoots() const {
    const int level = pyramid_.levelCount() - 1;
    const int step = 2 << level;
    std::vector<Node> roots;
    for (std::size_t angle = 0; angle < angles_rad_.size(); ++angle) {
      for (int row = -reach_; row <= reach_; row += step) {
        for (int column = -reach_; column <= reach_; column += step)
          addBlock(angle, level, {column, row}, roots);
      }
    }
    return roots;
  }

  /// Depth first, the most promising first; equal scores in order of creation.
  void descend(std::vector<Node> nodes) {
    std::stable_sort(nodes.begin(), nodes.end(),
                     [](const Node& a, const Node& b) { return a.score > b.score; });
    for (const Node& node : nodes) {
      if (node.score <= best_.score) return;
      if (node.level == 0) {
        if (isExcluded(node)) continue;
        best_ = node;
        found_ = true;
        return;
      }
      std::vector<Node> parts;
      addBlock(node.angle, node.level - 1, node.shift, parts);
      descend(std::move(parts));
    }
  }

  const LikelihoodPyramid& pyramid_;
  Pose2 centre_;
  SearchWindow window_;
  int reach_ = 0;
  std::vector<double> angles_rad_;
  std::vector<std::vector<Cell>> cells_of_angle_;
  Node best_;
  bool found_ = false;
};

}  // namespace

LikelihoodPyramid::LikelihoodPyramid(const std::vector<Eigen::Vector2f>& points_in_map,
                                     double resolution_m,
                                     double deviation_m,
                                     int levels)
    : resolution_m_(resolution_m) {
  const int radius = static_cast<int>(std::ceil(2.5 * deviation_m / resolution_m));
  Eigen::Vector2f low = points_in_map.front();
  Eigen::Vector2f high = low;
  for (const Eigen::Vector2f& point : points_in_map) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const auto cell_m = static_cast<float>(resolution_m);
  origin_m_ = low.array() - cell_m * static_cast<float>(radius);
  columns_ = static_cast<int>((high.x() - origin_m_.x()) / cell_m) + radius + 2;
  rows_ = static_cast<int>((high.y() - origin_m_.y()) / cell_m) + radius + 2;
  margin_ = 1 << levels;
  stride_ = columns_ + margin_ + margin_ / 2 + 1;
  std::vector<std::uint8_t> cells(static_cast<std::size_t>(stride_) *
                                  static_cast<std::size_t>(rows_ + margin_ + margin_ / 2 + 1));
  const std::vector<std::uint8_t> kernel = makeKernel(radius, deviation_m / resolution_m);
  for (const Eigen::Vector2f& point : points_in_map) {
    const int column = static_cast<int>((point.x() - origin_m_.x()) / cell_m);
    const int row = static_cast<int>((point.y() - origin_m_.y()) / cell_m);
    std::size_t k = 0;
    for (int r = row - radius; r <= row + radius; ++r) {
      for (int c = column - radius; c <= column + radius; ++c, ++k) {
        std::uint8_t& cell = cells[static_cast<std::size_t>(indexOf(c, r))];
        cell = std::max(cell, kernel[k]);
      }
    }
  }
  levels_.push_back(cells);
  for (int level = 1; level < levels; ++level) {
    spreadAlongRows(1 << (level - 1), stride_, cells);
    spreadAcrossRows(1 << (level - 1), stride_, cells);
    levels_.push_back(cells);
  }
}

std::optional<CorrelativeMatch> searchPose(const LikelihoodPyramid& pyramid,
                                           const std::vector<Eigen::Vector2f>& points_in_laser,
                                           const Pose2& map_from_laser_centre,
                                           const SearchWindow& window,
                                           double min_score) {
  if (points_in_laser.empty()) return std::nullopt;
  return Search(pyramid, points_in_laser, map_from_laser_centre, window).run(min_score);
}

double scorePose(const LikelihoodPyramid& pyramid,
                 const std::vector<Eigen::Vector2f>& points_in_laser,
                 const Pose2& map_from_laser) {
  const Eigen::Matrix2f rotation = map_from_laser.rotation().cast<float>();
  const Eigen::Vector2f shift = map_from_laser.translation().cast<float>() - pyramid.origin_m();
  const auto cells_per_m = static_cast<float>(1.0 / pyramid.resolution_m());
  unsigned sum = 0;
  for (const Eigen::Vector2f& point : points_in_laser) {
    const Eigen::Vector2f place = (rotation * point + shift) * cells_per_m;
    sum += pyramid.level(0)[pyramid.indexOf(static_cast<int>(std::floor(place.x())),
                                            static_cast<int>(std::floor(place.y())))];
  }
  return sum / (255.0 * static_cast<double>(points_in_laser.size()));
}

}  // namespace ram_slam
