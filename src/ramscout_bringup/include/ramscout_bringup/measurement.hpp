// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace ramscout_bringup {

/// A value at an instant.
struct Sample {
  std::int64_t stamp_ns = 0;
  double value = 0.0;
};

/// A figure over the time of a run.
struct Measurement {
  std::string name;
  std::string unit;     ///< empty: none
  std::string meaning;  ///< one sentence
  std::vector<Sample> samples = {};
};

/// Least, mean and greatest value of a measurement within an interval.
struct MeasurementRange {
  double middle_s = 0.0;  ///< of the interval, since the beginning
  double least = 0.0;
  double mean = 0.0;
  double greatest = 0.0;
};

/// Equal intervals of the time from `begin_ns` to `end_ns`; those without a sample are left out,
/// and so are samples outside and values that are not finite.
std::vector<MeasurementRange> rangesOf(const Measurement& measurement,
                                       std::int64_t begin_ns,
                                       std::int64_t end_ns,
                                       std::size_t count);

/// Counts messages by the second of their stamps.
class RateCounter {
public:
  void add(std::int64_t stamp_ns);
  /// A sample for each whole second; zero where a silence begins and ends. The first and the last
  /// second, which are not whole, are left out.
  std::vector<Sample> perSecond() const;

private:
  std::map<std::int64_t, std::size_t> counts_;  ///< by second
};

}  // namespace ramscout_bringup
