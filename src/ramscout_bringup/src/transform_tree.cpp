// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/transform_tree.hpp"

#include <algorithm>
#include <set>

#include "ramscout_bringup/topic_choice.hpp"

namespace ramscout_bringup {
namespace {

using Eigen::Isometry3d;

Isometry3d toIsometry(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation_m) {
  return Eigen::Translation3d(translation_m) * rotation;
}

}  // namespace

void TransformTree::add(const std::string& parent,
                        const std::string& child,
                        std::int64_t stamp_ns,
                        const Isometry3d& parent_from_child,
                        bool is_static) {
  const std::string from = withoutSlash(parent);
  const std::string to = withoutSlash(child);
  const auto known = edges_.find(to);
  if (from.empty() || to.empty() || from == to || !parent_from_child.matrix().allFinite() ||
      (known != edges_.end() && known->second.parent != from)) {
    ++ignored_count_;
    return;
  }
  Edge& edge = edges_[to];
  edge.parent = from;
  edge.is_static = edge.is_static || is_static;
  const Sample sample{stamp_ns, Eigen::Quaterniond(parent_from_child.linear()),
                      parent_from_child.translation()};
  if (edge.is_static) edge.samples.clear();  // the newest is the one that counts
  edge.samples.push_back(sample);
}

void TransformTree::finish() {
  for (auto& [child, edge] : edges_) {
    std::vector<Sample>& samples = edge.samples;
    const auto is_as_first = [&](const Sample& sample) {
      return sample.translation_m == samples.front().translation_m &&
             sample.rotation.coeffs() == samples.front().rotation.coeffs();
    };
    if (std::all_of(samples.begin(), samples.end(), is_as_first))
      samples.resize(1, samples.front());
    std::stable_sort(samples.begin(), samples.end(),
                     [](const Sample& a, const Sample& b) { return a.stamp_ns < b.stamp_ns; });
    samples.shrink_to_fit();
  }
}

bool TransformTree::has(const std::string& frame) const {
  const std::string name = withoutSlash(frame);
  return edges_.count(name) > 0 || std::any_of(edges_.begin(), edges_.end(), [&](const auto& item) {
           return item.second.parent == name;
         });
}

std::vector<const TransformTree::Edge*> TransformTree::chain(std::string frame) const {
  std::vector<const Edge*> edges;
  for (auto edge = edges_.find(frame); edge != edges_.end() && edges.size() <= edges_.size();
       edge = edges_.find(edge->second.parent)) {
    edges.push_back(&edge->second);
  }
  return edges;
}

std::optional<
    std::pair<std::vector<const TransformTree::Edge*>, std::vector<const TransformTree::Edge*>>>
TransformTree::path(const std::string& target, const std::string& source) const {
  const std::string to = withoutSlash(target);
  const std::string from = withoutSlash(source);
  auto up = chain(from);
  auto down = chain(to);
  const std::string& root_of_source = up.empty() ? from : up.back()->parent;
  const std::string& root_of_target = down.empty() ? to : down.back()->parent;
  if (root_of_source != root_of_target) return std::nullopt;
  while (!up.empty() && !down.empty() && up.back() == down.back()) {
    up.pop_back();
    down.pop_back();
  }
  return std::pair(up, down);
}

bool TransformTree::connects(const std::string& target, const std::string& source) const {
  return path(target, source).has_value();
}

bool TransformTree::isConstant(const std::string& target, const std::string& source) const {
  const auto found = path(target, source);
  const auto changes = [](const Edge* edge) { return edge->samples.size() > 1; };
  return !found || (std::none_of(found->first.begin(), found->first.end(), changes) &&
                    std::none_of(found->second.begin(), found->second.end(), changes));
}

std::vector<std::int64_t> TransformTree::stamps(const std::string& target,
                                                const std::string& source) const {
  std::set<std::int64_t> stamps_ns;
  const auto found = path(target, source);
  if (!found) return {};
  for (const auto* edges : {&found->first, &found->second}) {
    for (const Edge* edge : *edges) {
      if (edge->samples.size() < 2) continue;
      for (const Sample& sample : edge->samples) stamps_ns.insert(sample.stamp_ns);
    }
  }
  return {stamps_ns.begin(), stamps_ns.end()};
}

std::optional<Isometry3d> TransformTree::at(const Edge& edge, std::int64_t stamp_ns) {
  const std::vector<Sample>& samples = edge.samples;
  if (samples.size() == 1)
    return toIsometry(samples.front().rotation, samples.front().translation_m);
  const auto next = std::lower_bound(
      samples.begin(), samples.end(), stamp_ns,
      [](const Sample& sample, std::int64_t value) { return sample.stamp_ns < value; });
  if (next == samples.end()) return std::nullopt;
  if (next->stamp_ns == stamp_ns) return toIsometry(next->rotation, next->translation_m);
  if (next == samples.begin()) return std::nullopt;
  const Sample& last = *(next - 1);
  const double fraction = static_cast<double>(stamp_ns - last.stamp_ns) /
                          static_cast<double>(next->stamp_ns - last.stamp_ns);
  return toIsometry(last.rotation.slerp(fraction, next->rotation),
                    last.translation_m + fraction * (next->translation_m - last.translation_m));
}

std::optional<Isometry3d> TransformTree::ancestorFrom(const std::vector<const Edge*>& edges,
                                                      std::int64_t stamp_ns) {
  Isometry3d ancestor_from_frame = Isometry3d::Identity();
  for (const Edge* edge : edges) {
    const auto parent_from_child = at(*edge, stamp_ns);
    if (!parent_from_child) return std::nullopt;
    ancestor_from_frame = *parent_from_child * ancestor_from_frame;
  }
  return ancestor_from_frame;
}

std::optional<Isometry3d> TransformTree::lookup(const std::string& target,
                                                const std::string& source,
                                                std::int64_t stamp_ns) const {
  const auto found = path(target, source);
  if (!found) return std::nullopt;
  const auto ancestor_from_source = ancestorFrom(found->first, stamp_ns);
  const auto ancestor_from_target = ancestorFrom(found->second, stamp_ns);
  if (!ancestor_from_source || !ancestor_from_target) return std::nullopt;
  return ancestor_from_target->inverse() * *ancestor_from_source;
}

std::string TransformTree::parent(const std::string& frame) const {
  const auto edge = edges_.find(withoutSlash(frame));
  return edge == edges_.end() ? "" : edge->second.parent;
}

std::string TransformTree::fixedAncestor(const std::string& frame) const {
  std::string ancestor = withoutSlash(frame);
  for (const Edge* edge : chain(ancestor)) {
    if (edge->samples.size() > 1) break;
    ancestor = edge->parent;
  }
  return ancestor;
}

std::string TransformTree::frames() const {
  std::set<std::string> names;
  for (const auto& [child, edge] : edges_) {
    names.insert(child);
    names.insert(edge.parent);
  }
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list.empty() ? "none" : list;
}

}  // namespace ramscout_bringup
