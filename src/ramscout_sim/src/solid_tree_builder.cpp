// SPDX-License-Identifier: BSD-3-Clause
#include "solid_tree_builder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace ramscout_sim {
namespace {

using Node = SolidTree::Node;

struct Item {
  Eigen::AlignedBox3f bounds_m;
  std::int32_t solid;
};
using Items = std::vector<Item>::iterator;

/// A part of the items that becomes a child of a node.
struct Group {
  Items begin;
  Items end;
  Eigen::AlignedBox3f bounds_m;

  std::ptrdiff_t size() const { return end - begin; }
};

/// Beams are nearly level: the probability that they meet a box is proportional to its
/// circumference.
float circumference_m(const Eigen::AlignedBox3f& bounds) {
  return bounds.sizes().head<2>().sum();
}

Eigen::AlignedBox3f boundsOf(Items begin, Items end) {
  Eigen::AlignedBox3f bounds;
  for (Items item = begin; item != end; ++item) bounds.extend(item->bounds_m);
  return bounds;
}

/// In two where circumference times count of both together is least.
std::array<Group, 2> split(const Group& group) {
  const int axis = group.bounds_m.sizes().x() >= group.bounds_m.sizes().y() ? 0 : 1;
  std::sort(group.begin, group.end, [axis](const Item& a, const Item& b) {
    const float at_a = a.bounds_m.center()[axis];
    const float at_b = b.bounds_m.center()[axis];
    return at_a != at_b ? at_a < at_b : a.solid < b.solid;
  });
  const std::ptrdiff_t size = group.size();
  std::vector<float> cost_behind(static_cast<std::size_t>(size));
  Eigen::AlignedBox3f bounds;
  for (std::ptrdiff_t i = size - 1; i > 0; --i) {
    bounds.extend(group.begin[i].bounds_m);
    cost_behind[static_cast<std::size_t>(i)] =
        circumference_m(bounds) * static_cast<float>(size - i);
  }
  bounds.setEmpty();
  // Neither half gets less than a quarter: a tree of 10^8 solids is then at most 64 nodes deep.
  std::ptrdiff_t best = size / 2;
  float best_cost = std::numeric_limits<float>::infinity();
  for (std::ptrdiff_t i = 1; i < size; ++i) {
    bounds.extend(group.begin[i - 1].bounds_m);
    if (4 * std::min(i, size - i) < size) continue;
    const float cost =
        circumference_m(bounds) * static_cast<float>(i) + cost_behind[static_cast<std::size_t>(i)];
    if (cost < best_cost) {
      best_cost = cost;
      best = i;
    }
  }
  const Items middle = group.begin + best;
  return {{{group.begin, middle, boundsOf(group.begin, middle)},
           {middle, group.end, boundsOf(middle, group.end)}}};
}

/// Up to kChildren groups; the one with the largest circumference is split next.
std::vector<Group> childrenOf(const Group& all) {
  std::vector<Group> groups = {all};
  while (groups.size() < SolidTree::kChildren) {
    const auto largest =
        std::max_element(groups.begin(), groups.end(), [](const Group& a, const Group& b) {
          return (a.size() > 1 ? circumference_m(a.bounds_m) : -1.0F) <
                 (b.size() > 1 ? circumference_m(b.bounds_m) : -1.0F);
        });
    if (largest->size() == 1) break;
    const std::array<Group, 2> halves = split(*largest);
    *largest = halves[0];
    groups.push_back(halves[1]);
  }
  return groups;
}

/// No ray meets a child that is not there.
Node emptyNode() {
  constexpr float kFar = 1e30F;  // beyond every world; low above high: no ray meets it
  Node node = {};
  node.low_z_m.fill(kFar);
  node.high_z_m.fill(-kFar);
  return node;
}

std::int32_t addNode(const Group& group, std::vector<Node>& nodes) {
  const auto index = nodes.size();
  nodes.push_back(emptyNode());
  std::size_t i = 0;
  for (const Group& child : childrenOf(group)) {
    const std::int32_t number = child.size() == 1 ? ~child.begin->solid : addNode(child, nodes);
    Node& node = nodes[index];
    node.bounds_m[0][i] = child.bounds_m.min().x();
    node.bounds_m[1][i] = child.bounds_m.max().x();
    node.bounds_m[2][i] = child.bounds_m.min().y();
    node.bounds_m[3][i] = child.bounds_m.max().y();
    node.low_z_m[i] = child.bounds_m.min().z();
    node.high_z_m[i] = child.bounds_m.max().z();
    node.child[i++] = number;
  }
  return static_cast<std::int32_t>(index);
}

}  // namespace

std::vector<Node> buildNodes(const std::vector<Solid>& solids) {
  std::vector<Item> items;
  for (std::size_t i = 1; i < solids.size(); ++i) {
    const Eigen::AlignedBox3d bounds = boundsOf(solids[i]);
    // More than single precision rounds on the way through the tree.
    const double margin_m = 1e-4 + 2e-6 * std::max(bounds.min().cwiseAbs().maxCoeff(),
                                                   bounds.max().cwiseAbs().maxCoeff());
    const Eigen::Vector3d margins_m = Eigen::Vector3d::Constant(margin_m);
    items.push_back(
        {Eigen::AlignedBox3d(bounds.min() - margins_m, bounds.max() + margins_m).cast<float>(),
         static_cast<std::int32_t>(i)});
  }
  std::vector<Node> nodes;
  if (items.empty())
    nodes.push_back(emptyNode());
  else
    addNode({items.begin(), items.end(), boundsOf(items.begin(), items.end())}, nodes);
  return nodes;
}

double overlapOf(const std::vector<Solid>& solids) {
  double farthest_m = 0.0;
  for (std::size_t i = 1; i < solids.size(); ++i)
    farthest_m =
        std::max(farthest_m, solids[i].world_from_solid.translation().cwiseAbs().maxCoeff());
  return 2e-6 + 2.4e-7 * farthest_m;
}

SolidTree::Body bodyOf(const Solid& solid, double overlap_m) {
  const Eigen::Matrix3d& axes = solid.world_from_solid.linear();
  const Eigen::Vector3d center = solid.world_from_solid.translation();
  SolidTree::Body body = {};
  body.x_m = static_cast<float>(center.x());
  body.y_m = static_cast<float>(center.y());
  body.z_m = static_cast<float>(center.z());
  body.upright_box = solid.shape == Shape::kBox && std::abs(axes(2, 2)) > 1.0 - 1e-14;
  if (!body.upright_box) {
    body.half_x_m = static_cast<float>(1e-3 + 0.501 * boundsOf(solid).sizes().norm() +
                                       1e-6 * center.cwiseAbs().maxCoeff());
    return body;
  }
  const double yaw_rad = std::atan2(axes(1, 0), axes(0, 0));
  body.cos_yaw = static_cast<float>(std::cos(yaw_rad));
  body.sin_yaw = static_cast<float>(std::sin(yaw_rad));
  const Eigen::Vector3d half = 0.5 * solid.size_m + Eigen::Vector3d::Constant(overlap_m);
  body.half_x_m = static_cast<float>(half.x());
  body.half_y_m = static_cast<float>(half.y());
  body.half_z_m = static_cast<float>(half.z());
  return body;
}

}  // namespace ramscout_sim
