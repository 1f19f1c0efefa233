// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace ram_slam {

/// That `row` (a feature) and `column` (a landmark) belong together, and what speaks for it: the
/// log-likelihood ratio to their having nothing to do with each other.
struct Candidate {
  std::size_t row = 0;
  std::size_t column = 0;
  double score = 0.0;
};

/// A candidate of the best assignment.
struct Choice {
  std::size_t candidate = 0;  ///< its index
  double margin =
      0.0;  ///< by how much the best sum of scores falls if this candidate is forbidden; >= 0
};

/// The set of candidates in which no row and no column occurs twice and whose sum of scores is
/// largest; candidates with a score <= 0 are left out. Ordered by score, largest first. Exact
/// (Kuhn-Munkres on each group of rows that compete for columns, O(rows^2 columns)).
std::vector<Choice> bestAssignment(const std::vector<Candidate>& candidates);

}  // namespace ram_slam
