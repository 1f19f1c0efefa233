// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/odometry_buffer.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "drives.hpp"

namespace ramscout_kinematics {
namespace {

using ram_slam::Pose2;

Pose2 motion(const OdometryBuffer& buffer, double from_s, double to_s) {
  Pose2 total;
  for (const MotionSegment& segment : buffer.segments(after(from_s), after(to_s))) {
    total = total * ram_slam::exponential(segment.increment);
  }
  return total;
}

OdometryBuffer bufferOf(const std::vector<OdometrySample>& samples,
                        OdometryBufferParameters parameters = {}) {
  OdometryBuffer buffer(parameters);
  for (const OdometrySample& sample : samples) buffer.add(sample);
  return buffer;
}

/// Lets a request reach a little past the newest sample.
OdometryBufferParameters extrapolating() {
  OdometryBufferParameters parameters;
  parameters.max_extrapolation_s = 0.2;
  return parameters;
}

Unavailable reasonFor(const OdometryBuffer& buffer, double from_s, double to_s) {
  try {
    buffer.segments(after(from_s), after(to_s));
  } catch (const OdometryUnavailable& error) {
    return error.reason;
  }
  throw std::logic_error("the interval was answered");
}

std::vector<OdometrySample> shifted(std::vector<OdometrySample> samples,
                                    const Pose2& new_from_old) {
  for (OdometrySample& sample : samples)
    sample.odom_from_base = new_from_old * sample.odom_from_base;
  return samples;
}

TEST(OdometryBuffer, UsesExactlyTheIntervalsBetweenTheStamps) {
  const OdometryBuffer buffer = bufferOf(drive({1.0, 0.0, 0.0}, 1.0, 0.01));
  EXPECT_EQ(buffer.segments(after(0.30), after(0.40)).size(), 10u);
  const auto segments = buffer.segments(after(0.305), after(0.401));
  ASSERT_EQ(segments.size(), 11u);
  EXPECT_NEAR(segments.front().increment.x(), 0.005, 1e-9);
  EXPECT_NEAR(segments[1].increment.x(), 0.01, 1e-9);
  EXPECT_NEAR(segments.back().increment.x(), 0.001, 1e-9);
}

TEST(OdometryBuffer, MidpointBetweenTwoSamplesLiesOnTheCircleNotOnTheChord) {
  OdometryBufferParameters parameters;
  parameters.gap_s = parameters.max_gap_s = 5.0;
  const OdometryBuffer buffer = bufferOf(drive({1.0, 0.0, 1.0}, 3.0, 3.0), parameters);
  const Pose2 middle = motion(buffer, 0.0, 1.5);
  EXPECT_NEAR((middle.translation() - Eigen::Vector2d(0.0, 1.0)).norm(), 1.0, 1e-9);
  EXPECT_NEAR(middle.yaw_rad, 1.5, 1e-9);
}

TEST(OdometryBuffer, ArrivalOrderDoesNotMatter) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const std::vector<OdometrySample> samples = randomDrive(seed, 3.0, 0.02);
    std::vector<OdometrySample> mixed = samples;
    ram_slam::Random random(seed, 7);
    // Each arrives up to 0.4 s late: sorted by stamp plus delay.
    std::vector<std::pair<std::int64_t, OdometrySample>> arrivals;
    for (const auto& sample : samples) {
      arrivals.emplace_back(sample.stamp_ns + std::llround(4e8 * random.uniform()), sample);
    }
    std::sort(arrivals.begin(), arrivals.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    OdometryBuffer late{OdometryBufferParameters()};
    for (const auto& arrival : arrivals) late.add(arrival.second);
    const OdometryBuffer ordered = bufferOf(samples);
    const auto expected = ordered.segments(after(0.5), after(2.5));
    const auto got = late.segments(after(0.5), after(2.5));
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t i = 0; i < got.size(); ++i) EXPECT_EQ(got[i].increment, expected[i].increment);
  }
}

