// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/bounds.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

namespace ram_parameters {
namespace {

template <typename Value>
std::string listText(const std::vector<Value>& values) {
  std::string text = "[";
  for (const Value& value : values) text += (text.size() > 1 ? ", " : "") + toYamlText(value);
  return text + "]";
}

/// Words that YAML 1.1 (rosparam) takes for a truth value or for nothing, in any case.
bool isYamlWord(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text == "true" || text == "false" || text == "yes" || text == "no" || text == "on" ||
         text == "off" || text == "y" || text == "n" || text == "null";
}

}  // namespace

bool Bounds::contain(double value) const {
  const bool high_enough = includes_lowest ? value >= lowest : value > lowest;
  const bool low_enough = includes_highest ? value <= highest : value < highest;
  return high_enough && low_enough;
}

std::string Bounds::text() const {
  const bool from_below = std::isfinite(lowest);
  const bool from_above = std::isfinite(highest);
  if (!from_below && !from_above) return "";
  if (!from_above) return (includes_lowest ? ">= " : "> ") + toPlainText(lowest);
  if (!from_below) return (includes_highest ? "<= " : "< ") + toPlainText(highest);
  return std::string("in ") + (includes_lowest ? "[" : "(") + toPlainText(lowest) + ", " +
         toPlainText(highest) + (includes_highest ? "]" : ")");
}

std::string toPlainText(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end.ptr};
}

std::string toYamlText(double value) {
  // YAML 1.1 (rosparam) takes a number for floating point only if it has a point.
  std::string text = toPlainText(value);
  if (text.find('.') != std::string::npos || !std::isfinite(value)) return text;
  const std::size_t exponent = text.find('e');
  return text.insert(exponent == std::string::npos ? text.size() : exponent, ".0");
}

std::string toYamlText(int value) {
  return std::to_string(value);
}

std::string toYamlText(bool value) {
  return value ? "true" : "false";
}

std::string toYamlText(const std::string& value) {
  const bool is_plain =
      !value.empty() && std::isalpha(static_cast<unsigned char>(value.front())) != 0 &&
      value.find_first_of(": #'\"[]{},&*!|>%@`\\") == std::string::npos && !isYamlWord(value);
  if (is_plain) return value;
  std::string quoted = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

std::string toYamlText(const std::vector<double>& values) {
  return listText(values);
}

std::string toYamlText(const std::vector<std::string>& values) {
  return listText(values);
}

}  // namespace ram_parameters
