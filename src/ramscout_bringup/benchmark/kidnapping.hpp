// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <ram_slam/estimation/tracked_estimator.hpp>

#include "ramscout_bringup/slam_pipeline.hpp"

#include "simulated_robot.hpp"

namespace ramscout_bringup {

/// What came of carrying the robot away once.
struct Kidnapping {
  ram_slam::Pose2 truth;            ///< where it was put down, in the map
  double lost_after_s = -1.0;       ///< < 0: never noticed
  double recovered_after_m = -1.0;  ///< way driven until it was found for good; < 0: not at all
  double error_m = 0.0;             ///< of the place, when it was found for good
  double longest_wrong_s = 0.0;     ///< longest time of a wrong place taken for right, afterwards
  bool map_untouched = false;       ///< at no time between, and set back to before
};

/// A robot with the whole estimator in one process, in a simulated building: it maps the building
/// on a tour, and then is carried away to random places of the tour, again and again.
class KidnappedRobot {
public:
  /// \param config  the folder with the nodes' parameter files
  KidnappedRobot(const std::string& config, int seed);

  /// Drives the tour once. \return seconds of it that the robot took itself for lost
  double map();
  /// Puts the robot down at a random place of the tour and lets it drive on for up to `most_m`.
  Kidnapping kidnap(double most_m);

  std::size_t landmarkCount() const { return slam().filter().landmarks().landmarks.size(); }
  /// Root mean square error of the mapping tour's trajectory.
  double mappingError_m() const { return mapping_error_m_; }
  /// Distance of the estimate and where the robot is in its map.
  double error_m() const;

private:
  KidnappedRobot(const std::string& config, const SlamParameters& parameters, int seed);

  struct MappedPose {
    ram_slam::Pose2 truth;
    ram_slam::Pose2 estimate;
  };

  /// Advances to the next scan, driving the tour.
  void step(ramscout_sim::TourDriver& driver);
  void estimate(const ram_slam::OdometryStep& refined);
  const ram_slam::Tracker& slam() const {
    return static_cast<const ram_slam::TrackedEstimator&>(stage_.estimator()).slam();
  }
  ramscout_sim::Tour tourFrom(double way_m, double side_m, bool back) const;
  /// Where the robot is in a map that is bent a little: from the nearest place of the mapping tour.
  ram_slam::Pose2 placeInMap() const;
  std::string mapBytes() const;

  ramscout_sim::Tour tour_;
  SimulatedRobot robot_;
  ram_slam::OdometryStage odometry_;
  ramscout_feature_detector::FeatureDetector detector_;
  ramscout_kinematics::Kinematics kinematics_;
  ram_slam::EstimatorStage stage_;
  ram_slam::Random random_;
  ram_slam::Pose2 truth_;  ///< in the frame of the start
  std::optional<ram_slam::Pose2> last_truth_;
  double driven_m_ = 0.0;
  std::vector<MappedPose> mapped_;
  double mapping_error_m_ = 0.0;
};

}  // namespace ramscout_bringup