TEST(OdometryBuffer, ArrivalOrderDoesNotMatterAroundAnOriginThatMoved) {
  std::vector<OdometrySample> samples = drive({0.5, 0.0, 0.2}, 2.0, 0.02);
  for (std::size_t i = 50; i < samples.size(); ++i) {
    samples[i].odom_from_base = Pose2{20.0, -30.0, 1.0} * samples[i].odom_from_base;
  }
  samples[20].odom_from_base.x_m += 5.0;  // and one that jumps
  const OdometryBuffer ordered = bufferOf(samples);
  const auto expected = ordered.segments(after(0.1), after(1.9));
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    std::vector<std::pair<std::int64_t, OdometrySample>> arrivals;
    ram_slam::Random random(seed, 8);
    for (const auto& sample : samples) {
      arrivals.emplace_back(sample.stamp_ns + std::llround(2e8 * random.uniform()), sample);
    }
    std::sort(arrivals.begin() + 1, arrivals.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    OdometryBuffer late{OdometryBufferParameters()};
    for (const auto& arrival : arrivals) late.add(arrival.second);
    const auto got = late.segments(after(0.1), after(1.9));
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
      EXPECT_EQ(got[i].increment, expected[i].increment);
      EXPECT_EQ(got[i].added_variance, expected[i].added_variance);
    }
  }
}

TEST(OdometryBuffer, SampleOfTheSameStampReplaces) {
  std::vector<OdometrySample> samples = drive({1.0, 0.0, 0.0}, 1.0, 0.1);
  OdometryBuffer buffer = bufferOf(samples);
  EXPECT_EQ(buffer.add(samples.back()), Added::kRepeated);
  EXPECT_NEAR(motion(buffer, 0.0, 1.0).x_m, 1.0, 1e-9);
  samples.back().odom_from_base.x_m = 1.1;
  EXPECT_EQ(buffer.add(samples.back()), Added::kRepeated);
  EXPECT_NEAR(motion(buffer, 0.0, 1.0).x_m, 1.1, 1e-9);
}

TEST(OdometryBuffer, DropsWhatComesTooLateAndForgetsAllWhenTheClockIsSetBack) {
  OdometryBuffer buffer = bufferOf(drive({1.0, 0.0, 0.0}, 5.0, 0.1));
  EXPECT_EQ(buffer.add({after(4.95), {4.95, 0.0, 0.0}}), Added::kReordered);
  EXPECT_EQ(buffer.add({after(4.25), {77.0, 0.0, 0.0}}), Added::kTooLate);
  EXPECT_NEAR(motion(buffer, 4.0, 4.5).x_m, 0.5, 1e-9);
  EXPECT_EQ(buffer.add({after(1.0), {0.0, 0.0, 0.0}}), Added::kClockSetBack);
  EXPECT_EQ(buffer.oldestNs(), after(1.0));
  EXPECT_EQ(buffer.newestNs(), after(1.0));
  for (const OdometrySample& sample : drive({1.0, 0.0, 0.0}, 3.0, 0.1)) {
    if (sample.stamp_ns > after(1.0)) buffer.add(sample);
  }
  EXPECT_NEAR(motion(buffer, 1.5, 2.5).x_m, 1.0, 1e-9);
}

TEST(OdometryBuffer, ForgetsWhatIsOlderThanItsLength) {
  OdometryBufferParameters parameters;
  parameters.buffer_duration_s = 2.0;
  const OdometryBuffer buffer = bufferOf(drive({1.0, 0.0, 0.0}, 10.0, 0.1), parameters);
  EXPECT_EQ(buffer.oldestNs(), after(8.0));
  EXPECT_EQ(reasonFor(buffer, 7.9, 9.0), Unavailable::kTooOld);
  EXPECT_NEAR(motion(buffer, 8.0, 9.0).x_m, 1.0, 1e-9);
}

