// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"

namespace ramscout_bringup {

/// The words of a line between blanks, one at a time. Any failure sticks: read all, then ask
/// good().
class Words {
public:
  /// \param line  must outlive the object
  explicit Words(std::string_view line) : rest_(line) {}

  /// The next word; a failure if there is none.
  std::string_view next() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t"), rest_.size()));
    const std::size_t length = std::min(rest_.find_first_of(" \t"), rest_.size());
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    good_ = good_ && !word.empty();
    return word;
  }

  /// The next word as a number, all of it, whatever the locale.
  template <typename Number>
  Number number() {
    return parse<Number>(next());
  }

  /// Three numbers: x y yaw [m, rad]; a failure if one is not finite.
  ram_slam::Pose2 pose() {
    ram_slam::Pose2 pose;
    pose.x_m = number<double>();
    pose.y_m = number<double>();
    pose.yaw_rad = ram_slam::wrapAngle(number<double>());
    good_ = good_ && pose.isFinite();
    return pose;
  }

  /// Seconds such as 12.345678 or 1.2345678e+01 in nanoseconds, digit by digit: a double resolves
  /// 0.2 us at today's epoch.
  std::int64_t stampNs() {
    const std::string_view word = next();
    const std::size_t exponent_at = std::min(word.find_first_of("eE"), word.size());
    int exponent = 0;
    if (exponent_at < word.size()) {
      std::string_view digits = word.substr(exponent_at + 1);
      if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
      exponent = parse<int>(digits);
    }
    const std::string_view mantissa = word.substr(0, exponent_at);
    const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
    std::string digits(mantissa.substr(0, point));
    digits += mantissa.substr(std::min(point + 1, mantissa.size()));
    // So many of the digits are whole nanoseconds; the rest is less than one.
    const auto wanted = static_cast<long>(point) + exponent + 9;
    constexpr long kMostDigits = 20;  // more than 64 bits hold
    if (wanted < 0 || wanted > kMostDigits || digits.empty() || mantissa.empty()) {
      good_ = good_ && wanted < 0 && !digits.empty();
      return 0;
    }
    digits.resize(static_cast<std::size_t>(wanted), '0');
    return digits.empty() ? 0 : parse<std::int64_t>(digits);
  }

  /// `count` numbers; a failure if there are fewer, or more than 20,000 are wanted.
  std::vector<float> readings(std::size_t count) {
    constexpr std::size_t kMaxReadings = 20000;
    good_ = good_ && count <= kMaxReadings;
    std::vector<float> values(good_ ? count : 0);
    for (float& value : values) value = number<float>();
    return values;
  }

  bool good() const { return good_; }

private:
  template <typename Number>
  Number parse(std::string_view word) {
    Number value{};
    const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
    good_ = good_ && result.ec == std::errc() && result.ptr == word.data() + word.size();
    return value;
  }

  std::string_view rest_;
  bool good_ = true;
};

}  // namespace ramscout_bringup
