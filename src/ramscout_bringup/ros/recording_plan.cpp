// SPDX-License-Identifier: BSD-3-Clause
// Decides from a survey what to read. Each decision that is not the plain one leaves a note.
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include "ram_slam/geometry/median.hpp"
#include "ramscout_bringup/stamp_review.hpp"

#include "recording_survey.hpp"

namespace ramscout_bringup_ros {
namespace {

using ram_slam::Pose2;
using ramscout_bringup::OdometryReading;
using ramscout_bringup::RecordingOptions;

/// Less is the delay from a sensor to the recorder; more is another clock.
constexpr double kMaxClockOffsetS = 1.0;
/// Odometry that begins or ends so much apart from the scans is worth a note.
constexpr std::int64_t kUncoveredNs = 1'000'000'000;

std::string text(double value, int digits = 1) {
  std::ostringstream stream;
  stream << std::fixed << std::setprecision(digits) << value;
  return stream.str();
}

double seconds(std::int64_t ns) {
  return 1e-9 * static_cast<double>(ns);
}

std::string list(const std::vector<std::string>& names) {
  return std::accumulate(std::next(names.begin()), names.end(), names.front(),
                         [](const std::string& a, const std::string& b) { return a + ", " + b; });
}

/// Median of stamp minus time of recording.
std::int64_t stampOffset_ns(const TopicTimes& times) {
  std::vector<std::int64_t> offsets_ns(times.stamps_ns.size());
  std::transform(times.stamps_ns.begin(), times.stamps_ns.end(), times.received_ns.begin(),
                 offsets_ns.begin(), std::minus<>());
  return ram_slam::median(std::move(offsets_ns));
}

/// Whether the time of recording follows the stamps, as it does when a robot drives.
bool wasRecordedLive(const TopicTimes& times) {
  const std::int64_t offset_ns = stampOffset_ns(times);
  std::vector<std::int64_t> deviations_ns(times.stamps_ns.size());
  std::transform(times.stamps_ns.begin(), times.stamps_ns.end(), times.received_ns.begin(),
                 deviations_ns.begin(), [&](std::int64_t stamp_ns, std::int64_t received_ns) {
                   return std::abs(stamp_ns - received_ns - offset_ns);
                 });
  return seconds(ram_slam::median(std::move(deviations_ns))) < 0.5 * kMaxClockOffsetS;
}

class Planner {
public:
  Planner(const RecordingSurvey& survey, const RecordingOptions& options)
      : survey_(survey), options_(options) {}

  RecordingPlan make() {
    if (survey_.scans.times.stamps_ns.empty())
      throw std::runtime_error("the recording has no message on " + survey_.scans.topic);
    chooseOdometry();
    chooseBaseFrame();
    checkMounts();
    scan_times_ = usableTimes(survey_.scans.times, survey_.scans.topic);
    const ramscout_bringup::Drive scans = select(scan_times_, survey_.scans.topic);
    planOdometry();
    checkClocks();
    rankScans(scans);
    checkCoverage();
    describeScans(scans);
    return std::move(plan_);
  }

private:
  void note(const std::string& line) { plan_.notes.push_back(line); }

  /// The frame of the odometry on tf: `odom`, or the parent of the base; never a corrected `map`.
  std::string odomFrame(const std::string& base) const {
    if (!options_.odom_frame.empty()) return options_.odom_frame;
    const std::string parent = survey_.tree.parent(base);
    return survey_.tree.has("odom") || parent.empty() || parent == "map" ? "odom" : parent;
  }

  bool tfHasOdometry(const std::string& base) const {
    return !survey_.tree.stamps(odomFrame(base), base).empty();
  }

  void chooseOdometry() {
    const bool tf_has_odometry =
        tfHasOdometry(options_.base_frame.empty() ? "base_link" : options_.base_frame) ||
        tfHasOdometry("base_footprint");
    odometry_topic_ = ramscout_bringup::chooseOdometryTopic(survey_.topics, options_.odometry_topic,
                                                            tf_has_odometry);
    const std::string others =
        ramscout_bringup::otherTopics(survey_.topics, survey_.scans.topic, odometry_topic_);
    if (!others.empty()) note("not used: " + others);
    const auto found = survey_.odometry.find(odometry_topic_);
    if (found != survey_.odometry.end()) odometry_ = &found->second;
  }

  /// Whether the recording knows a frame.
  bool isKnown(const std::string& frame) const {
    return survey_.tree.has(frame) || survey_.scans.count_of_frame.count(frame) > 0 ||
           (odometry_ != nullptr && odometry_->child_frame == frame);
  }

