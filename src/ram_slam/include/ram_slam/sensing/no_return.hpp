// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace ram_slam {

/// Finds the reading that a lidar gives where nothing came back, from how often readings occur: a
/// far reading that is far commoner than any other in the farther half of the range. No wall is
/// that common.
class NoReturnDetector {
public:
  /// \param ranges_m  of one scan, as the sensor gave them
  void add(const std::vector<float>& ranges_m);

  /// The code [m], to a centimetre; nothing if the readings have none.
  std::optional<float> code_m() const;

  /// Readings from here on mean the same as the code: a sensor has a few codes close together
  /// (SICK: 81.83 to 81.91 m).
  static float limit_m(float code_m);

private:
  std::map<long, std::size_t> count_of_cm_;  ///< far readings, by centimetre
  std::size_t reading_count_ = 0;
};

}  // namespace ram_slam