TEST(OdometryBuffer, SeparatesWhatItForgotFromWhatWasBeforeTheFirstOdometry) {
  OdometryBufferParameters parameters;
  parameters.buffer_duration_s = 2.0;
  OdometryBuffer buffer(parameters);
  const auto samples = drive({1.0, 0.0, 0.0}, 3.0, 0.1);
  for (const OdometrySample& sample : samples) {
    buffer.add(sample);
    const bool is_full = sample.stamp_ns > after(2.05);
    EXPECT_EQ(reasonFor(buffer, -0.5, 0.0),
              is_full ? Unavailable::kTooOld : Unavailable::kBeforeFirst);
  }
}

TEST(OdometryBuffer, RefusesIntervalsThatItDoesNotCover) {
  EXPECT_EQ(reasonFor(OdometryBuffer{OdometryBufferParameters()}, 0.0, 1.0),
            Unavailable::kNoOdometry);
  const OdometryBuffer buffer = bufferOf(drive({1.0, 0.0, 0.0}, 1.0, 0.1), extrapolating());
  EXPECT_EQ(reasonFor(buffer, -0.01, 0.5), Unavailable::kBeforeFirst);
  EXPECT_EQ(reasonFor(buffer, 0.5, 1.21), Unavailable::kNotYetAvailable);
  EXPECT_THROW(buffer.segments(after(0.5), after(0.4)), std::invalid_argument);
  EXPECT_THROW(buffer.segments(0, after(0.4)), std::invalid_argument);
  EXPECT_THROW(buffer.segments(after(0.4), 0), std::invalid_argument);
}

TEST(OdometryBuffer, RefusalNamesTheBufferedStamps) {
  const OdometryBuffer buffer = bufferOf(drive({1.0, 0.0, 0.0}, 1.0, 0.1));
  try {
    buffer.segments(after(0.5), after(9.0));
    FAIL();
  } catch (const OdometryUnavailable& error) {
    EXPECT_NE(
        std::string(error.what()).find("buffered are 1700000000.000000000 to 1700000001.000000000"),
        std::string::npos)
        << error.what();
  }
}

TEST(OdometryBuffer, GoesOnAtTheLastVelocityForAMomentWithMoreNoise) {
  const OdometryBuffer buffer = bufferOf(drive({1.0, 0.0, 0.5}, 1.0, 0.01), extrapolating());
  const Pose2 expected = ram_slam::exponential(Eigen::Vector3d(0.2, 0.0, 0.1));
  const Pose2 got = motion(buffer, 1.0, 1.2);
  EXPECT_NEAR(got.x_m, expected.x_m, 1e-9);
  EXPECT_NEAR(got.y_m, expected.y_m, 1e-9);
  EXPECT_NEAR(got.yaw_rad, expected.yaw_rad, 1e-9);
  // Acceleration of 1 m/s^2 and 2 rad/s^2: displacement a t^2 / 2.
  const auto whole = buffer.segments(after(1.0), after(1.2));
  ASSERT_EQ(whole.size(), 1u);
  EXPECT_NEAR(whole[0].added_variance.x(), 0.02 * 0.02, 1e-12);
  EXPECT_NEAR(whole[0].added_variance.z(), 0.04 * 0.04, 1e-12);
  const double parts = buffer.segments(after(1.0), after(1.1))[0].added_variance.x() +
                       buffer.segments(after(1.1), after(1.2))[0].added_variance.x();
  EXPECT_NEAR(parts, whole[0].added_variance.x(), 1e-12);
}

TEST(OdometryBuffer, TrustsTheReportedTwistAfterTheFirstSample) {
  const OdometryBuffer buffer =
      bufferOf({{after(0.0), {3.0, 4.0, 1.0}, {0.5, 0.0, 0.0}}}, extrapolating());
  EXPECT_NEAR(motion(buffer, 0.0, 0.1).x_m, 0.05, 1e-9);
}