  void chooseBaseFrame() {
    if (!options_.base_frame.empty()) {
      if (!isKnown(options_.base_frame)) {
        throw std::runtime_error("the recording has no frame '" + options_.base_frame +
                                 "' (--base-frame); its frames: " + survey_.tree.frames());
      }
      plan_.base_frame = options_.base_frame;
      return;
    }
    std::vector<std::string> candidates{"base_link", "base_footprint"};
    if (odometry_ != nullptr && !odometry_->child_frame.empty())
      candidates.insert(std::next(candidates.begin()), odometry_->child_frame);
    const auto found = std::find_if(candidates.begin(), candidates.end(),
                                    [&](const std::string& frame) { return isKnown(frame); });
    const std::string& laser = survey_.scans.count_of_frame.begin()->first;
    const bool laser_is_known = survey_.tree.has(laser);
    plan_.base_frame = found != candidates.end() ? *found
                       : laser_is_known          ? survey_.tree.fixedAncestor(laser)
                                                 : "base_link";
    if (plan_.base_frame != "base_link") note("base frame: " + plan_.base_frame);
  }

  void checkMounts() {
    if (survey_.tree.ignoredCount() > 0) {
      note("left out " + std::to_string(survey_.tree.ignoredCount()) +
           " transforms: not finite, without a frame, or of a child that has another parent");
    }
    if (options_.base_from_laser) return;
    for (const auto& [frame, count] : survey_.scans.count_of_frame) {
      if (survey_.tree.connects(plan_.base_frame, frame)) continue;
      if (survey_.tree.frames() != "none") {
        throw std::runtime_error("tf has no transform from the laser's frame '" + frame + "' to '" +
                                 plan_.base_frame + "'; frames: " + survey_.tree.frames() +
                                 "; name the robot's frame with --base-frame or the mount with "
                                 "--mount x,y,yaw");
      }
      note("laser frame '" + frame + "' is assumed at '" + plan_.base_frame +
           "': the recording has no tf; give the mount with --mount x,y,yaw");
    }
  }

  /// The stamps of a topic, or the times of recording where the stamps are no times of measurement.
  std::vector<std::int64_t> usableTimes(const TopicTimes& times, const std::string& topic) {
    if (!ramscout_bringup::shouldUseRecorders(times.stamps_ns, times.received_ns))
      return times.stamps_ns;
    const double share = ramscout_bringup::shareOfDifferent(times.stamps_ns);
    note("the " + std::to_string(times.stamps_ns.size()) + " messages of " + topic + " have only " +
         std::to_string(std::lround(share * static_cast<double>(times.stamps_ns.size()))) +
         " different stamps: the times of recording are used instead");
    return times.received_ns;
  }

  ramscout_bringup::Drive select(const std::vector<std::int64_t>& stamps_ns,
                                 const std::string& topic) {
    ramscout_bringup::Drive drive = ramscout_bringup::selectDrive(stamps_ns, topic, options_.part);
    plan_.notes.insert(plan_.notes.end(), drive.notes.begin(), drive.notes.end());
    return drive;
  }

  void planOdometry() {
    if (!odometry_topic_.empty()) {
      planOdometryOfTopic();
    } else {
      planOdometryOfTf();
    }
    const auto earlier = [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; };
    std::stable_sort(plan_.odometry.begin(), plan_.odometry.end(), earlier);
  }

  void planOdometryOfTopic() {
    if (odometry_ == nullptr || odometry_->readings.empty()) {
      note("no odometry: " + odometry_topic_ + " has no valid message");
      return;
    }
    std::vector<OdometryReading> readings = selectedReadings();
    if (odometry_->invalid_count > 0) {
      note("left out " + std::to_string(odometry_->invalid_count) + " messages of " +
           odometry_topic_ + ": pose not finite, or its quaternion no rotation");
    }
    std::string source = odometry_topic_;
    switch (ramscout_bringup::reviewOdometry(readings)) {
      case ramscout_bringup::OdometryContent::kPose:
        break;
      case ramscout_bringup::OdometryContent::kTwist:
        ramscout_bringup::integrateTwist(readings);
        source += ", its twist integrated: its poses never move";
        break;
      case ramscout_bringup::OdometryContent::kNothing:
        note("no odometry: " + odometry_topic_ + " never moves");
        return;
    }
    const Pose2 child_from_base = childFromBase();
    for (const OdometryReading& reading : readings)
      plan_.odometry.push_back({reading.stamp_ns, reading.odom_from_child * child_from_base});
    note("odometry: " + std::to_string(readings.size()) + " of " + source);
  }

