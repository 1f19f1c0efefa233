// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/evaluation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <Eigen/Core>

#include "ram_slam/geometry/median.hpp"
#include "ramscout_bringup/text_file.hpp"
#include "ramscout_bringup/words.hpp"

namespace ramscout_bringup {
namespace {

using ram_slam::Pose2;
using ram_slam::StampedPose2;
using ram_slam::wrapAngle;

double seconds(std::int64_t duration_ns) {
  return static_cast<double>(duration_ns) * 1e-9;
}

/// The first pose not before the stamp, or the end.
Trajectory::const_iterator notBefore(const Trajectory& trajectory, std::int64_t stamp_ns) {
  return std::lower_bound(
      trajectory.begin(), trajectory.end(), stamp_ns,
      [](const StampedPose2& pose, std::int64_t t) { return pose.stamp_ns < t; });
}

const StampedPose2& nearest(const Trajectory& trajectory, std::int64_t stamp_ns) {
  const auto after = notBefore(trajectory, stamp_ns);
  if (after == trajectory.begin()) return *after;
  const auto before = std::prev(after);
  if (after == trajectory.end()) return *before;
  return after->stamp_ns - stamp_ns < stamp_ns - before->stamp_ns ? *after : *before;
}

/// The truth is interpolated over no longer step than this: motion capture loses its target at
/// times. Ten times the median step, and at least 1 s.
std::int64_t longestStep_ns(const Trajectory& truth) {
  constexpr std::int64_t kLeastNs = 1'000'000'000;
  std::vector<std::int64_t> steps_ns;
  for (std::size_t i = 1; i < truth.size(); ++i)
    steps_ns.push_back(truth[i].stamp_ns - truth[i - 1].stamp_ns);
  if (steps_ns.empty()) return kLeastNs;
  return std::max(kLeastNs, 10 * ram_slam::median(std::move(steps_ns)));
}

/// The truth at the estimate's stamps, for those that it spans.
struct PosePair {
  std::int64_t stamp_ns;
  Pose2 estimate;
  Pose2 truth;
};
std::vector<PosePair> pairs(const Trajectory& estimate, const Trajectory& truth) {
  const std::int64_t longest_step_ns = longestStep_ns(truth);
  std::vector<PosePair> result;
  for (const StampedPose2& pose : estimate) {
    const auto after = notBefore(truth, pose.stamp_ns);
    if (after == truth.end()) continue;
    if (after->stamp_ns == pose.stamp_ns) {
      result.push_back({pose.stamp_ns, pose.pose, after->pose});
    } else if (after != truth.begin()) {
      const auto before = std::prev(after);
      if (after->stamp_ns - before->stamp_ns > longest_step_ns) continue;
      const double fraction = static_cast<double>(pose.stamp_ns - before->stamp_ns) /
                              static_cast<double>(after->stamp_ns - before->stamp_ns);
      result.push_back(
          {pose.stamp_ns, pose.pose, interpolate(before->pose, after->pose, fraction)});
    }
  }
  return result;
}

Pose2 alignment(const std::vector<PosePair>& pairs) {
  Eigen::Vector2d mean_estimate = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_truth = Eigen::Vector2d::Zero();
  const auto n = static_cast<double>(pairs.size());
  for (const PosePair& pair : pairs) {
    mean_estimate += pair.estimate.translation() / n;
    mean_truth += pair.truth.translation() / n;
  }
  double dot = 0.0;
  double cross = 0.0;
  for (const PosePair& pair : pairs) {
    const Eigen::Vector2d a = pair.estimate.translation() - mean_estimate;
    const Eigen::Vector2d b = pair.truth.translation() - mean_truth;
    dot += a.dot(b);
    cross += a.x() * b.y() - a.y() * b.x();
  }
  Pose2 truth_from_map{0.0, 0.0, std::atan2(cross, dot)};
  const Eigen::Vector2d translation = mean_truth - truth_from_map * mean_estimate;
  truth_from_map.x_m = translation.x();
  truth_from_map.y_m = translation.y();
  return truth_from_map;
}

/// Error of each motion from a pose to the first one for which `far_enough(from, to)` holds.
template <typename FarEnough>
RelativeError relativeError(const std::vector<PosePair>& pairs,
                            std::string interval,
                            const FarEnough& far_enough) {
  std::vector<double> position_m;
  std::vector<double> yaw_rad;
  for (std::size_t from = 0, to = 0; from < pairs.size(); ++from) {
    to = std::max(to, from);
    while (to < pairs.size() && !far_enough(from, to)) ++to;
    if (to == pairs.size()) break;
    const Pose2 estimated = pairs[from].estimate.inverse() * pairs[to].estimate;
    const Pose2 actual = pairs[from].truth.inverse() * pairs[to].truth;
    position_m.push_back((estimated.translation() - actual.translation()).norm());
    yaw_rad.push_back(std::abs(wrapAngle(estimated.yaw_rad - actual.yaw_rad)));
  }
  return {std::move(interval), statisticsOf(std::move(position_m)),
          statisticsOf(std::move(yaw_rad))};
}

std::string label(double value, const char* unit) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text + " " + unit;
}

/// Gathers the errors of relations.
class RelationErrorList {
public:
  void add(const Pose2& estimated, const Pose2& reference) {
    position_m_.push_back((estimated.translation() - reference.translation()).norm());
    position_cartographer_m_.push_back((estimated * reference.inverse()).translation().norm());
    yaw_rad_.push_back(std::abs(wrapAngle(estimated.yaw_rad - reference.yaw_rad)));
  }
  RelationErrors statistics() const {
    return {statisticsOf(position_m_), statisticsOf(position_cartographer_m_),
            statisticsOf(yaw_rad_)};
  }

private:
  std::vector<double> position_m_;
  std::vector<double> position_cartographer_m_;
  std::vector<double> yaw_rad_;
};

}  // namespace