TEST(OdometryBuffer, BridgesAGapWithMoreNoiseAndRefusesALongOne) {
  OdometryBufferParameters parameters;
  parameters.gap_s = 0.5;
  parameters.max_gap_s = 2.0;
  std::vector<OdometrySample> samples = drive({1.0, 0.0, 0.0}, 5.0, 0.1);
  samples.erase(samples.begin() + 11, samples.begin() + 20);  // 1 s without
  const OdometryBuffer buffer = bufferOf(samples, parameters);
  const auto segments = buffer.segments(after(1.0), after(2.0));
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_NEAR(segments[0].increment.x(), 1.0, 1e-9);
  EXPECT_NEAR(segments[0].noise_factor, 2.0, 1e-9);
  EXPECT_EQ(buffer.segments(after(0.5), after(0.6))[0].noise_factor, 1.0);

  samples.erase(samples.begin() + 11, samples.begin() + 30);
  const OdometryBuffer holed = bufferOf(samples, parameters);
  EXPECT_EQ(reasonFor(holed, 0.5, 4.5), Unavailable::kGap);
  EXPECT_NEAR(motion(holed, 0.5, 1.0).x_m, 0.5, 1e-9);
  EXPECT_NEAR(motion(holed, 4.0, 4.5).x_m, 0.5, 1e-9);
}

/// A second of odometry, then nothing for `gap_s`, then a pose `moved_m` farther on.
std::vector<OdometrySample> driveWithGap(double gap_s, double moved_m) {
  std::vector<OdometrySample> samples = drive({1.0, 0.0, 0.0}, 1.0, 0.1);
  OdometrySample later = samples.back();
  later.stamp_ns += static_cast<std::int64_t>(1e9 * gap_s);
  later.odom_from_base.x_m += moved_m;
  samples.push_back(later);
  return samples;
}

TEST(OdometryBuffer, AGapOverWhichThePoseGoesOnIsNone) {
  const OdometryBuffer on = bufferOf(driveWithGap(60.0, 0.3));
  EXPECT_NEAR(motion(on, 0.0, 61.0).x_m, 1.3, 1e-6);
  const OdometryBuffer away = bufferOf(driveWithGap(60.0, 0.6));
  EXPECT_EQ(reasonFor(away, 0.0, 61.0), Unavailable::kGap);
}

TEST(OdometryBuffer, KeepsWhatWasBeforeAGapHoweverLongThatWas) {
  OdometryBufferParameters parameters;
  parameters.buffer_duration_s = 12.0;
  parameters.max_gap_s = 10.0;
  OdometryBuffer buffer = bufferOf(driveWithGap(3600.0, 0.0), parameters);
  EXPECT_EQ(buffer.oldestNs(), after(0.0));
  EXPECT_NEAR(motion(buffer, 0.5, 3601.0).x_m, 0.5, 1e-6);
  OdometrySample next = driveWithGap(3600.0, 0.0).back();
  for (int i = 0; i < 30; ++i) {
    next.stamp_ns += 100'000'000;
    buffer.add(next);
  }
  EXPECT_EQ(buffer.oldestNs(), after(1.0)) << "10 s of the gap and 3 s after it are longer";
}

TEST(OdometryBuffer, NamesTheLimitThatHoldsOdometryBack) {
  const OdometryBuffer buffer = bufferOf(drive({9.0, 0.0, 0.0}, 0.2, 0.05));
  try {
    motion(buffer, 0.0, 0.15);
    FAIL();
  } catch (const OdometryUnavailable& error) {
    EXPECT_NE(std::string(error.what()).find("max_speed_mps"), std::string::npos);
  }
}