  std::vector<OdometryReading> selectedReadings() {
    const std::vector<std::int64_t> times = usableTimes(odometry_->times, odometry_topic_);
    std::vector<OdometryReading> readings;
    for (const std::size_t i : select(times, odometry_topic_).order) {
      readings.push_back(odometry_->readings[i]);
      readings.back().stamp_ns = times[i];
    }
    return readings;
  }

  /// The base in the frame whose poses the odometry gives.
  Pose2 childFromBase() {
    const std::string& child = odometry_->child_frame;
    if (child.empty() || child == plan_.base_frame) return {};
    const auto child_from_base =
        survey_.tree.lookup(child, plan_.base_frame, odometry_->readings.front().stamp_ns);
    if (child_from_base && survey_.tree.isConstant(child, plan_.base_frame)) {
      note("odometry of '" + child + "' is brought to '" + plan_.base_frame + "' by tf");
      return planar(*child_from_base);
    }
    if (survey_.tree.frames() == "none") {
      note("odometry of '" + child + "' is taken as of '" + plan_.base_frame +
           "': the recording has no tf");
      return {};
    }
    throw std::runtime_error(odometry_topic_ + " gives the pose of '" + child +
                             "', and tf has no constant transform from there to '" +
                             plan_.base_frame + "'; frames: " + survey_.tree.frames() +
                             "; name the robot's frame with --base-frame or other odometry with "
                             "--odom-topic");
  }

  static Pose2 planar(const Eigen::Isometry3d& transform) {
    const auto& r = transform.linear();
    return {transform.translation().x(), transform.translation().y(), std::atan2(r(1, 0), r(0, 0))};
  }

  void planOdometryOfTf() {
    const std::string odom_frame = odomFrame(plan_.base_frame);
    const std::string way = "tf " + odom_frame + " -> " + plan_.base_frame;
    for (const std::int64_t stamp_ns : survey_.tree.stamps(odom_frame, plan_.base_frame)) {
      if (const auto odom_from_base = survey_.tree.lookup(odom_frame, plan_.base_frame, stamp_ns))
        plan_.odometry.push_back({stamp_ns, planar(*odom_from_base)});
    }
    if (plan_.odometry.empty()) {
      note("no odometry: no topic of nav_msgs/Odometry, and " + way + " never moves");
      return;
    }
    note("odometry: " + std::to_string(plan_.odometry.size()) + " of " + way);
  }

  void checkClocks() {
    if (odometry_ == nullptr || plan_.odometry.empty()) return;
    const TopicTimes& scans = survey_.scans.times;
    if (!wasRecordedLive(scans) || !wasRecordedLive(odometry_->times)) return;
    const double apart_s = seconds(stampOffset_ns(scans) - stampOffset_ns(odometry_->times)) +
                           options_.scan_clock_offset_s;
    if (std::abs(apart_s) <= kMaxClockOffsetS) return;
    throw std::runtime_error(
        "the stamps of " + survey_.scans.topic + " are " + text(std::abs(apart_s)) + " s " +
        (apart_s > 0.0 ? "ahead of" : "behind") + " those of " + odometry_topic_ +
        " that were recorded at the same time: two clocks; correct them with "
        "--scan-clock-offset " +
        text(options_.scan_clock_offset_s - apart_s, 3));
  }

  /// Places of the scans to read, in the order of their stamps.
  void rankScans(const ramscout_bringup::Drive& drive) {
    plan_.scan_stamps_ns = scan_times_;
    for (std::int64_t& stamp_ns : plan_.scan_stamps_ns)
      stamp_ns += std::llround(1e9 * options_.scan_clock_offset_s);
    plan_.scan_ranks.resize(scan_times_.size());
    const std::vector<std::size_t> scans =
        ramscout_bringup::selectScans(drive, plan_.scan_stamps_ns, options_);
    for (const std::size_t i : scans) plan_.scan_ranks[i] = plan_.read_count++;
    plan_.scan_count = plan_.read_count + drive.stray_count;
    first_scan_ns_ = plan_.scan_stamps_ns[scans.front()];
    last_scan_ns_ = plan_.scan_stamps_ns[scans.back()];
    if (options_.start_s == 0.0 && !options_.duration_s) return;
    const auto outside = [&](const ram_slam::StampedPose2& reading) {
      return reading.stamp_ns < first_scan_ns_ - kUncoveredNs ||
             reading.stamp_ns > last_scan_ns_ + kUncoveredNs;
    };
    plan_.odometry.erase(std::remove_if(plan_.odometry.begin(), plan_.odometry.end(), outside),
                         plan_.odometry.end());
  }

