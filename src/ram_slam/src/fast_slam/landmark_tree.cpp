// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/landmark_tree.hpp"

namespace ram_slam {

const Landmark* LandmarkTree::find(LandmarkId id) const {
  if (root_ == nullptr || !fits(id, height_)) return nullptr;
  const Node* node = root_.get();
  for (int height = height_; height > 0; --height) {
    node = static_cast<const Branch*>(node)->children[slot(id, height)].get();
    if (node == nullptr) return nullptr;
  }
  const Leaf& leaf = *static_cast<const Leaf*>(node);
  const LandmarkId i = id & (kLeafSize - 1);
  return leaf.present[i] ? &leaf.landmarks[i] : nullptr;
}

template <typename Kind>
Kind& LandmarkTree::own(std::shared_ptr<Node>& node) {
  if (node == nullptr) {
    node = std::make_shared<Kind>();
  } else if (node.use_count() > 1) {
    node = std::make_shared<Kind>(static_cast<const Kind&>(*node));
  }
  return static_cast<Kind&>(*node);
}

void LandmarkTree::set(LandmarkId id, const Landmark& landmark) {
  while (!fits(id, height_)) {
    if (root_ != nullptr) {
      auto taller = std::make_shared<Branch>();
      taller->children[0] = std::move(root_);
      root_ = std::move(taller);
    }
    ++height_;
  }
  std::shared_ptr<Node>* node = &root_;
  for (int height = height_; height > 0; --height) {
    node = &own<Branch>(*node).children[slot(id, height)];
  }
  Leaf& leaf = own<Leaf>(*node);
  const LandmarkId i = id & (kLeafSize - 1);
  if (!leaf.present[i]) ++size_;
  leaf.present[i] = true;
  leaf.landmarks[i] = landmark;
}

bool LandmarkTree::erase(LandmarkId id) {
  if (find(id) == nullptr) return false;
  std::shared_ptr<Node>* node = &root_;
  for (int height = height_; height > 0; --height) {
    node = &own<Branch>(*node).children[slot(id, height)];
  }
  Leaf& leaf = own<Leaf>(*node);
  leaf.present[id & (kLeafSize - 1)] = false;
  --size_;
  bool empty = true;
  for (const bool present : leaf.present) empty = empty && !present;
  if (empty) node->reset();
  return true;
}

LandmarkTree LandmarkTree::deepCopy() const {
  LandmarkTree copy = *this;
  if (root_ != nullptr) copy.root_ = deepCopy(*root_, height_);
  return copy;
}

std::shared_ptr<LandmarkTree::Node> LandmarkTree::deepCopy(const Node& node, int height) {
  if (height == 0) return std::make_shared<Leaf>(static_cast<const Leaf&>(node));
  auto copy = std::make_shared<Branch>();
  const Branch& branch = static_cast<const Branch&>(node);
  for (LandmarkId i = 0; i < kBranchSize; ++i) {
    if (branch.children[i] != nullptr)
      copy->children[i] = deepCopy(*branch.children[i], height - 1);
  }
  return copy;
}

void LandmarkTree::transform(const std::vector<LandmarkTree*>& trees, const Change& change) {
  std::vector<std::shared_ptr<Node>>
      old_roots;  // keeps the addresses of old nodes from being reused
  Transformed done;
  for (LandmarkTree* tree : trees) {
    if (tree->root_ == nullptr) continue;
    old_roots.push_back(tree->root_);
    tree->root_ = transform(tree->root_, tree->height_, 0, change, done);
  }
}

std::shared_ptr<LandmarkTree::Node> LandmarkTree::transform(const std::shared_ptr<Node>& node,
                                                            int height,
                                                            LandmarkId first_id,
                                                            const Change& change,
                                                            Transformed& done) {
  const auto place = done.find(node.get());
  if (place != done.end()) return place->second;
  std::shared_ptr<Node> result;
  if (height == 0) {
    auto leaf = std::make_shared<Leaf>(static_cast<const Leaf&>(*node));
    for (LandmarkId i = 0; i < kLeafSize; ++i) {
      if (leaf->present[i]) leaf->landmarks[i] = change(first_id + i, leaf->landmarks[i]);
    }
    result = std::move(leaf);
  } else {
    auto branch = std::make_shared<Branch>(static_cast<const Branch&>(*node));
    const int child_bits = kLeafBits + (height - 1) * kBranchBits;
    for (LandmarkId i = 0; i < kBranchSize; ++i) {
      std::shared_ptr<Node>& child = branch->children[i];
      if (child != nullptr)
        child = transform(child, height - 1, first_id + (i << child_bits), change, done);
    }
    result = std::move(branch);
  }
  done.emplace(node.get(), result);
  return result;
}

std::size_t LandmarkTree::bytes(std::unordered_set<const void*>& seen) const {
  return root_ == nullptr ? 0 : bytes(*root_, height_, seen);
}

std::size_t LandmarkTree::bytes(const Node& node,
                                int height,
                                std::unordered_set<const void*>& seen) {
  if (!seen.insert(&node).second) return 0;
  if (height == 0) return sizeof(Leaf);
  std::size_t sum = sizeof(Branch);
  for (const std::shared_ptr<Node>& child : static_cast<const Branch&>(node).children) {
    if (child != nullptr) sum += bytes(*child, height - 1, seen);
  }
  return sum;
}

}  // namespace ram_slam
