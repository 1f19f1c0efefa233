// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ram_parameters {

/// What documents state about one parameter.
struct ParameterRow {
  std::string key;         ///< with its sections: "relocalisation/window"
  std::string value;       ///< as YAML
  std::string unit;        ///< empty: none
  std::string range;       ///< empty: any value of its type
  std::string text;        ///< what it decides
  std::string heading;     ///< of the group that begins with this row; mostly empty
  bool is_expert = false;  ///< in the reference only, not in the shipped file
};

/// One shipped YAML file and its page in the reference.
struct ParameterFile {
  std::string name;  ///< in config/, e.g. "fast_slam.yaml"
  std::string node;  ///< "package/executable"
  std::string intro;
  std::vector<ParameterRow> rows;
};

/// `more` behind `rows`, its keys in a section unless that is empty.
void append(std::vector<ParameterRow>& rows,
            const std::vector<ParameterRow>& more,
            const std::string& section = "");

/// The shipped file: every row that is not for experts, with unit, range and text as comments.
std::string toYaml(const ParameterFile& file);
/// A section of the reference: every row, in tables.
std::string toMarkdown(const ParameterFile& file);

}  // namespace ram_parameters
