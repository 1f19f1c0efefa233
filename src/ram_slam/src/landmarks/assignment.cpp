// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/landmarks/assignment.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include <Eigen/Core>

namespace ram_slam {
namespace {

constexpr double kImpossible = 1e12;  // far above the sum of all scores

/// The column of each row in the assignment of all rows with the least sum of costs; columns >=
/// rows. Kuhn-Munkres with potentials, rows added one by one along shortest augmenting paths.
std::vector<int> cheapestColumns(const Eigen::MatrixXd& costs) {
  const int rows = static_cast<int>(costs.rows());
  const int columns = static_cast<int>(costs.cols());
  // Index 0 stands for "none" in the arrays over columns; rows count from 1 there.
  std::vector<double> row_potential(rows + 1, 0.0), column_potential(columns + 1, 0.0);
  std::vector<int> row_of(columns + 1, 0), previous(columns + 1, 0);
  for (int row = 1; row <= rows; ++row) {
    std::vector<double> distance(columns + 1, std::numeric_limits<double>::infinity());
    std::vector<bool> settled(columns + 1, false);
    row_of[0] = row;
    int column = 0;
    do {
      settled[column] = true;
      const int current = row_of[column];
      double least = std::numeric_limits<double>::infinity();
      int next = 0;
      for (int j = 1; j <= columns; ++j) {
        if (settled[j]) continue;
        const double reduced =
            costs(current - 1, j - 1) - row_potential[current] - column_potential[j];
        if (reduced < distance[j]) {
          distance[j] = reduced;
          previous[j] = column;
        }
        if (distance[j] < least) {
          least = distance[j];
          next = j;
        }
      }
      for (int j = 0; j <= columns; ++j) {
        if (settled[j]) {
          row_potential[row_of[j]] += least;
          column_potential[j] -= least;
        } else {
          distance[j] -= least;
        }
      }
      column = next;
    } while (row_of[column] != 0);
    for (; column != 0; column = previous[column]) row_of[column] = row_of[previous[column]];
  }
  std::vector<int> column_of(rows);
  for (int j = 1; j <= columns; ++j) {
    if (row_of[j] != 0) column_of[row_of[j] - 1] = j - 1;
  }
  return column_of;
}

/// One group of candidates that compete for rows and columns, as a matrix of costs.
class Group {
public:
  Group(const std::vector<Candidate>& candidates, const std::vector<std::size_t>& members)
      : members_(members) {
    std::map<std::size_t, int> rows, columns;
    for (const std::size_t member : members) {
      rows.emplace(candidates[member].row, static_cast<int>(rows.size()));
      columns.emplace(candidates[member].column, static_cast<int>(columns.size()));
    }
    const int row_count = static_cast<int>(rows.size());
    column_count_ = static_cast<int>(columns.size());
    costs_.setConstant(row_count, column_count_ + row_count, kImpossible);
    costs_.rightCols(row_count).setZero();  // the row stays without a column
    for (const std::size_t member : members) {
      const Candidate& candidate = candidates[member];
      places_.push_back({rows[candidate.row], columns[candidate.column]});
      costs_(places_.back().row, places_.back().column) = -candidate.score;
    }
  }

  void addChoices(const std::vector<Candidate>& candidates, std::vector<Choice>& choices) {
    const std::vector<int> best = cheapestColumns(costs_);
    const double best_sum = sum(best);
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const Place place = places_[i];
      if (best[place.row] != place.column || candidates[members_[i]].score <= 0.0) continue;
      const double cost = costs_(place.row, place.column);
      costs_(place.row, place.column) = kImpossible;
      choices.push_back({members_[i], std::max(0.0, sum(cheapestColumns(costs_)) - best_sum)});
      costs_(place.row, place.column) = cost;
    }
  }

private:
  struct Place {
    int row = 0;
    int column = 0;
  };
  double sum(const std::vector<int>& column_of) const {
    double total = 0.0;
    for (int row = 0; row < costs_.rows(); ++row) total += costs_(row, column_of[row]);
    return total;
  }

  const std::vector<std::size_t>& members_;
  int column_count_ = 0;
  Eigen::MatrixXd costs_;
  std::vector<Place> places_;
};

/// Candidates that share rows or columns directly or through others, group by group.
std::vector<std::vector<std::size_t>> groups(const std::vector<Candidate>& candidates) {
  std::vector<std::size_t> label(candidates.size());
  std::iota(label.begin(), label.end(), 0);
  const auto root = [&label](std::size_t i) {
    while (label[i] != i) i = label[i];
    return i;
  };
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (candidates[i].row != candidates[j].row && candidates[i].column != candidates[j].column)
        continue;
      const std::size_t a = root(i);
      const std::size_t b = root(j);
      label[std::max(a, b)] = std::min(a, b);
    }
  }
  std::map<std::size_t, std::vector<std::size_t>> by_root;
  for (std::size_t i = 0; i < candidates.size(); ++i) by_root[root(i)].push_back(i);
  std::vector<std::vector<std::size_t>> result;
  for (auto& entry : by_root) result.push_back(std::move(entry.second));
  return result;
}

bool haveConflict(const std::vector<Candidate>& candidates) {
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (candidates[i].row == candidates[j].row || candidates[i].column == candidates[j].column)
        return true;
    }
  }
  return false;
}

}  // namespace

std::vector<Choice> bestAssignment(const std::vector<Candidate>& candidates) {
  std::vector<Choice> choices;
  choices.reserve(candidates.size());
  if (haveConflict(candidates)) {
    for (const std::vector<std::size_t>& members : groups(candidates)) {
      if (members.size() == 1) {
        const double score = candidates[members[0]].score;
        if (score > 0.0) choices.push_back({members[0], score});
      } else {
        Group(candidates, members).addChoices(candidates, choices);
      }
    }
  } else {
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (candidates[i].score > 0.0) choices.push_back({i, candidates[i].score});
    }
  }
  std::sort(choices.begin(), choices.end(), [&](const Choice& a, const Choice& b) {
    const double score_a = candidates[a.candidate].score;
    const double score_b = candidates[b.candidate].score;
    return score_a != score_b ? score_a > score_b : a.candidate < b.candidate;
  });
  return choices;
}

}  // namespace ram_slam
