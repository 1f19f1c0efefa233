// SPDX-License-Identifier: BSD-3-Clause
// A short fixed run of what the fuzzers try for hours.
#include <gtest/gtest.h>

#include "ram_slam/geometry/random.hpp"

#include "fuzz_targets.hpp"

namespace ramscout_feature_detector {
namespace {

std::vector<std::uint8_t> bytes(ram_slam::Random& random, std::size_t count) {
  std::vector<std::uint8_t> result(count);
  for (std::uint8_t& byte : result) byte = static_cast<std::uint8_t>(random() >> 56);
  return result;
}

TEST(Fuzz, AnyScanIsRefusedOrYieldsFiniteFeatures) {
  const FeatureDetector corners({});
  const EdgeDetector edges({});
  ram_slam::Random random(1);
  std::size_t found = 0;
  for (int i = 0; i < 5000; ++i) {
    auto data = bytes(random, 17 + static_cast<std::size_t>(300.0 * random.uniform()));
    if (i % 3 != 0) {  // mostly smooth surfaces
      for (std::size_t j = 1; j < data.size(); ++j) {
        if (data[j] < 240) data[j] = static_cast<std::uint8_t>(109 + data[j] % 31);
      }
    }
    const ram_slam::LaserScan scan = scanOfBytes(data.data(), data.size(), 1000);
    tryScan(corners, scan);
    tryScan(edges, scan);
    if (data[0] % 4 != 3) found += corners.analyse(scan).corners.size();
  }
  EXPECT_GT(found, 100U);
}

TEST(Fuzz, AnyClassifierIsReadOrIgnored) {
  ram_slam::Random random(2);
  for (int i = 0; i < 50000; ++i) {
    auto data = bytes(random, i % 2 == 0 ? 65 : static_cast<std::size_t>(200.0 * random.uniform()));
    if (i % 4 == 0) {
      for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>('a' + byte % 26);
      data[0] = 0;
    }
    if (i % 8 == 0) {
      data.resize(133, 'b');
      data[0] = 1;
      for (std::size_t j = 1; j < 4; ++j) data[j] = static_cast<std::uint8_t>('1' + data[j] % 9);
      data[4] = ':';
    }
    tryClassifier(data.data(), data.size());
  }
}

}  // namespace
}  // namespace ramscout_feature_detector
