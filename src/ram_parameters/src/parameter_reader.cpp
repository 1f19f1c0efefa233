// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/parameter_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace ram_parameters {
namespace {

/// yaml-cpp tags a quoted scalar "!"; only a plain one can be a number or a bool.
bool isPlainScalar(const YAML::Node& node) {
  return node.IsScalar() && node.Tag() != "!";
}

bool toDouble(const YAML::Node& node, double& value) {
  return isPlainScalar(node) && YAML::convert<double>::decode(node, value) && std::isfinite(value);
}

/// Levenshtein distance between two keys.
std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0u);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

ParameterReader::ParameterReader(const YAML::Node& values, std::string source)
    : values_(values), source_(std::move(source)) {
  if (values_.IsDefined() && !values_.IsNull() && !values_.IsMap()) {
    throw std::invalid_argument(source_ + ": wanted a map of parameters");
  }
}

bool ParameterReader::has(const std::string& key) {
  return find(key).IsDefined();
}

void ParameterReader::read(const std::string& key, bool& value) {
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  bool parsed = false;
  if (!isPlainScalar(node) || !YAML::convert<bool>::decode(node, parsed))
    fail(key, node, "true or false");
  value = parsed;
}

void ParameterReader::read(const std::string& key, int& value) {
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  double parsed = 0.0;
  if (!toDouble(node, parsed) || parsed != std::floor(parsed) ||
      std::abs(parsed) > std::numeric_limits<int>::max()) {
    fail(key, node, "an integer");
  }
  value = static_cast<int>(parsed);
}

void ParameterReader::read(const std::string& key, double& value) {
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  double parsed = 0.0;
  if (!toDouble(node, parsed)) fail(key, node, "a finite number");
  value = parsed;
}

void ParameterReader::read(const std::string& key, std::string& value) {
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  if (!node.IsScalar()) fail(key, node, "a string");
  value = node.Scalar();
}

void ParameterReader::read(const std::string& key, std::vector<double>& values) {
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  if (!node.IsSequence()) fail(key, node, "a list of finite numbers");
  std::vector<double> parsed(node.size());
  for (std::size_t i = 0; i < node.size(); ++i) {
    if (!toDouble(node[i], parsed[i])) fail(key, node, "a list of finite numbers");
  }
  values = std::move(parsed);
}

void ParameterReader::read(const std::string& key, std::vector<std::string>& values) {
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  if (!node.IsSequence()) fail(key, node, "a list of strings");
  std::vector<std::string> parsed;
  for (const YAML::Node& element : node) {
    if (!element.IsScalar()) fail(key, node, "a list of strings");
    parsed.push_back(element.Scalar());
  }
  values = std::move(parsed);
}

ParameterReader ParameterReader::section(const std::string& key) {
  const YAML::Node node = find(key);
  return ParameterReader(node.IsDefined() ? node : YAML::Node(), source_ + "/" + key);
}

void ParameterReader::rejectUnknown() const {
  if (values_.IsDefined() && values_.IsMap()) rejectUnknown(values_, "");
}

void ParameterReader::rejectUnknown(const YAML::Node& map, const std::string& path) const {
  for (const auto& entry : map) {
    const std::string key = path + entry.first.Scalar();
    if (known_keys_.count(key) != 0) continue;
    const auto within = known_keys_.lower_bound(key + "/");
    if (within != known_keys_.end() && within->compare(0, key.size() + 1, key + "/") == 0) {
      if (entry.second.IsMap()) rejectUnknown(entry.second, key + "/");
      continue;
    }
    const auto nearest = std::min_element(
        known_keys_.begin(), known_keys_.end(),
        [&](const auto& a, const auto& b) { return editDistance(a, key) < editDistance(b, key); });
    const std::string hint =
        nearest == known_keys_.end() ? "" : "; the nearest known one is '" + *nearest + "'";
    throw std::invalid_argument(source_ + ": unknown parameter '" + key + "'" + hint);
  }
}

YAML::Node ParameterReader::find(const std::string& key) {
  known_keys_.insert(key);
  YAML::Node node = values_;
  for (std::size_t begin = 0; begin <= key.size();) {
    if (!node.IsDefined() || node.IsNull()) break;
    if (!node.IsMap()) fail(key.substr(0, begin - 1), node, "a map");
    const std::size_t end = std::min(key.find('/', begin), key.size());
    const YAML::Node next = std::as_const(node)[key.substr(begin, end - begin)];
    if (!next.IsDefined()) break;
    node.reset(next);
    if (end == key.size()) return node;
    begin = end + 1;
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

void ParameterReader::fail(const std::string& key,
                           const YAML::Node& node,
                           const char* wanted) const {
  YAML::Emitter emitter;
  emitter << YAML::Flow << node;
  throw std::invalid_argument(source_ + ": parameter '" + key + "' is " + emitter.c_str() +
                              ", wanted " + wanted);
}

YAML::Node readYamlFile(const std::string& path) {
  try {
    return YAML::LoadFile(path);
  } catch (const YAML::Exception& error) {
    throw std::runtime_error("cannot read " + path + ": " + error.what());
  }
}

}  // namespace ram_parameters