ErrorStatistics statisticsOf(std::vector<double> errors) {
  ErrorStatistics statistics;
  statistics.count = errors.size();
  if (errors.empty()) return statistics;
  const auto n = static_cast<double>(errors.size());
  statistics.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
  double squares = 0.0;
  double deviations = 0.0;
  for (const double error : errors) {
    squares += error * error;
    deviations += (error - statistics.mean) * (error - statistics.mean);
  }
  statistics.rms = std::sqrt(squares / n);
  statistics.standard_deviation = errors.size() > 1 ? std::sqrt(deviations / (n - 1.0)) : 0.0;
  std::sort(errors.begin(), errors.end());
  statistics.median = errors[errors.size() / 2];
  statistics.max = errors.back();
  return statistics;
}

TruthComparison compareWithTruth(const Trajectory& estimate, const Trajectory& truth) {
  const std::vector<PosePair> common = pairs(estimate, truth);
  if (common.size() < 2) {
    throw std::invalid_argument("the trajectory and the truth have " +
                                std::to_string(common.size()) +
                                " stamps in common, wanted at least 2");
  }
  TruthComparison comparison;
  comparison.without_truth_count = estimate.size() - common.size();
  comparison.truth_from_map = alignment(common);
  std::vector<double> position_m;
  std::vector<double> yaw_rad;
  for (const PosePair& pair : common) {
    const Pose2 aligned = comparison.truth_from_map * pair.estimate;
    position_m.push_back((aligned.translation() - pair.truth.translation()).norm());
    yaw_rad.push_back(std::abs(wrapAngle(aligned.yaw_rad - pair.truth.yaw_rad)));
  }
  comparison.position_m = statisticsOf(std::move(position_m));
  comparison.yaw_rad = statisticsOf(std::move(yaw_rad));
  return comparison;
}

Trajectory truthInMap(const Trajectory& estimate, Trajectory truth) {
  try {
    const Pose2 map_from_truth = compareWithTruth(estimate, truth).truth_from_map.inverse();
    for (StampedPose2& pose : truth) pose.pose = map_from_truth * pose.pose;
  } catch (const std::invalid_argument&) {
    truth.clear();
  }
  return truth;
}

