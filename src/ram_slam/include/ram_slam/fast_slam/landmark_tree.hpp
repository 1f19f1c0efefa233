// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "ram_slam/landmarks/landmark.hpp"

namespace ram_slam {

/// A map from identifiers to landmarks that copies in constant time: copies share everything until
/// one is written to, and a write copies only the path to the landmark, O(log N) (Montemerlo et
/// al., AAAI 2002, section 3.4).
///
/// A tree of fixed branching over the identifier's bits. Nodes owned by one tree alone are changed
/// in place. Copies behave as values do; trees that share nodes must not be written by several
/// threads at once.
class LandmarkTree {
public:
  /// Null if there is none; valid until the tree is next written to.
  const Landmark* find(LandmarkId id) const;
  /// Inserts or replaces.
  void set(LandmarkId id, const Landmark& landmark);
  /// Whether it was there.
  bool erase(LandmarkId id);
  std::size_t size() const { return size_; }

  /// Calls visit(id, landmark) in ascending order of the identifiers.
  template <typename Visitor>
  void forEach(const Visitor& visit) const {
    if (root_ != nullptr) forEach(*root_, height_, 0, visit);
  }

  /// Replaces each landmark of several trees by change(id, landmark). What the trees share is
  /// changed once and stays shared.
  static void transform(const std::vector<LandmarkTree*>& trees,
                        const std::function<Landmark(LandmarkId, const Landmark&)>& change);

  /// The same content without any shared node: what a copy would be without sharing.
  LandmarkTree deepCopy() const;

  /// Adds the bytes of the nodes that are not yet in `seen`, and the nodes to it: the memory of
  /// several trees together.
  std::size_t bytes(std::unordered_set<const void*>& seen) const;

private:
  static constexpr int kLeafBits = 2;
  static constexpr int kBranchBits = 3;
  static constexpr LandmarkId kLeafSize = 1U << kLeafBits;
  static constexpr LandmarkId kBranchSize = 1U << kBranchBits;

  /// Height 0: a leaf with landmarks; above: a branch with children.
  struct Node {};
  struct Leaf : Node {
    std::array<Landmark, kLeafSize> landmarks;
    std::array<bool, kLeafSize> present{};
  };
  struct Branch : Node {
    std::array<std::shared_ptr<Node>, kBranchSize> children;
  };

  /// The bits of the identifier that choose a child at this height.
  static LandmarkId slot(LandmarkId id, int height) {
    return (id >> (kLeafBits + (height - 1) * kBranchBits)) & (kBranchSize - 1);
  }
  /// Whether a tree of this height has a place for the identifier.
  static bool fits(LandmarkId id, int height) {
    return (static_cast<std::uint64_t>(id) >> (kLeafBits + height * kBranchBits)) == 0;
  }
  /// Makes the node exist and belong to this tree alone.
  template <typename Kind>
  static Kind& own(std::shared_ptr<Node>& node);
  static std::shared_ptr<Node> deepCopy(const Node& node, int height);
  using Change = std::function<Landmark(LandmarkId, const Landmark&)>;
  using Transformed = std::unordered_map<const Node*, std::shared_ptr<Node>>;
  static std::shared_ptr<Node> transform(const std::shared_ptr<Node>& node,
                                         int height,
                                         LandmarkId first_id,
                                         const Change& change,
                                         Transformed& done);
  static std::size_t bytes(const Node& node, int height, std::unordered_set<const void*>& seen);

  template <typename Visitor>
  static void forEach(const Node& node, int height, LandmarkId first_id, const Visitor& visit) {
    if (height == 0) {
      const Leaf& leaf = static_cast<const Leaf&>(node);
      for (LandmarkId i = 0; i < kLeafSize; ++i) {
        if (leaf.present[i]) visit(first_id + i, leaf.landmarks[i]);
      }
      return;
    }
    const Branch& branch = static_cast<const Branch&>(node);
    const int child_bits = kLeafBits + (height - 1) * kBranchBits;
    for (LandmarkId i = 0; i < kBranchSize; ++i) {
      if (branch.children[i] != nullptr) {
        forEach(*branch.children[i], height - 1, first_id + (i << child_bits), visit);
      }
    }
  }

  std::shared_ptr<Node> root_;
  int height_ = 0;
  std::size_t size_ = 0;
};

}  // namespace ram_slam
