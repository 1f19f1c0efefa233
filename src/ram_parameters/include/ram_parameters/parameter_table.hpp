// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "ram_parameters/bounds.hpp"
#include "ram_parameters/parameter_file.hpp"
#include "ram_parameters/parameter_reader.hpp"
#include "ram_parameters/require.hpp"

namespace ram_parameters {

/// What there is to know about the parameters of one struct, once: key, unit, range and meaning of
/// each field. Reading, validation, the shipped YAML file and the reference page come from it; the
/// default is the field's own.
///
///   const ParameterTable<GateParameters>& GateParameters::table() {
///     using P = GateParameters;
///     static const auto table = ParameterTable<P>()
///         .add("distance_m", &P::distance_m, "m", positive(), "Motion after which it opens.")
///         .expert("Search")
///         .add("levels", &P::levels, "", within(1, 8), "Grids of the search, each half as fine.");
///     return table;
///   }
template <typename Struct>
class ParameterTable {
public:
  /// A number: double or int.
  template <typename Number, typename = std::enable_if_t<std::is_arithmetic_v<Number>>>
  ParameterTable& add(const std::string& key,
                      Number Struct::*field,
                      const std::string& unit,
                      const Bounds& bounds,
                      const std::string& text) {
    append(key, field, unit, bounds.text(), text,
           [=](const Struct& values, const std::string& name) {
             const auto value = static_cast<double>(values.*field);
             require(bounds.contain(value), name, value, bounds.text());
           });
    entries_.back().number = [=](const Struct& values) {
      return static_cast<double>(values.*field);
    };
    return *this;
  }

  /// A text, a truth value or a list, without bounds of its own.
  template <typename Value>
  ParameterTable& add(const std::string& key, Value Struct::*field, const std::string& text) {
    static_assert(!std::is_arithmetic_v<Value> || std::is_same_v<Value, bool>,
                  "a number needs a unit and bounds");
    return append(key, field, "", "", text, [](const Struct&, const std::string&) {});
  }

  /// One of several names.
  template <typename Enum>
  ParameterTable& addChoice(const std::string& key,
                            Enum Struct::*field,
                            const std::vector<std::pair<std::string, Enum>>& choices,
                            const std::string& text) {
    std::string names;
    for (const auto& choice : choices) names += (names.empty() ? "" : " or ") + choice.first;
    const auto nameOf = [choices](Enum value) {
      for (const auto& choice : choices)
        if (choice.second == value) return choice.first;
      return std::string();
    };
    Entry entry = makeEntry(key, "", names, text);
    entry.read = [=](ParameterReader& reader, Struct& values, const std::string& name) {
      std::string chosen = nameOf(values.*field);
      reader.read(name, chosen);
      for (const auto& choice : choices) {
        if (choice.first != chosen) continue;
        values.*field = choice.second;
        return;
      }
      throw std::invalid_argument(name + " must be " + names + ", got '" + chosen + "'");
    };
    entry.value = [=](const Struct& values) { return nameOf(values.*field); };
    entries_.push_back(std::move(entry));
    return *this;
  }

  /// What a row demands beyond its own bounds, in terms of other fields. \param bound  as errors
  /// and documents state it: "in [1, key_scan_count]"
  template <typename Value>
  ParameterTable& rule(Value Struct::*field,
                       const std::string& bound,
                       const std::function<bool(const Struct&)>& holds) {
    Entry& entry = entries_.back();
    addRange(entry.row, bound);
    entry.check = [=, before = entry.check](const Struct& values, const std::string& name) {
      before(values, name);
      if constexpr (std::is_arithmetic_v<Value>) {
        require(holds(values), name, static_cast<double>(values.*field), bound);
      } else if (!holds(values)) {
        throw std::invalid_argument(name + " must be " + bound + ", got " +
                                    toYamlText(values.*field));
      }
    };
    return *this;
  }

  /// The numbers with which the row before, a number, is known to work: others within its bounds
  /// are accepted with a warning. \param applies  the values for which it matters; default: all
  ParameterTable& advised(const Bounds& bounds,
                          const std::function<bool(const Struct&)>& applies = nullptr) {
    Entry& entry = entries_.back();
    addRange(entry.row, "known to work " + bounds.text());
    entry.warning = [=, number = entry.number](const Struct& values, const std::string& name) {
      if (bounds.contain(number(values)) || (applies && !applies(values))) return std::string();
      return name + " = " + toPlainText(number(values)) +
             " is outside the range that is known to work, " + bounds.text();
    };
    return *this;
  }

  /// Another spelling of the row before, for older files. Both with different values are refused.
  ParameterTable& alias(const std::string& old_key) {
    Entry& entry = entries_.back();
    entry.read = [old_key, read = entry.read, value = entry.value](
                     ParameterReader& reader, Struct& values, const std::string& name) {
      Struct other = values;
      read(reader, values, name);
      read(reader, other, old_key);
      if (!reader.has(old_key)) return;
      if (reader.has(name) && value(other) != value(values)) {
        throw std::invalid_argument(name + " = " + value(values) + " and " + old_key + " = " +
                                    value(other) + " contradict each other: keep the first");
      }
      values = other;
    };
    return *this;
  }