TEST(OdometryBuffer, OneSampleThatJumpsIsNotUsed) {
  std::vector<OdometrySample> samples = drive({1.0, 0.0, 0.0}, 1.0, 0.01);
  samples[50].odom_from_base.y_m = 5.0;
  OdometryBuffer buffer{OdometryBufferParameters()};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(buffer.add(samples[i]), i == 50 ? Added::kJump : Added::kInOrder);
  }
  EXPECT_NEAR(motion(buffer, 0.0, 1.0).y_m, 0.0, 1e-9);
  EXPECT_NEAR(motion(buffer, 0.495, 0.505).x_m, 0.01, 1e-9);
}

TEST(OdometryBuffer, JumpThatIsTheNewestIsNotExtrapolated) {
  OdometryBuffer buffer = bufferOf(drive({1.0, 0.0, 0.0}, 1.0, 0.01), extrapolating());
  EXPECT_EQ(buffer.add({after(1.01), {1.01, 5.0, 0.0}}), Added::kJump);
  EXPECT_EQ(buffer.newestNs(), after(1.0));
  EXPECT_NEAR(motion(buffer, 0.9, 1.1).y_m, 0.0, 1e-9);
}

TEST(OdometryBuffer, MotionGoesOnFromAnOriginThatMoved) {
  const std::vector<OdometrySample> before = drive({1.0, 0.0, 0.0}, 1.0, 0.01);
  std::vector<OdometrySample> restarted;
  for (OdometrySample sample : drive({1.0, 0.0, 0.0}, 1.0, 0.01)) {
    sample.stamp_ns += after(1.01) - kStartNs;
    restarted.push_back(sample);
  }
  for (const Pose2& origin : {Pose2{}, Pose2{50.0, -20.0, 3.0}}) {
    OdometryBuffer buffer = bufferOf(before);
    const auto moved = shifted(restarted, origin);
    std::vector<Added> outcomes;
    for (const OdometrySample& sample : moved) outcomes.push_back(buffer.add(sample));
    EXPECT_EQ(outcomes[0], Added::kJump);
    EXPECT_EQ(outcomes[1], Added::kJump);
    EXPECT_EQ(outcomes[2], Added::kDiscontinuity);
    EXPECT_EQ(outcomes[3], Added::kInOrder);
    // What was driven before and after is kept; what was driven meanwhile is unknown: large
    // variance.
    EXPECT_NEAR(motion(buffer, 0.5, 1.5).x_m, 0.5 + 0.49, 1e-9);
    const auto across = buffer.segments(after(1.0), after(1.01));
    ASSERT_EQ(across.size(), 1u);
    EXPECT_NEAR(across[0].added_variance.x(), 0.02 * 0.02, 1e-12);
  }
}

TEST(OdometryBuffer, WhatWasDrivenBeforeASourceStartedAgainIsUnknownHoweverPlausibleItLooks) {
  std::vector<OdometrySample> samples = drive({1.0, 0.0, 0.0}, 5.0, 0.1);
  samples.erase(samples.begin() + 11, samples.begin() + 20);  // 1 s without
  samples[11].is_restart = true;
  for (std::size_t i = 11; i < samples.size(); ++i) samples[i].odom_from_base.y_m += 0.4;
  const OdometryBuffer buffer = bufferOf(samples);
  EXPECT_EQ(reasonFor(buffer, 0.5, 3.0), Unavailable::kGap);
  EXPECT_NEAR(motion(buffer, 0.5, 1.0).x_m, 0.5, 1e-9);
  EXPECT_NEAR(motion(buffer, 2.0, 3.0).x_m, 1.0, 1e-9);
}

TEST(OdometryBuffer, ASourceThatStartsAgainAtOnceCostsOneInterval) {
  std::vector<OdometrySample> samples = drive({1.0, 0.0, 0.0}, 2.0, 0.1);
  samples[11].is_restart = true;
  for (std::size_t i = 11; i < samples.size(); ++i) samples[i].odom_from_base.y_m += 0.05;
  const OdometryBuffer buffer = bufferOf(samples);
  EXPECT_NEAR(motion(buffer, 0.5, 2.0).x_m, 1.4, 1e-9);
  EXPECT_NEAR(motion(buffer, 0.5, 2.0).y_m, 0.0, 1e-9);
  EXPECT_GT(buffer.segments(after(1.0), after(1.1))[0].added_variance.x(), 0.01);
}

