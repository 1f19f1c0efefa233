// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/measurement.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <ratio>

namespace ramscout_bringup {

std::vector<MeasurementRange> rangesOf(const Measurement& measurement,
                                       std::int64_t begin_ns,
                                       std::int64_t end_ns,
                                       std::size_t count) {
  if (count == 0 || end_ns <= begin_ns) return {};
  const double step_s = 1e-9 * static_cast<double>(end_ns - begin_ns) / static_cast<double>(count);
  std::vector<MeasurementRange> ranges(count);
  std::vector<std::size_t> sizes(count, 0);
  for (const Sample& sample : measurement.samples) {
    if (sample.stamp_ns < begin_ns || sample.stamp_ns > end_ns || !std::isfinite(sample.value))
      continue;
    const double since_s = 1e-9 * static_cast<double>(sample.stamp_ns - begin_ns);
    const std::size_t i = std::min(static_cast<std::size_t>(since_s / step_s), count - 1);
    MeasurementRange& range = ranges[i];
    range.least = sizes[i] == 0 ? sample.value : std::min(range.least, sample.value);
    range.greatest = sizes[i] == 0 ? sample.value : std::max(range.greatest, sample.value);
    range.mean += (sample.value - range.mean) / static_cast<double>(++sizes[i]);
  }
  std::vector<MeasurementRange> filled;
  for (std::size_t i = 0; i < count; ++i) {
    if (sizes[i] == 0) continue;
    ranges[i].middle_s = (static_cast<double>(i) + 0.5) * step_s;
    filled.push_back(ranges[i]);
  }
  return filled;
}

void RateCounter::add(std::int64_t stamp_ns) {
  ++counts_[stamp_ns / std::nano::den];
}

std::vector<Sample> RateCounter::perSecond() const {
  std::vector<Sample> samples;
  if (counts_.size() < 3) return samples;
  const auto add = [&samples](std::int64_t second, std::size_t count) {
    samples.push_back({second * std::nano::den + std::nano::den / 2, static_cast<double>(count)});
  };
  for (auto row = std::next(counts_.begin()); row != counts_.end(); ++row) {
    const std::int64_t before = std::prev(row)->first;
    if (row->first - before > 1) add(before + 1, 0);
    if (row->first - before > 2) add(row->first - 1, 0);
    if (std::next(row) != counts_.end()) add(row->first, row->second);
  }
  return samples;
}

}  // namespace ramscout_bringup
