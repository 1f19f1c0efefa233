// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/carmen_log.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "ramscout_bringup/text_file.hpp"
#include "ramscout_bringup/words.hpp"

namespace ramscout_bringup {
namespace {

using ram_slam::LaserScan;
using ram_slam::Pose2;

constexpr float kTooCloseM = 0.005F;   // the sensors count centimetres: less is "blinded"
constexpr float kUnlimitedM = 100.0F;  // for a log that names no limit and has no code
constexpr float kLeastCodeM = 5.0F;    // no sensor of the family sees less far
// A no-return code is farther than all but stray readings; a sensor has a few of them close
// together (SICK: 81.83 to 81.91 m), each exact, where a wall's readings scatter, and far commoner
// than the readings of any far wall.
constexpr float kCodeSpread = 0.01F;
constexpr double kLeastCodeShare = 1e-4;
constexpr double kLeastShareAmongCodes = 0.25;
constexpr double kMaxShareBeyondCode = 0.01;
constexpr double kCodeToReadingRatio = 5.0;
constexpr double kMaxMountDeviation = 0.01;  // m or rad

struct Angles {
  double min_rad = 0.0;
  double increment_rad = 0.0;
};

Angles conventionalAngles(std::size_t count) {
  constexpr double kDegree = M_PI / 180.0;
  switch (count) {
    case 180:
    case 360:
      return {-M_PI_2, M_PI / static_cast<double>(count)};
    case 401:
      return {-50.0 * kDegree, 0.25 * kDegree};
    case 541:
      return {-135.0 * kDegree, 0.5 * kDegree};
    case 1081:
      return {-135.0 * kDegree, 0.25 * kDegree};
    default:
      return {-M_PI_2, M_PI / static_cast<double>(std::max<std::size_t>(count, 2) - 1)};
  }
}

struct LaserLine {
  LaserScan scan;
  Pose2 odom_from_laser;
  Pose2 odom_from_base;
};

void readPosesAndStamp(Words& words, std::size_t words_between, LaserLine& line) {
  line.odom_from_laser = words.pose();
  line.odom_from_base = words.pose();
  for (std::size_t i = 0; i < words_between; ++i) words.next();
  line.scan.stamp_ns = words.stampNs();
}

/// FLASER n r1..rn laser_pose base_pose stamp host logger_stamp.
LaserLine readFlaser(Words& words) {
  LaserLine line;
  const auto count = words.number<std::size_t>();
  line.scan.ranges_m = words.readings(count);
  const Angles angles = conventionalAngles(count);
  line.scan.angle_min_rad = angles.min_rad;
  line.scan.angle_increment_rad = angles.increment_rad;
  line.scan.range_max_m = kUnlimitedM;
  readPosesAndStamp(words, 0, line);
  return line;
}

/// ROBOTLASER1 type start field resolution max_range accuracy remission_mode n r1..rn m e1..em
/// laser_pose base_pose tv rv forward_safety side_safety turn_axis stamp host logger_stamp.
LaserLine readRobotLaser(Words& words) {
  LaserLine line;
  words.next();
  line.scan.angle_min_rad = words.number<double>();
  words.next();
  line.scan.angle_increment_rad = words.number<double>();
  line.scan.range_max_m = words.number<float>();
  words.next();
  words.next();
  line.scan.ranges_m = words.readings(words.number<std::size_t>());
  words.readings(words.number<std::size_t>());
  readPosesAndStamp(words, 5, line);
  return line;
}

bool isUsable(const LaserLine& line) {
  try {
    line.scan.validate();
  } catch (const std::invalid_argument&) {
    return false;
  }
  return line.scan.stamp_ns > 0;
}

std::vector<LaserLine> readLaserLines(const std::string& path, CarmenLog& log) {
  std::vector<LaserLine> lines;
  TextFile file(path);
  while (const auto text = file.nextLine()) {
    Words words(*text);
    const std::string_view kind = words.next();
    if (kind != "FLASER" && kind != "ROBOTLASER1") continue;
    LaserLine line = kind == "FLASER" ? readFlaser(words) : readRobotLaser(words);
    if (words.good() && isUsable(line)) {
      lines.push_back(std::move(line));
    } else {
      ++log.damaged_line_count;
    }
  }
  if (lines.empty()) throw std::runtime_error(path + " has no readable FLASER or ROBOTLASER1 line");
  return lines;
}

void sortByStamp(std::vector<LaserLine>& lines, CarmenLog& log) {
  const auto earlier = [](const auto& a, const auto& b) {
    return a.scan.stamp_ns < b.scan.stamp_ns;
  };
  const auto same = [](const auto& a, const auto& b) { return a.scan.stamp_ns == b.scan.stamp_ns; };
  std::stable_sort(lines.begin(), lines.end(), earlier);
  const auto end = std::unique(lines.begin(), lines.end(), same);
  log.duplicate_scan_count = static_cast<std::size_t>(lines.end() - end);
  lines.erase(end, lines.end());
}

/// How often each far reading occurs in the log, by centimetre.
std::map<long, std::size_t> countFarReadings(const std::vector<LaserLine>& lines) {
  std::map<long, std::size_t> count_of_cm;
  for (const LaserLine& line : lines) {
    for (const float range_m : line.scan.ranges_m) {
      if (range_m >= kLeastCodeM && std::isfinite(range_m))
        ++count_of_cm[std::lround(range_m * 100.0F)];
    }
  }
  return count_of_cm;
}

/// The far reading that is far commoner than any other in the farther half of the range: no wall is
/// that popular.
std::optional<float> findNoReturnCode(const std::vector<LaserLine>& lines) {
  const std::map<long, std::size_t> count_of_cm = countFarReadings(lines);
  const auto distance_seen = [](const auto& a, const auto& b) {
    return static_cast<double>(a.first) * static_cast<double>(a.second) <
           static_cast<double>(b.first) * static_cast<double>(b.second);
  };
  const auto code = std::max_element(count_of_cm.begin(), count_of_cm.end(), distance_seen);
  if (code == count_of_cm.end()) return std::nullopt;

  const auto code_cm = static_cast<double>(code->first);
  const auto count = static_cast<double>(code->second);
  double among_codes = 0.0;
  double beyond_codes = 0.0;
  double most_beside = 0.0;
  for (auto other = count_of_cm.lower_bound(code->first / 2); other != count_of_cm.end(); ++other) {
    const auto other_count = static_cast<double>(other->second);
    if (std::abs(static_cast<double>(other->first) - code_cm) <= kCodeSpread * code_cm) {
      among_codes += other_count;
    } else {
      most_beside = std::max(most_beside, other_count);
      if (other->first > code->first) beyond_codes += other_count;
    }
  }
  double reading_count = 0.0;
  for (const LaserLine& line : lines)
    reading_count += static_cast<double>(line.scan.ranges_m.size());
  const bool is_exact = count >= kLeastShareAmongCodes * among_codes;
  const bool is_farthest = beyond_codes <= kMaxShareBeyondCode * count;
  const bool is_common =
      count >= std::max(kLeastCodeShare * reading_count, kCodeToReadingRatio * most_beside);
  if (!is_exact || !is_farthest || !is_common) return std::nullopt;
  return static_cast<float>(code_cm / 100.0);
}

/// Gives readings their REP-117 values, and the scan the limits of what is left.
void applyRep117(const std::optional<float>& no_return_m, LaserScan& scan) {
  const float limit_m = no_return_m ? (1.0F - kCodeSpread) * *no_return_m : scan.range_max_m;
  for (float& range_m : scan.ranges_m) {
    if (range_m >= limit_m) {
      range_m = std::numeric_limits<float>::infinity();
    } else if (range_m < kTooCloseM) {
      range_m = -std::numeric_limits<float>::infinity();
    }
  }
  scan.range_min_m = kTooCloseM;
  scan.range_max_m = limit_m;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The constant between base and laser, if it is one: logs whose laser poses were corrected
/// afterwards have none.
std::optional<Pose2> findMount(const std::vector<LaserLine>& lines) {
  std::vector<double> x_m;
  std::vector<double> y_m;
  std::vector<double> yaw_rad;
  for (const LaserLine& line : lines) {
    const Pose2 mount = line.odom_from_base.inverse() * line.odom_from_laser;
    x_m.push_back(mount.x_m);
    y_m.push_back(mount.y_m);
    yaw_rad.push_back(mount.yaw_rad);
  }
  const Pose2 mount{median(x_m), median(y_m), median(yaw_rad)};
  std::vector<double> deviations;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double distance_m = std::hypot(x_m[i] - mount.x_m, y_m[i] - mount.y_m);
    deviations.push_back(
        std::max(distance_m, std::abs(ram_slam::wrapAngle(yaw_rad[i] - mount.yaw_rad))));
  }
  if (median(deviations) > kMaxMountDeviation) return std::nullopt;
  return mount;
}

bool odometryMoves(const std::vector<LaserLine>& lines) {
  const Pose2& first = lines.front().odom_from_base;
  return std::any_of(lines.begin(), lines.end(), [&](const LaserLine& line) {
    const Pose2 motion = first.inverse() * line.odom_from_base;
    return motion.translation().norm() > 1e-6 || std::abs(motion.yaw_rad) > 1e-6;
  });
}

}  // namespace

CarmenLog readCarmenLog(const std::string& path) {
  CarmenLog log;
  std::vector<LaserLine> lines = readLaserLines(path, log);
  sortByStamp(lines, log);

  if (const auto mount = findMount(lines)) {
    log.base_from_laser = *mount;
    log.mount_is_known = true;
  }
  log.no_return_m = findNoReturnCode(lines);
  const bool has_odometry = odometryMoves(lines);
  for (LaserLine& line : lines) {
    applyRep117(log.no_return_m, line.scan);
    if (has_odometry) log.odometry.push_back({line.scan.stamp_ns, line.odom_from_base});
    log.scans.push_back(std::move(line.scan));
  }
  return log;
}

}  // namespace ramscout_bringup
