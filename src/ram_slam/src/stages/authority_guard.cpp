// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/authority_guard.hpp"

#include <iterator>

namespace ram_slam {

void AuthorityGuard::add(const std::string& parent,
                         const std::string& child,
                         const std::string& publisher,
                         double now_s) {
  std::map<std::string, double>& sources = sent_s_[child];
  for (auto source = sources.begin(); source != sources.end();)
    source = now_s - source->second > kRecent_s ? sources.erase(source) : std::next(source);
  sources[parent + " -> " + child + " from " + publisher] = now_s;
}

std::string AuthorityGuard::conflict(double now_s) const {
  for (const auto& [child, sources] : sent_s_) {
    std::string text;
    int count = 0;
    for (const auto& [source, sent_s] : sources) {
      if (now_s - sent_s > kRecent_s) continue;
      text += (count++ == 0 ? "" : " and ") + source;
    }
    if (count > 1)
      return "two nodes publish the transform to " + child + ": " + text +
             "; stop one of them, or the map is ruined";
  }
  return "";
}

}  // namespace ram_slam