TEST(OdometryBuffer, RefusedSampleChangesNothing) {
  OdometryBuffer buffer = bufferOf(drive({1.0, 0.0, 0.0}, 1.0, 0.01));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_THROW(buffer.add({0, {}}), std::invalid_argument);
  EXPECT_THROW(buffer.add({-5, {}}), std::invalid_argument);
  EXPECT_THROW(buffer.add({after(1.01), {nan, 0.0, 0.0}}), std::invalid_argument);
  EXPECT_THROW(buffer.add({after(1.01), {0.0, 0.0, inf}}), std::invalid_argument);
  EXPECT_THROW(buffer.add({after(1.01), {1.01, 0.0, 0.0}, {nan, 0.0, 0.0}}), std::invalid_argument);
  EXPECT_EQ(buffer.newestNs(), after(1.0));
  EXPECT_EQ(buffer.segments(after(0.0), after(1.0)).size(), 100u);
}

TEST(OdometryBuffer, SlowAndIrregularOdometryIsInterpolated) {
  OdometryBuffer buffer{OdometryBufferParameters()};
  for (const double time_s : {0.0, 0.5, 0.9, 1.4, 1.6, 2.0})
    buffer.add({after(time_s), {time_s, 0.0, 0.0}});
  EXPECT_NEAR(motion(buffer, 0.25, 1.85).x_m, 1.6, 1e-9);
}

TEST(OdometryBuffer, JumpIsWhatExceedsTwiceTheSpeedAndTheSlack) {
  OdometryBufferParameters parameters;
  parameters.max_speed_mps = 1.0;
  parameters.jump_slack_m = 0.3;
  const auto outcomeOf = [&](double step_m) {
    OdometryBuffer buffer(parameters);
    buffer.add({after(0.0), {0.0, 0.0, 0.0}});
    return buffer.add({after(0.1), {step_m, 0.0, 0.0}});
  };
  EXPECT_EQ(outcomeOf(0.49), Added::kInOrder);  // 2 * 1 m/s * 0.1 s + 0.3 m = 0.5 m
  EXPECT_EQ(outcomeOf(0.51), Added::kJump);
}

TEST(OdometryBuffer, LastVelocityIsThatOverTheBaseline) {
  OdometryBufferParameters parameters = extrapolating();
  std::vector<OdometrySample> samples = drive({1.0, 0.0, 0.0}, 1.0, 0.01);
  samples.back().odom_from_base.x_m += 0.01;  // the last step is twice as long
  EXPECT_NEAR(motion(bufferOf(samples, parameters), 1.0, 1.1).x_m, 0.15, 1e-9);
  parameters.twist_baseline_s = 0.1;
  EXPECT_NEAR(motion(bufferOf(samples, parameters), 1.0, 1.1).x_m, 0.11, 1e-9);
}

TEST(OdometryBufferParameters, RefusesValuesThatContradictEachOther) {
  const auto refuses = [](double OdometryBufferParameters::*field, double value) {
    OdometryBufferParameters bad;
    bad.*field = value;
    EXPECT_THROW(OdometryBuffer{bad}, std::invalid_argument);
  };
  refuses(&OdometryBufferParameters::reorder_window_s, 1.1);
  refuses(&OdometryBufferParameters::reorder_window_s, -0.1);
  refuses(&OdometryBufferParameters::buffer_duration_s, 3601.0);
  refuses(&OdometryBufferParameters::max_gap_s, 0.4);
  refuses(&OdometryBufferParameters::gap_s, 0.0);
  refuses(&OdometryBufferParameters::max_speed_mps, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace
}  // namespace ramscout_kinematics
