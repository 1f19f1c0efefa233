// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace ram_parameters {

/// The numbers that a parameter may have: an interval, each end included or not.
struct Bounds {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool includes_lowest = true;
  bool includes_highest = true;

  /// False for NaN.
  bool contain(double value) const;
  /// As errors and documents state it: "> 0", ">= 1", "in [0, 1)"; empty without any bound.
  std::string text() const;
};

inline Bounds anyNumber() {
  return {};
}
inline Bounds above(double lowest) {
  return {lowest, std::numeric_limits<double>::infinity(), false, true};
}
inline Bounds positive() {
  return above(0.0);
}
inline Bounds atLeast(double lowest) {
  return {lowest, std::numeric_limits<double>::infinity(), true, true};
}
inline Bounds below(double highest) {
  return {-std::numeric_limits<double>::infinity(), highest, true, false};
}
/// Both ends included.
inline Bounds within(double lowest, double highest) {
  return {lowest, highest, true, true};
}
/// Neither end included.
inline Bounds between(double lowest, double highest) {
  return {lowest, highest, false, false};
}
/// The lower end is not included, the upper one is.
inline Bounds aboveUpTo(double lowest, double highest) {
  return {lowest, highest, false, true};
}

/// The shortest decimal text that reads back as the same number; YAML takes it for a
/// floating-point number, not for an integer or a string.
std::string toYamlText(double value);
std::string toYamlText(int value);
std::string toYamlText(bool value);
/// Quoted where YAML would take it for something else.
std::string toYamlText(const std::string& value);
std::string toYamlText(const std::vector<double>& values);
std::string toYamlText(const std::vector<std::string>& values);
/// The same without a trailing ".0".
std::string toPlainText(double value);

}  // namespace ram_parameters
