// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/carmen_log.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "ram_slam/geometry/median.hpp"
#include "ram_slam/sensing/no_return.hpp"
#include "ramscout_bringup/stamp_review.hpp"
#include "ramscout_bringup/text_file.hpp"
#include "ramscout_bringup/words.hpp"

namespace ramscout_bringup {
namespace {

using ram_slam::LaserScan;
using ram_slam::Pose2;

constexpr float kTooCloseM = 0.005F;         // the sensors count centimetres: less is "blinded"
constexpr double kMaxMountDeviation = 0.01;  // m or rad

struct Angles {
  double min_rad = 0.0;
  double increment_rad = 0.0;
};

/// The increments of lidars that look as far to the left as to the right, by their beams.
double increment_deg(std::size_t count) {
  switch (count) {
    case 401:   // SICK LMS2xx over 100 deg
    case 1081:  // Hokuyo UTM-30LX, UST-10LX, SICK LMS1xx over 270 deg
      return 0.25;
    case 541:  // SICK LMS1xx, S300
      return 0.5;
    case 811:  // SICK TiM
      return 1.0 / 3.0;
    case 682:  // Hokuyo URG-04LX over 240 deg, by some drivers with a step more
    case 683:
    case 726:  // UBG-04LX
    case 769:  // URG-04LX, all steps
      return 360.0 / 1024.0;
    default:
      return 180.0 / static_cast<double>(std::max<std::size_t>(count, 2) - 1);
  }
}

Angles conventionalAngles(std::size_t count, const std::optional<double>& fov_rad) {
  if (!fov_rad && (count == 180 || count == 360))
    return {-M_PI_2, M_PI / static_cast<double>(count)};
  const auto steps = static_cast<double>(std::max<std::size_t>(count, 2) - 1);
  const double increment_rad = fov_rad ? *fov_rad / steps : increment_deg(count) * M_PI / 180.0;
  return {-0.5 * steps * increment_rad, increment_rad};
}

struct LaserLine {
  LaserScan scan;
  Pose2 odom_from_laser;
  Pose2 odom_from_base;
  std::optional<std::int64_t> logged_ns;  ///< when the logger wrote the line, since its start
};

void readPosesAndStamp(Words& words, std::size_t words_between, LaserLine& line) {
  line.odom_from_laser = words.pose();
  line.odom_from_base = words.pose();
  for (std::size_t i = 0; i < words_between; ++i) words.next();
  line.scan.stamp_ns = words.stampNs();
  if (!words.good()) return;
  Words rest = words;
  rest.next();
  const std::int64_t logged_ns = rest.stampNs();
  if (rest.good()) line.logged_ns = logged_ns;
}

/// FLASER n r1..rn laser_pose base_pose stamp host logger_stamp.
LaserLine readFlaser(Words& words, const RecordingOptions& options) {
  LaserLine line;
  const auto count = words.number<std::size_t>();
  line.scan.ranges_m = words.readings(count);
  const Angles angles = conventionalAngles(count, options.fov_rad);
  line.scan.angle_min_rad = angles.min_rad;
  line.scan.angle_increment_rad = angles.increment_rad;
  line.scan.range_max_m = LaserScan::kUnlimitedRangeM;
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
  return line.scan.stamp_ns >= 0;
}

std::vector<LaserLine> readLaserLines(const std::string& path,
                                      const RecordingOptions& options,
                                      CarmenLog& log) {
  std::vector<LaserLine> lines;
  TextFile file(path);
  while (const auto text = file.nextLine()) {
    Words words(*text);
    const std::string_view kind = words.next();
    if (kind != "FLASER" && kind != "ROBOTLASER1") continue;
    LaserLine line = kind == "FLASER" ? readFlaser(words, options) : readRobotLaser(words);
    if (words.good() && isUsable(line)) {
      if (kind == "FLASER" && !options.fov_rad && !log.assumed_fov_rad) {
        log.assumed_beam_count = line.scan.ranges_m.size();
        log.assumed_fov_rad =
            line.scan.bearing_rad(log.assumed_beam_count - 1) - line.scan.angle_min_rad;
      }
      lines.push_back(std::move(line));
    } else {
      ++log.damaged_line_count;
    }
  }
  if (lines.empty()) throw std::runtime_error(path + " has no readable FLASER or ROBOTLASER1 line");
  return lines;
}

/// The lines' stamps, or the logger's where the stamps are no times of measurement.
std::vector<std::int64_t> usableStamps(std::vector<LaserLine>& lines, CarmenLog& log) {
  std::vector<std::int64_t> stamps_ns;
  std::vector<std::int64_t> logged_ns;
  for (const LaserLine& line : lines) {
    stamps_ns.push_back(line.scan.stamp_ns);
    if (line.logged_ns) logged_ns.push_back(*line.logged_ns);
  }
  if (!shouldUseRecorders(stamps_ns, logged_ns)) return stamps_ns;
  log.notes.push_back("more than half of the stamps repeat: the logger's are used instead");
  for (LaserLine& line : lines) line.scan.stamp_ns = *line.logged_ns;
  return logged_ns;
}

/// The lines that the options ask for, by rising stamps.
std::vector<LaserLine> selectLines(std::vector<LaserLine> lines,
                                   const RecordingOptions& options,
                                   CarmenLog& log) {
  const std::vector<std::int64_t> stamps_ns = usableStamps(lines, log);
  const Drive drive = selectDrive(stamps_ns, "the laser", options.part);
  log.notes.insert(log.notes.end(), drive.notes.begin(), drive.notes.end());
  log.stray_scan_count = drive.stray_count;
  std::vector<LaserLine> selected;
  for (const std::size_t i : selectScans(drive, stamps_ns, options)) {
    if (!selected.empty() && stamps_ns[i] == selected.back().scan.stamp_ns) {
      ++log.duplicate_scan_count;
    } else {
      selected.push_back(std::move(lines[i]));
    }
  }
  return selected;
}

/// Gives readings their REP-117 values, and the scan the limits of what is left.
void applyRep117(const std::optional<float>& no_return_m, LaserScan& scan) {
  const float limit_m =
      no_return_m ? ram_slam::NoReturnDetector::limit_m(*no_return_m) : scan.range_max_m;
  ram_slam::markNoReturns(limit_m, scan.ranges_m);
  for (float& range_m : scan.ranges_m)
    if (range_m < kTooCloseM) range_m = -std::numeric_limits<float>::infinity();
  scan.range_min_m = kTooCloseM;
  scan.range_max_m = limit_m;
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
  const Pose2 mount{ram_slam::median(x_m), ram_slam::median(y_m), ram_slam::median(yaw_rad)};
  std::vector<double> deviations;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double distance_m = std::hypot(x_m[i] - mount.x_m, y_m[i] - mount.y_m);
    deviations.push_back(
        std::max(distance_m, std::abs(ram_slam::wrapAngle(yaw_rad[i] - mount.yaw_rad))));
  }
  if (ram_slam::median(deviations) > kMaxMountDeviation) return std::nullopt;
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

CarmenLog readCarmenLog(const std::string& path, const RecordingOptions& options) {
  CarmenLog log;
  std::vector<LaserLine> lines = selectLines(readLaserLines(path, options, log), options, log);

  if (options.base_from_laser) {
    log.base_from_laser = *options.base_from_laser;
    log.mount_is_known = true;
  } else if (const auto mount = findMount(lines)) {
    log.base_from_laser = *mount;
    log.mount_is_known = true;
  }
  ram_slam::NoReturnDetector detector;
  for (const LaserLine& line : lines) detector.add(line.scan.ranges_m);
  log.no_return_m = detector.code_m();
  const bool has_odometry = odometryMoves(lines);
  for (LaserLine& line : lines) {
    applyRep117(log.no_return_m, line.scan);
    if (has_odometry) log.odometry.push_back({line.scan.stamp_ns, line.odom_from_base});
    log.scans.push_back(ram_slam::inSweepDirection(options.sweep_direction, std::move(line.scan)));
  }
  return log;
}

}  // namespace ramscout_bringup