std::vector<RelativeError> relativeErrors(const Trajectory& estimate,
                                          const Trajectory& truth,
                                          const std::vector<double>& lengths_m,
                                          const std::vector<double>& durations_s) {
  const std::vector<PosePair> common = pairs(estimate, truth);
  std::vector<double> driven_m(common.size(), 0.0);
  for (std::size_t i = 1; i < common.size(); ++i) {
    driven_m[i] = driven_m[i - 1] +
                  (common[i].truth.translation() - common[i - 1].truth.translation()).norm();
  }
  std::vector<RelativeError> rows;
  for (const double length_m : lengths_m) {
    rows.push_back(
        relativeError(common, label(length_m, "m"), [&](std::size_t from, std::size_t to) {
          return driven_m[to] - driven_m[from] >= length_m;
        }));
  }
  for (const double duration_s : durations_s) {
    rows.push_back(
        relativeError(common, label(duration_s, "s"), [&](std::size_t from, std::size_t to) {
          return seconds(common[to].stamp_ns - common[from].stamp_ns) >= duration_s;
        }));
  }
  return rows;
}

std::vector<Relation> readRelations(const std::string& path) {
  TextFile file(path);
  std::vector<Relation> relations;
  for (int number = 1; const auto line = file.nextLine(); ++number) {
    const std::string_view content = line->substr(0, line->find('#'));
    if (content.find_first_not_of(" \t") == std::string_view::npos) continue;
    Words words(content);
    Relation relation;
    relation.first_ns = words.stampNs();
    relation.second_ns = words.stampNs();
    std::array<double, 6> v{};  // x y z roll pitch yaw
    for (double& value : v) value = words.number<double>();
    relation.first_from_second = {v[0], v[1], v[5]};
    if (!words.good() || !relation.first_from_second.isFinite()) {
      throw std::runtime_error(path + ":" + std::to_string(number) +
                               ": wanted 't1 t2 x y z roll pitch yaw'");
    }
    relations.push_back(relation);
  }
  if (relations.empty()) throw std::runtime_error(path + " has no relation");
  return relations;
}

double pathLength(const Trajectory& trajectory) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    length_m += (trajectory[i].pose.translation() - trajectory[i - 1].pose.translation()).norm();
  }
  return length_m;
}

RelationComparison compareWithRelations(const Trajectory& estimate,
                                        const std::vector<Relation>& relations,
                                        const Trajectory& odometry,
                                        const RelationLimits& limits) {
  if (estimate.empty()) throw std::invalid_argument("the trajectory has no pose");
  if (relations.empty()) throw std::invalid_argument("there is no relation");
  RelationComparison comparison;
  const auto poseAt = [&](std::int64_t stamp_ns) {
    const StampedPose2& pose = nearest(estimate, stamp_ns);
    const double gap_s = std::abs(seconds(pose.stamp_ns - stamp_ns));
    comparison.max_stamp_gap_s = std::max(comparison.max_stamp_gap_s, gap_s);
    if (gap_s <= limits.max_stamp_gap_s) return pose.pose;
    ++comparison.far_count;
    if (odometry.empty()) return pose.pose;
    ++comparison.moved_count;
    return pose.pose *
           (nearest(odometry, pose.stamp_ns).pose.inverse() * nearest(odometry, stamp_ns).pose);
  };
  RelationErrorList all;
  RelationErrorList distant;
  for (const Relation& relation : relations) {
    const Pose2 estimated = poseAt(relation.first_ns).inverse() * poseAt(relation.second_ns);
    all.add(estimated, relation.first_from_second);
    if (std::abs(seconds(relation.second_ns - relation.first_ns)) > limits.distant_s) {
      distant.add(estimated, relation.first_from_second);
    }
  }
  comparison.all = all.statistics();
  comparison.distant = distant.statistics();
  return comparison;
}

}  // namespace ramscout_bringup