  void checkCoverage() {
    if (plan_.odometry.empty()) return;
    const std::int64_t late_ns = plan_.odometry.front().stamp_ns - first_scan_ns_;
    const std::int64_t early_ns = last_scan_ns_ - plan_.odometry.back().stamp_ns;
    const std::string rest = ": the motion there is taken from the scans alone";
    if (late_ns > kUncoveredNs)
      note("odometry begins " + text(seconds(late_ns)) + " s after the scans" + rest);
    if (early_ns > kUncoveredNs)
      note("odometry ends " + text(seconds(early_ns)) + " s before the scans" + rest);
  }

  void describeScans(const ramscout_bringup::Drive& drive) {
    const RecordingSurvey::Scans& scans = survey_.scans;
    const double rate_hz = drive.period_s > 0.0 ? 1.0 / drive.period_s : 0.0;
    const double fov_rad = std::abs(scans.increment_rad) * static_cast<double>(scans.beam_count);
    note("scans: " + std::to_string(plan_.read_count) + " of " + scans.topic + ", " +
         text(rate_hz) + " Hz, " + std::to_string(scans.beam_count) + " beams over " +
         text(fov_rad * 180.0 / M_PI, 0) + " deg");
    if (scans.count_of_frame.size() > 1) {
      std::vector<std::string> frames;
      for (const auto& [frame, count] : scans.count_of_frame) frames.push_back("'" + frame + "'");
      note("scans come from several lasers, each with its own mount: " + list(frames));
    }
    if (scans.unlimited_count > 0) {
      note(std::to_string(scans.unlimited_count) + " scans name no limit of their range: " +
           text(ram_slam::LaserScan::kUnlimitedRangeM, 0) + " m is assumed");
    }
    if (scans.at_limit_count > 0) {
      note(std::to_string(scans.at_limit_count) + " readings at range_max (" +
           text(scans.limit_m, 2) + " m) mean that nothing came back");
    }
    plan_.no_return_m = scans.no_return.code_m();
    if (plan_.no_return_m) {
      note("readings of " + text(*plan_.no_return_m, 2) +
           " m and more mean that nothing came back");
    }
    if (scans.implausible_sweep_count > 0) planSweep(drive.period_s);
    if (options_.scan_clock_offset_s != 0.0)
      note("stamps of the scans shifted by " + text(options_.scan_clock_offset_s, 3) + " s");
  }

  /// scan_time if it fits the rate of the scans, else that rate, for the part of a turn that the
  /// beams cover.
  void planSweep(double period_s) {
    const RecordingSurvey::Scans& scans = survey_.scans;
    const bool fits = std::abs(scans.scan_time_s - period_s) < 0.2 * period_s;
    const double turn_s = fits ? scans.scan_time_s : period_s;
    const double share =
        std::abs(scans.increment_rad) * static_cast<double>(scans.beam_count) / (2.0 * M_PI);
    const double sweep_s = turn_s * std::min(share, 1.0);
    std::string line = std::to_string(scans.implausible_sweep_count) +
                       " scans have a time_increment that cannot be true (" +
                       text(scans.time_increment_s, 3) + " s): ";
    if (sweep_s > 0.0 && sweep_s <= 1.0) {
      plan_.sweep_s = sweep_s;
      line += "a sweep of " + text(sweep_s, 3) + " s is assumed from " +
              (fits ? "scan_time" : "the rate of the scans");
    } else {
      line += "all beams are taken as measured at once";
    }
    note(line);
  }

  const RecordingSurvey& survey_;
  const RecordingOptions& options_;
  RecordingPlan plan_;
  std::string odometry_topic_;  ///< empty: tf
  const RecordingSurvey::Odometry* odometry_ = nullptr;
  std::vector<std::int64_t> scan_times_;
  std::int64_t first_scan_ns_ = 0;
  std::int64_t last_scan_ns_ = 0;
};

}  // namespace

RecordingPlan plan(const RecordingSurvey& survey, const RecordingOptions& options) {
  return Planner(survey, options).make();
}

}  // namespace ramscout_bringup_ros
