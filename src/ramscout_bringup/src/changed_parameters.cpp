// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/changed_parameters.hpp"

#include <iomanip>
#include <optional>
#include <sstream>

namespace ramscout_bringup {
namespace {

/// The node of a key such as "a/b"; an undefined one if it is not there.
YAML::Node find(const YAML::Node& values, const std::string& key) {
  YAML::Node node = YAML::Clone(values);
  std::istringstream path(key);
  for (std::string part; std::getline(path, part, '/');) {
    if (!node.IsMap() || !node[part]) return YAML::Node(YAML::NodeType::Undefined);
    node.reset(node[part]);
  }
  return node;
}

std::optional<double> numberOf(const YAML::Node& node) {
  double value = 0.0;
  return node.IsScalar() && YAML::convert<double>::decode(node, value) ? std::optional(value)
                                                                       : std::nullopt;
}

/// On one line, lists with their numbers as numbers: 1 is 1.0.
std::string toText(const YAML::Node& node) {
  if (const auto number = numberOf(node)) {
    std::ostringstream text;
    text << std::setprecision(12) << *number;
    return text.str();
  }
  if (node.IsScalar()) return node.Scalar();
  std::string text;
  for (const YAML::Node& element : node) text += (text.empty() ? "" : ", ") + toText(element);
  return "[" + text + "]";
}

}  // namespace

std::vector<ChangedParameter> changedParameters(const YAML::Node& values,
                                                const ram_parameters::ParameterFile& file) {
  std::vector<ChangedParameter> changed;
  if (!values.IsMap()) return changed;
  for (const ram_parameters::ParameterRow& row : file.rows) {
    const YAML::Node value = find(values, row.key);
    if (!value.IsDefined() || value.IsMap()) continue;
    const std::string text = toText(value);
    const std::string default_text = toText(YAML::Load(row.value));
    if (text != default_text) changed.push_back({file.name, row.key, text, default_text, row.unit});
  }
  return changed;
}

}  // namespace ramscout_bringup
