// SPDX-License-Identifier: BSD-3-Clause
// Every fuzz target with its sound inputs, and with some thousand mutations of them that are always
// the same.
#include <algorithm>
#include <chrono>
#include <ctime>
#include <string>

#include <gmock/gmock.h>
#include <ram_slam/geometry/random.hpp>
#include <sys/resource.h>

#include "fuzz_target.hpp"

namespace ramscout_bringup_ros {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;

std::size_t below(ram_slam::Random& random, std::size_t count) {
  return std::min(count - 1,
                  static_cast<std::size_t>(random.uniform() * static_cast<double>(count)));
}

/// What parsers stumble over: ends of ranges as numbers and as text, and what opens something.
const std::string& token(ram_slam::Random& random) {
  static const std::vector<std::string> kTokens = {std::string(4, '\0'),
                                                   std::string(8, '\xff'),
                                                   std::string("\xff\xff\xff\x7f", 4),
                                                   "nan",
                                                   "-inf",
                                                   "1e999",
                                                   "-1",
                                                   "99999999999999999999",
                                                   "0x",
                                                   "[",
                                                   "]",
                                                   "{",
                                                   "\"",
                                                   "<",
                                                   "/>",
                                                   ":",
                                                   "- ",
                                                   "\n",
                                                   "&a *a",
                                                   "\t",
                                                   "!!"};
  return kTokens[below(random, kTokens.size())];
}

/// One to four changes, each of a kind that fuzzers use, too.
std::string mutated(std::string bytes, ram_slam::Random& random) {
  for (std::size_t changes = 1 + below(random, 4); changes > 0; --changes) {
    const std::size_t at = below(random, bytes.size() + 1);
    const std::size_t length = std::min(bytes.size() - at, below(random, 16));
    switch (below(random, 5)) {
      case 0:
        if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(random, 8)));
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.insert(at, bytes.substr(below(random, bytes.size() + 1), length));
        break;
      case 3:
        bytes.replace(at, length, token(random));
        break;
      default:
        if (at < bytes.size()) bytes[at] = static_cast<char>(below(random, 256));
        if (below(random, 8) == 0) bytes.resize(at);
    }
  }
  return bytes;
}

std::vector<std::string> targetNames() {
  std::vector<std::string> names;
  for (const FuzzTarget& target : fuzzTargets()) names.push_back(target.name);
  return names;
}

class FuzzReplay : public ::testing::TestWithParam<std::string> {};

TEST_P(FuzzReplay, SoundInputsAreAccepted) {
  const FuzzTarget& target = fuzzTarget(GetParam());
  ASSERT_THAT(target.seeds, Not(IsEmpty()));
  for (const std::string& seed : target.seeds) EXPECT_NO_THROW(target.read(seed));
}

/// Until the target has had its time, at most 5,000 of them.
TEST_P(FuzzReplay, MutationsAreReadOrRefusedWithinASecondAndAGigabyte) {
  using Clock = std::chrono::steady_clock;
  const FuzzTarget& target = fuzzTarget(GetParam());
  constexpr std::uint64_t kMost = 5000;
  const Clock::time_point end = Clock::now() + std::chrono::milliseconds(900);
  for (std::uint64_t number = 0; number < kMost && Clock::now() < end; ++number) {
    ram_slam::Random random(number);
    const std::string bytes = mutated(target.seeds[number % target.seeds.size()], random);
    const std::clock_t start = std::clock();  // of the process: other processes may be busy
    EXPECT_NO_THROW(tryBytes(target, bytes)) << "mutation " << number;
    EXPECT_LT(std::clock() - start, CLOCKS_PER_SEC) << "mutation " << number;
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss, 1'000'000) << "kB";
}

std::string testName(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(AllTargets, FuzzReplay, ::testing::ValuesIn(targetNames()), testName);

}  // namespace
}  // namespace ramscout_bringup_ros
