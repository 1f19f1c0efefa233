// SPDX-License-Identifier: BSD-3-Clause
#include "xml_text.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace ramscout_sim {
namespace {

constexpr int kDeepestXml = 100;

/// Where the tag that begins here ends, or the end of the text: a '>' within quotes ends none.
std::size_t endOfTag(const std::string& text, std::size_t begin) {
  if (text.compare(begin, 4, "<!--") == 0) {
    const std::size_t end = text.find("-->", begin);
    return end == std::string::npos ? text.size() : end + 2;
  }
  char quote = '\0';
  for (std::size_t i = begin; i < text.size(); ++i) {
    const char c = text[i];
    if (quote != '\0') {
      if (c == quote) quote = '\0';
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return i;
    }
  }
  return text.size();
}

}  // namespace

int depthOfXml(const std::string& text) {
  int depth = 0;
  int deepest = 0;
  for (std::size_t begin = text.find('<'); begin < text.size() && deepest <= kDeepestXml;
       begin = text.find('<', begin + 1)) {
    const std::size_t end = endOfTag(text, begin);
    if (end >= text.size()) return std::max(deepest, depth + 1);  // not closed
    const char kind = text[begin + 1];
    if (kind == '/') {
      --depth;
    } else if (kind != '?' && kind != '!' && text[end - 1] != '/') {
      deepest = std::max(deepest, ++depth);
    }
    begin = end;
  }
  return deepest;
}

void requireShallowXml(const std::string& text) {
  if (depthOfXml(text) > kDeepestXml)
    throw std::invalid_argument("elements are nested deeper than " + std::to_string(kDeepestXml));
}

std::string readXml(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error(path + ": cannot be opened");
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace ramscout_sim
