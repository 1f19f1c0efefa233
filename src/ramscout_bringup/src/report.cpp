// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/report.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>

#include "ramscout_bringup/evaluation.hpp"
#include "ramscout_bringup/findings.hpp"
#include "ramscout_bringup/picture.hpp"

#include "report_page.hpp"

namespace ramscout_bringup {
namespace {

using nlohmann::ordered_json;
using ram_slam::Pose2;
using ram_slam::StampedPose2;

double rounded(double value, double step) {
  return std::isfinite(value) ? std::round(value / step) * step : 0.0;
}

/// As a JSON number of few digits; null if it is not finite.
ordered_json brief(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == 0.0) return 0;
  const double scale = std::pow(10.0, 3.0 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

std::string toBase64(const std::string& bytes) {
  namespace iterators = boost::archive::iterators;
  using Encoder =
      iterators::base64_from_binary<iterators::transform_width<std::string::const_iterator, 6, 8>>;
  std::string text(Encoder(bytes.begin()), Encoder(bytes.end()));
  text.append((3 - bytes.size() % 3) % 3, '=');
  return text;
}

/// The same with shorter texts and lists.
ordered_json bounded(ordered_json value, const ReportLimits& limits) {
  if (value.is_string()) {
    std::string text = value.get<std::string>();
    if (text.size() > limits.max_text) text = text.substr(0, limits.max_text) + " ...";
    return text;
  }
  if (value.is_array() && value.size() > limits.max_list)
    value.erase(value.begin() + static_cast<std::ptrdiff_t>(limits.max_list), value.end());
  if (value.is_structured()) {
    for (ordered_json& element : value) element = bounded(std::move(element), limits);
  }
  return value;
}

/// Points at least `step_m` apart, and the last one.
Trajectory thinned(const Trajectory& path, double step_m) {
  Trajectory points;
  for (const StampedPose2& pose : path) {
    if (points.empty() ||
        (pose.pose.translation() - points.back().pose.translation()).norm() >= step_m)
      points.push_back(pose);
  }
  if (!points.empty()) points.back() = path.back();
  return points;
}

/// Assembles the data of one run.
class Report {
public:
  Report(const Results& results, const ReportLimits& limits)
      : results_(results),
        limits_(limits),
        truth_(truthInMap(results.trajectory, results.ground_truth)) {
    const Trajectory& poses =
        results.trajectory_online.empty() ? results.trajectory : results.trajectory_online;
    if (poses.empty()) return;
    begin_ns_ = poses.front().stamp_ns;
    end_ns_ = poses.back().stamp_ns;
  }

  ordered_json data() const {
    const std::vector<Finding> findings = findingsOf(results_);
    ordered_json list = ordered_json::array();
    for (const Finding& finding : findings)
      list.push_back(
          {{"level", toText(finding.level)}, {"text", finding.text}, {"advice", finding.advice}});
    ordered_json data = bounded({{"version", kVersion},
                                 {"begin_s", 1e-9 * static_cast<double>(begin_ns_)},
                                 {"duration_s", since(end_ns_)},
                                 {"about", results_.about},
                                 {"verdict", toText(worstOf(findings))},
                                 {"findings", list},
                                 {"errors", errors()},
                                 {"parameters", parameters()},
                                 {"landmark_count", results_.landmarks.size()},
                                 {"closure_count", results_.closures.size()},
                                 {"summary", results_.summary}},
                                limits_);
    data["map"] = map();
    data["paths"] = paths();
    data["landmarks"] = landmarks();
    data["closures"] = closures();
    data["charts"] = charts();
    return data;
  }

private:
  double since(std::int64_t stamp_ns) const {
    return rounded(1e-9 * static_cast<double>(stamp_ns - begin_ns_), 1e-3);
  }

  ordered_json map() const {
    const MapImage image =
        drawMapImage(results_.map, limits_.max_map_bytes, limits_.max_map_edge_px);
    if (image.png.empty()) return nullptr;
    return {{"png", toBase64(image.png)},
            {"resolution_m", image.resolution_m},
            {"x_m", image.map_from_image.x_m},
            {"y_m", image.map_from_image.y_m},
            {"yaw_rad", image.map_from_image.yaw_rad}};
  }

  /// x [cm], y [cm], time [ms] of each point, one after the other.
  ordered_json path(const char* name, const Trajectory& poses) const {
    double step_m = limits_.path_step_m;
    Trajectory points = thinned(poses, step_m);
    while (points.size() > limits_.max_path_points) points = thinned(points, step_m *= 1.5);
    ordered_json numbers = ordered_json::array();
    for (const StampedPose2& point : points) {
      numbers.push_back(std::llround(100.0 * point.pose.x_m));
      numbers.push_back(std::llround(100.0 * point.pose.y_m));
      numbers.push_back((point.stamp_ns - begin_ns_) / 1'000'000);
    }
    return {{"name", name}, {"points", numbers}};
  }

  ordered_json paths() const {
    ordered_json list = ordered_json::array();
    const auto add = [&](const char* name, const Trajectory& poses) {
      if (poses.size() > 1) list.push_back(path(name, poses));
    };
    add("odometry", odometryInMap());
    add("true", truth_);
    add("online", results_.trajectory_online);
    add("final", results_.trajectory);
    return list;
  }

  /// Beginning where the final path does.
  Trajectory odometryInMap() const {
    Trajectory odometry = results_.odometry;
    if (odometry.empty() || results_.trajectory.empty()) return {};
    const StampedPose2& first = results_.trajectory.front();
    const Pose2 odom_from_base =
        ram_slam::poseAt(odometry, first.stamp_ns).value_or(odometry.front().pose);
    const Pose2 map_from_odom = first.pose * odom_from_base.inverse();
    for (StampedPose2& pose : odometry) pose.pose = map_from_odom * pose.pose;
    return odometry;
  }

  ordered_json landmarks() const {
    ordered_json list = ordered_json::array();
    for (const MapLandmark& landmark : results_.landmarks) {
      if (list.size() == limits_.max_landmarks) break;
      const Eigen::Matrix2d& c = landmark.covariance_m2;
      list.push_back({landmark.id, landmark.type.substr(0, limits_.max_text),
                      brief(landmark.position_m.x()), brief(landmark.position_m.y()),
                      brief(c(0, 0)), brief(c(0, 1)), brief(c(1, 1))});
    }
    return list;
  }

  ordered_json closures() const {
    ordered_json list = ordered_json::array();
    for (const ClosureRecord& closure : results_.closures) {
      if (list.size() == limits_.max_closures) break;
      const auto older = ram_slam::poseAt(results_.trajectory, closure.old_stamp_ns);
      const auto newer = ram_slam::poseAt(results_.trajectory, closure.new_stamp_ns);
      if (!older || !newer) continue;
      list.push_back({{"from", {brief(older->x_m), brief(older->y_m), since(closure.old_stamp_ns)}},
                      {"to", {brief(newer->x_m), brief(newer->y_m), since(closure.new_stamp_ns)}},
                      {"score", brief(closure.score)},
                      {"inliers", brief(closure.inlier_ratio)},
                      {"correction_m", brief(closure.correction_m)},
                      {"accepted", closure.is_accepted}});
    }
    return list;
  }

  ordered_json charts() const {
    ordered_json list = ordered_json::array();
    std::vector<Measurement> all = results_.measurements;
    all.push_back({"correction afterwards", "m",
                   "Distance of the pose as it was known then from the final one.",
                   distances(results_.trajectory_online, results_.trajectory)});
    all.push_back({"error of the final path", "m", "Distance from the true path.",
                   distances(results_.trajectory, truth_)});
    for (const Measurement& measurement : all) {
      ordered_json ranges = ordered_json::array();
      for (const auto& range : rangesOf(measurement, begin_ns_, end_ns_, limits_.chart_intervals))
        ranges.push_back(
            {brief(range.middle_s), brief(range.least), brief(range.mean), brief(range.greatest)});
      if (ranges.size() < 2) continue;
      list.push_back({{"name", measurement.name},
                      {"unit", measurement.unit},
                      {"meaning", measurement.meaning},
                      {"ranges", ranges}});
    }
    return list;
  }

  /// Of each pose from the other path at the same stamp.
  static std::vector<Sample> distances(const Trajectory& poses, const Trajectory& others) {
    std::vector<Sample> samples;
    for (const StampedPose2& pose : poses) {
      const auto other = ram_slam::poseAt(others, pose.stamp_ns);
      if (!other) continue;
      samples.push_back({pose.stamp_ns, (pose.pose.translation() - other->translation()).norm()});
    }
    return samples;
  }

  ordered_json errors() const {
    ordered_json list = ordered_json::array();
    const auto add = [&](const char* name, const Trajectory& poses) {
      if (truth_.empty() || poses.empty()) return;
      try {
        const TruthComparison error = compareWithTruth(poses, results_.ground_truth);
        list.push_back({{"path", name},
                        {"poses", error.position_m.count},
                        {"rms_m", brief(error.position_m.rms)},
                        {"median_m", brief(error.position_m.median)},
                        {"max_m", brief(error.position_m.max)},
                        {"yaw_rms_rad", brief(error.yaw_rad.rms)}});
      } catch (const std::invalid_argument&) {
        return;  // nothing in common
      }
    };
    add("final", results_.trajectory);
    add("online", results_.trajectory_online);
    add("odometry", results_.odometry);
    return list;
  }

  ordered_json parameters() const {
    ordered_json list = ordered_json::array();
    for (const ChangedParameter& parameter : results_.changed_parameters) {
      list.push_back({{"file", parameter.file},
                      {"key", parameter.key},
                      {"value", parameter.value},
                      {"default", parameter.default_value},
                      {"unit", parameter.unit}});
    }
    return list;
  }

  const Results& results_;
  ReportLimits limits_;
  Trajectory truth_;  ///< in the map frame; empty if unknown
  std::int64_t begin_ns_ = 0;
  std::int64_t end_ns_ = 0;
};

/// For a script element, which ends at the first `</`; bytes that are not UTF-8 are replaced.
std::string toScriptText(const ordered_json& data) {
  const std::string json = data.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace

ordered_json reportData(const Results& results, const ReportLimits& limits) {
  return Report(results, limits).data();
}

std::string toHtml(const Results& results, const ReportLimits& limits) {
  const std::string mark = "REPORT_DATA";
  std::string page = kReportPage;
  page.replace(page.find(mark), mark.size(), toScriptText(reportData(results, limits)));
  return page;
}

}  // namespace ramscout_bringup
