// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace ram_parameters {

/// Reads the parameters of one component from a YAML map: complete and typed, or refused.
///
/// An absent key keeps the default that the caller passes in. A wrong type throws at once;
/// rejectUnknown() throws for a key that was not read. An integer is accepted where a double is
/// wanted, a fraction is not where an integer is; a quoted number is a string. Every error names
/// the source, the key, the value and what was wanted. A key "a/b" is the key "b" of the map "a".
class ParameterReader {
public:
  /// \param values  a map, or null for "everything at its default"
  /// \param source  what errors call it, e.g. "/fast_slam" or "config/fast_slam.yaml"
  /// \throws std::invalid_argument if `values` is neither a map nor null
  ParameterReader(const YAML::Node& values, std::string source);

  /// Whether the key is present; it counts as read, and so does all that is in it.
  bool has(const std::string& key);

  /// Overwrites `value` if the key is present. \throws std::invalid_argument on a wrong type or a
  /// number not finite
  void read(const std::string& key, bool& value);
  void read(const std::string& key, int& value);
  void read(const std::string& key, double& value);
  void read(const std::string& key, std::string& value);
  void read(const std::string& key, std::vector<double>& values);
  void read(const std::string& key, std::vector<std::string>& values);

  /// A nested map as a reader of its own (empty if absent); its own rejectUnknown() is the caller's
  /// to call.
  ParameterReader section(const std::string& key);

  /// \throws std::invalid_argument naming the first key that was never read and the nearest one
  /// that was
  void rejectUnknown() const;

private:
  void rejectUnknown(const YAML::Node& map, const std::string& path) const;
  /// The key's node, or an undefined one.
  YAML::Node find(const std::string& key);
  [[noreturn]] void fail(const std::string& key, const YAML::Node& node, const char* wanted) const;

  YAML::Node values_;
  std::string source_;
  std::set<std::string> known_keys_;
};

/// The map in a YAML file. \throws std::runtime_error naming the file if it cannot be read or
/// parsed
YAML::Node readYamlFile(const std::string& path);

}  // namespace ram_parameters
