// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/findings.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace ramscout_bringup {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// A sound run of 100 s with a scan per second.
Results soundRun() {
  Results results;
  for (int i = 0; i < 100; ++i)
    results.trajectory_online.push_back({(1000 + i) * kSecond, {0.5 * i, 0.0, 0.0}});
  results.trajectory = results.trajectory_online;
  results.scan_count = 100;
  results.landmarks.resize(3);
  results.closures = {{1000 * kSecond, 1090 * kSecond, 0.9, 0.8, 0.1, true}};
  results.summary = {{"motion_from", "odometry and scans"},
                     {"scans_without_odometry", 0},
                     {"scans_with_wheel_slip", 0},
                     {"distance_m", 49.5},
                     {"loop_closures", 1},
                     {"losses", nlohmann::ordered_json::array()},
                     {"times_carried", 0},
                     {"clock_resets", 0}};
  return results;
}

/// The first finding whose text contains `part`; fails without one.
Finding findingWith(const Results& results, const std::string& part) {
  const auto findings = findingsOf(results);
  const auto found = std::find_if(
      findings.begin(), findings.end(),
      [&part](const Finding& finding) { return finding.text.find(part) != std::string::npos; });
  if (found != findings.end()) return *found;
  ADD_FAILURE() << "no finding has: " << part;
  return {};
}

TEST(Findings, OfASoundRunAreAllGoodAndWithoutAdvice) {
  const auto findings = findingsOf(soundRun());
  EXPECT_GE(findings.size(), 4U);
  for (const Finding& finding : findings) {
    EXPECT_EQ(finding.level, FindingLevel::kGood) << finding.text;
    EXPECT_TRUE(finding.advice.empty()) << finding.advice;
  }
  EXPECT_EQ(worstOf(findings), FindingLevel::kGood);
}

TEST(Findings, OfNothingKnownOnlyMissTheLandmarks) {
  const auto findings = findingsOf(Results{});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].text, "The map has no landmark.");
  EXPECT_EQ(worstOf({}), FindingLevel::kGood);
}

TEST(Findings, ScansThatWereNotUsedAreAWarningAndMostOfThemMakeTheRunBad) {
  Results results = soundRun();
  results.scan_count = 110;
  EXPECT_EQ(findingWith(results, "100 of 110 scans").level, FindingLevel::kWarning);
  results.scan_count = 250;
  EXPECT_EQ(findingWith(results, "100 of 250 scans").level, FindingLevel::kBad);
}

TEST(Findings, AGapBetweenScansIsStatedWithItsBeginning) {
  Results results = soundRun();
  for (std::size_t i = 40; i < 100; ++i) results.trajectory_online[i].stamp_ns += 7 * kSecond;
  const Finding finding = findingWith(results, "No scan was used for 8 s, from 39.0 s on");
  EXPECT_EQ(finding.level, FindingLevel::kWarning);
  EXPECT_FALSE(finding.advice.empty());
}

TEST(Findings, AnEndWithoutAKnownPlaceIsBadAndStandsFirst) {
  Results results = soundRun();
  results.summary["losses"].push_back(
      {{"reason", "the map contradicts"}, {"from_s", 1080.0}, {"to_s", nullptr}});
  const auto findings = findingsOf(results);
  EXPECT_EQ(findings.front().level, FindingLevel::kBad);
  EXPECT_NE(findings.front().text.find("from 80.0 s on: the map contradicts"), std::string::npos);
  EXPECT_EQ(worstOf(findings), FindingLevel::kBad);
}

TEST(Findings, APlaceThatWasFoundAgainIsAWarning) {
  Results results = soundRun();
  results.summary["losses"].push_back(
      {{"reason", "carried"}, {"from_s", 1010.0}, {"to_s", 1012.0}});
  EXPECT_EQ(findingWith(results, "lost and found again").level, FindingLevel::kWarning);
  EXPECT_EQ(worstOf(findingsOf(results)), FindingLevel::kWarning);
}

TEST(Findings, WeakOdometryIsAWarningThatNamesItsKind) {
  Results results = soundRun();
  results.summary["scans_with_wheel_slip"] = 20;
  EXPECT_EQ(findingWith(results, "The wheels contradict 20 %").level, FindingLevel::kWarning);
  results.summary["scans_without_odometry"] = 30;
  EXPECT_EQ(findingWith(results, "30 % of the scans came without").level, FindingLevel::kWarning);
  results.summary["motion_from"] = "scans alone: there is no odometry";
  EXPECT_EQ(findingWith(results, "there is no odometry").level, FindingLevel::kWarning);
}

TEST(Findings, ALongPathWithoutALoopIsAWarningAndAShortOneIsNot) {
  Results results = soundRun();
  results.summary["loop_closures"] = 0;
  EXPECT_EQ(worstOf(findingsOf(results)), FindingLevel::kGood);
  results.summary["distance_m"] = 250.0;
  EXPECT_EQ(worstOf(findingsOf(results)), FindingLevel::kGood) << "it was not smoothed at all";
  results.pose_graph_g2o = "VERTEX_SE2 0 0 0 0\n";
  EXPECT_EQ(findingWith(results, "No loop was closed along 250 m").level, FindingLevel::kWarning);
}

TEST(Findings, RefusedClosuresAreCounted) {
  Results results = soundRun();
  results.closures.push_back({1001 * kSecond, 1091 * kSecond, 0.5, 0.6, 0.2, false});
  findingWith(results, "1 closed loops, and 1 refused");
}

TEST(Findings, CarriedRobotsAndClocksThatWereSetBackAreWarnings) {
  Results results = soundRun();
  results.summary["times_carried"] = 2;
  results.summary["clock_resets"] = 1;
  EXPECT_EQ(findingWith(results, "carried").level, FindingLevel::kWarning);
  EXPECT_EQ(findingWith(results, "clock was set back").level, FindingLevel::kWarning);
}

TEST(Findings, TheVerdictAgainstTheTrueWayDecides) {
  Results results = soundRun();
  results.summary["position_error_rms_m"] = 0.031;
  results.summary["verdict"] = "good";
  EXPECT_EQ(findingWith(results, "0.031 m off the true one").level, FindingLevel::kGood);
  results.summary["verdict"] = "bad";
  EXPECT_EQ(findingWith(results, "0.031 m off the true one").level, FindingLevel::kBad);
}

}  // namespace
}  // namespace ramscout_bringup
