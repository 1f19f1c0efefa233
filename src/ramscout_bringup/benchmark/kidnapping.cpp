// SPDX-License-Identifier: BSD-3-Clause
#include "kidnapping.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <ram_slam/sensing/field_of_view.hpp>

namespace ramscout_bringup {
namespace {

using ram_slam::Pose2;

constexpr double kWrong_m = 0.5;
constexpr double kWrong_rad = 0.2;
constexpr double kSide_m = 0.3;
constexpr double kAway_m = 2.0;         // carried at least that far
constexpr double kAfterwards_m = 10.0;  // driven on after the recovery, to see whether it holds

bool isWrong(const Pose2& estimate, const Pose2& truth) {
  const Pose2 error = truth.inverse() * estimate;
  return error.translation().norm() > kWrong_m || std::abs(error.yaw_rad) > kWrong_rad;
}

}  // namespace

KidnappedRobot::KidnappedRobot(const std::string& config, int seed)
    : KidnappedRobot(config, readSlamParameters(config), seed) {}

KidnappedRobot::KidnappedRobot(const std::string& config,
                               const SlamParameters& parameters,
                               int seed)
    : tour_(ramscout_sim::readTour(config + "/worlds/office_tour.yaml")),
      robot_(ParameterFiles(config, kReferenceRobot),
             ramscout_sim::readWorld(config + "/worlds/office.yaml"),
             seed),
      odometry_(parameters.laser_odometry),
      detector_(parameters.feature_detector),
      kinematics_(parameters.kinematics),
      stage_(parameters.estimator, kinematics_, parameters.estimator_stage),
      random_(static_cast<std::uint64_t>(seed), 77) {}

Pose2 KidnappedRobot::placeInMap() const {
  const auto nearest = std::min_element(
      mapped_.begin(), mapped_.end(), [this](const MappedPose& a, const MappedPose& b) {
        return (a.truth.translation() - truth_.translation()).squaredNorm() <
               (b.truth.translation() - truth_.translation()).squaredNorm();
      });
  if (nearest == mapped_.end()) return truth_;
  return nearest->estimate * (nearest->truth.inverse() * truth_);
}

double KidnappedRobot::error_m() const {
  return (slam().estimate().pose.translation() - placeInMap().translation()).norm();
}

void KidnappedRobot::step(ramscout_sim::TourDriver& driver) {
  const SimulatedRobot::Reading reading = robot_.drive(driver);
  truth_ = reading.start_from_base;
  if (last_truth_) driven_m_ += (truth_.translation() - last_truth_->translation()).norm();
  last_truth_ = truth_;
  odometry_.addWheels({reading.scan.stamp_ns, reading.odom_from_base});
  odometry_.add({reading.scan, robot_.baseFromLaser()});
  while (const auto refined = odometry_.next()) estimate(*refined);
}

void KidnappedRobot::estimate(const ram_slam::OdometryStep& refined) {
  const ram_slam::LaserScan& scan = refined.scan.scan;
  kinematics_.add({scan.stamp_ns, refined.estimate.odom_from_base.pose});
  const auto motion = stage_.motionUntil(scan.stamp_ns);
  // Odometry that jumped is not used at once: this reading is lost, as in the node.
  if (!motion) return;
  stage_.update(detector_.detect(scan, refined.scan.base_from_laser), *motion,
                std::make_shared<const ram_slam::LaserView>(scan, refined.scan.base_from_laser));
}

double KidnappedRobot::map() {
  ramscout_sim::TourDriver driver(tour_);
  int lost_scans = 0;
  std::map<std::int64_t, Pose2> truths;
  while (driver.progress() < 1.0) {
    step(driver);
    lost_scans += slam().lost() ? 1 : 0;
    truths[slam().stamp_ns()] = truth_;
  }
  for (const ram_slam::StampedPose2& pose : slam().filter().trajectory()) {
    const auto when = truths.find(pose.stamp_ns);
    if (when != truths.end()) mapped_.push_back({when->second, pose.pose});
  }
  double sum = 0.0;
  for (const MappedPose& pose : mapped_)
    sum += (pose.truth.translation() - pose.estimate.translation()).squaredNorm();
  mapping_error_m_ = std::sqrt(sum / static_cast<double>(mapped_.size()));
  return lost_scans / robot_.scanRate_hz();
}

ramscout_sim::Tour KidnappedRobot::tourFrom(double way_m, double side_m, bool back) const {
  std::vector<Eigen::Vector2d> points_m = tour_.waypoints_m;
  if (back) std::reverse(points_m.begin(), points_m.end());
  std::size_t next = 1;
  while (next + 1 < points_m.size() && way_m > (points_m[next] - points_m[next - 1]).norm()) {
    way_m -= (points_m[next] - points_m[next - 1]).norm();
    ++next;
  }
  const Eigen::Vector2d along = (points_m[next] - points_m[next - 1]).normalized();
  ramscout_sim::Tour tour = tour_;
  tour.waypoints_m = {points_m[next - 1] + way_m * along +
                      side_m * Eigen::Vector2d(-along.y(), along.x())};
  for (std::size_t i = next; i < points_m.size(); ++i) tour.waypoints_m.push_back(points_m[i]);
  // The way back at the end, so that it is long enough wherever it begins.
  for (auto point = points_m.rbegin() + 1; point != points_m.rend(); ++point)
    tour.waypoints_m.push_back(*point);
  return tour;
}

std::string KidnappedRobot::mapBytes() const {
  std::string bytes;
  const auto append = [&bytes](const double* values, std::size_t count) {
    bytes.append(reinterpret_cast<const char*>(values), count * sizeof(double));
  };
  slam().filter().best().landmarks.forEach(
      [&](ram_slam::LandmarkId, const ram_slam::Landmark& landmark) {
        append(landmark.mean_m.data(), 2);
        append(landmark.covariance_m2.data(), 4);
      });
  for (const ram_slam::LandmarkRecord& record : slam().filter().registry().records())
    append(&record.existence_log_odds, 1);
  return bytes;
}

Kidnapping KidnappedRobot::kidnap(double most_m) {
  ramscout_sim::Tour tour;
  const Eigen::Vector2d here_m = robot_.position_m();
  do {
    const double way_m = random_.uniform() * (tour_.length_m() - 1.0);
    const double side_m = kSide_m * (2.0 * random_.uniform() - 1.0);
    tour = tourFrom(way_m, side_m, random_.uniform() < 0.5);
  } while ((tour.waypoints_m.front() - here_m).norm() < kAway_m);
  const double yaw_rad = (2.0 * random_.uniform() - 1.0) * M_PI;
  const Eigen::Vector2d& place_m = tour.waypoints_m.front();

  ramscout_sim::TourDriver driver(tour);
  Kidnapping result;
  robot_.carryTo({place_m.x(), place_m.y(), yaw_rad});
  last_truth_.reset();
  result.truth = robot_.startFromWorld({place_m.x(), place_m.y(), yaw_rad});
  const auto start_ns = robot_.now_ns();
  const double start_m = driven_m_;
  std::string lost_map;
  double wrong_s = 0.0;
  bool held = false;
  result.map_untouched = true;
  while (driven_m_ - start_m < most_m + kAfterwards_m) {
    step(driver);
    const double since_s = static_cast<double>(robot_.now_ns() - start_ns) * 1e-9;
    const bool wrong = !slam().lost() && isWrong(slam().estimate().pose, placeInMap());
    if (slam().lost()) {
      if (result.lost_after_s < 0.0) {
        result.lost_after_s = since_s;
        lost_map = mapBytes();
      }
      result.map_untouched = result.map_untouched && mapBytes() == lost_map;
      held = false;
    }
    wrong_s = wrong && result.lost_after_s >= 0.0 ? wrong_s + 1.0 / robot_.scanRate_hz() : 0.0;
    result.longest_wrong_s = std::max(result.longest_wrong_s, wrong_s);
    if (slam().lost() || wrong) {
      result.recovered_after_m = -1.0;
      held = false;
    } else if (!held) {
      held = true;
      result.recovered_after_m = driven_m_ - start_m;
      result.error_m = error_m();
    }
    if (held && driven_m_ - start_m > result.recovered_after_m + kAfterwards_m) break;
  }
  return result;
}

}  // namespace ramscout_bringup
