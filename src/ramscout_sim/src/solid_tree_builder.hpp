// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "solid_tree.hpp"

namespace ramscout_sim {

/// How many nodes and solids can wait to be visited while a ray goes through a tree.
constexpr int kMostWaiting = 1024;  // 15 for each of 64 nodes on the way down, and more

/// The nodes of a tree of all solids but the first, the root first. So shallow that kMostWaiting is
/// enough.
std::vector<SolidTree::Node> buildNodes(const std::vector<Solid>& solids);

/// By how much boxes are larger on every side than they are, so that those end to end overlap and
/// no ray slips in between: more than single precision rounds there.
double overlapOf(const std::vector<Solid>& solids);

/// Of solids that are not upright boxes, half_x_m is the radius of a circle about them.
SolidTree::Body bodyOf(const Solid& solid, double overlap_m);

}  // namespace ramscout_sim