  /// The rows of a struct within this one, their keys in the same map, with a prefix if they need
  /// one.
  template <typename Sub>
  ParameterTable& include(Sub Struct::*field,
                          const ParameterTable<Sub>& table,
                          const std::string& prefix = "") {
    for (const auto& sub : table.entries()) {
      Entry entry;
      entry.row = sub.row;
      entry.row.key.insert(0, prefix);
      if (!heading_.empty()) entry.row.heading = std::exchange(heading_, "");
      entry.row.is_expert = entry.row.is_expert || is_expert_;
      entry.read = [=, read = sub.read](ParameterReader& reader, Struct& values,
                                        const std::string& name) {
        read(reader, values.*field, name);
      };
      entry.check = [=, check = sub.check](const Struct& values, const std::string& name) {
        check(values.*field, name);
      };
      entry.value = [=, value = sub.value](const Struct& values) { return value(values.*field); };
      if (sub.warning) {
        entry.warning = [=, warning = sub.warning](const Struct& values, const std::string& name) {
          return warning(values.*field, name);
        };
      }
      entries_.push_back(std::move(entry));
    }
    return *this;
  }

  /// The rows of a struct within this one, in a map of their own.
  template <typename Sub>
  ParameterTable& section(const std::string& key,
                          Sub Struct::*field,
                          const ParameterTable<Sub>& table) {
    return include(field, table, key + "/");
  }

  /// Begins a group of rows.
  ParameterTable& heading(const std::string& text) { return begin(text, false); }
  /// Begins a group of rows that are in the reference, but not in the shipped file: few users ever
  /// need one.
  ParameterTable& expert(const std::string& text) { return begin(text, true); }

  /// Overwrites the fields whose keys are present. Neither checks bounds nor rejects unknown keys.
  /// \throws std::invalid_argument on a wrong type
  void read(ParameterReader& reader, Struct& values) const {
    for (const Entry& entry : entries_) entry.read(reader, values, entry.row.key);
  }

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void check(const Struct& values) const {
    for (const Entry& entry : entries_) entry.check(values, entry.row.key);
  }

  /// One sentence for each number outside the range that is known to work.
  std::vector<std::string> warnings(const Struct& values) const {
    std::vector<std::string> warnings;
    for (const Entry& entry : entries_) {
      if (!entry.warning) continue;
      const std::string warning = entry.warning(values, entry.row.key);
      if (!warning.empty()) warnings.push_back(warning);
    }
    return warnings;
  }

  /// Reads, rejects unknown keys, and validates. \throws std::invalid_argument
  Struct readAll(ParameterReader& reader) const {
    Struct values;
    read(reader, values);
    reader.rejectUnknown();
    values.validate();
    return values;
  }

  /// For documents; the values are those of the struct given.
  std::vector<ParameterRow> rows(const Struct& values = Struct{}) const {
    std::vector<ParameterRow> rows;
    for (const Entry& entry : entries_) {
      rows.push_back(entry.row);
      rows.back().value = entry.value(values);
    }
    return rows;
  }

  struct Entry {
    ParameterRow row;
    std::function<void(ParameterReader&, Struct&, const std::string& name)> read;
    std::function<void(const Struct&, const std::string& name)> check = [](const Struct&,
                                                                           const std::string&) {};
    std::function<std::string(const Struct&)> value;
    std::function<double(const Struct&)> number;  ///< only of numbers
    /// Empty unless the value is one to warn of; none if there is nothing to warn of.
    std::function<std::string(const Struct&, const std::string& name)> warning;
  };
  const std::vector<Entry>& entries() const { return entries_; }

private:
  ParameterTable& begin(const std::string& text, bool is_expert) {
    heading_ = text;
    is_expert_ = is_expert;
    return *this;
  }

  static void addRange(ParameterRow& row, const std::string& bound) {
    if (bound.empty()) return;
    row.range += (row.range.empty() ? "" : ", ") + bound;
  }

  Entry makeEntry(const std::string& key,
                  const std::string& unit,
                  const std::string& range,
                  const std::string& text) {
    Entry entry;
    entry.row = {key, "", unit, range, text, std::exchange(heading_, ""), is_expert_};
    return entry;
  }

  template <typename Value, typename Check>
  ParameterTable& append(const std::string& key,
                         Value Struct::*field,
                         const std::string& unit,
                         const std::string& range,
                         const std::string& text,
                         Check check) {
    Entry entry = makeEntry(key, unit, range, text);
    entry.read = [=](ParameterReader& reader, Struct& values, const std::string& name) {
      reader.read(name, values.*field);
    };
    entry.check = check;
    entry.value = [=](const Struct& values) { return toYamlText(values.*field); };
    entries_.push_back(std::move(entry));
    return *this;
  }

  std::vector<Entry> entries_;
  std::string heading_;
  bool is_expert_ = false;
};

}  // namespace ram_parameters
