// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "ram_slam/stages/drop_counter.hpp"
#include "ram_slam/stages/estimator_stage.hpp"
#include "ram_slam/stages/mapping_stage.hpp"
#include "ram_slam/stages/odometry_stage.hpp"
#include "ram_slam/stages/smoothing_stage.hpp"
#include "ramscout_bringup/measurement.hpp"
#include "ramscout_bringup/results.hpp"

namespace ramscout_bringup {

/// What stages dropped, as a list with reason, count, stamps of the first and the last one [s] and
/// what exactly was wrong with the last one.
nlohmann::ordered_json toJson(const ram_slam::DropCounter& drops);

/// When and why an estimator does not know its place, loss by loss.
class LossRecord {
public:
  /// After each reading.
  /// \param state  why, in plain English; used at the first reading of a loss
  void add(std::int64_t stamp_ns, bool is_lost, const std::string& state);

  std::size_t count() const { return losses_.size(); }
  /// A list with reason, from_s and to_s; to_s is null while the place is not found again.
  nlohmann::ordered_json toJson() const;

private:
  struct Loss {
    std::string reason;
    std::int64_t from_ns;
    std::optional<std::int64_t> to_ns;
  };
  std::vector<Loss> losses_;
};

/// The smoother's closures, those that were taken back by hand left out.
std::vector<ClosureRecord> closureRecords(const ram_slam::MapSmoother& smoother);

/// Collects during a run what its summary.json and its report state at the end.
class RunReport {
public:
  /// Where the run stands at its end.
  struct Run {
    const ram_slam::OdometryStage& odometry;
    const ram_slam::EstimatorStage& estimator;
    const ram_slam::SmoothingStage& smoothing;
    const ram_slam::MappingStage& mapping;
    const Results& results;
    bool uses_laser_odometry;
    bool smooths;
  };

  void addWheels(const ram_slam::StampedPose2& odom_from_base);
  /// A scan with its odometry.
  /// \param is_refined  by the scan
  void addStep(const ram_slam::OdometryStep& step, bool is_refined);
  /// After a reading that the estimator was given.
  void addReading(const ram_slam::FeatureList& features, const ram_slam::Estimator& estimator);

  nlohmann::ordered_json summary(const Run& run) const;
  /// Those that have a sample.
  std::vector<Measurement> measurements() const;
  /// odom_from_base as the wheels have it, at most 50 poses per second.
  const Trajectory& wheels() const { return wheels_; }

private:
  /// The laser's mount, the wheels' scale and the offset between their stamps, as far as the drive
  /// shows them; null if it does not.
  nlohmann::ordered_json calibration(const Run& run) const;

  Trajectory wheels_;  ///< thinned
  std::size_t feature_count_ = 0;
  std::size_t list_count_ = 0;
  LossRecord losses_;
  RateCounter wheel_rate_;
  RateCounter scan_rate_;
  Measurement inliers_{
      "scan points on known walls", "%",
      "Low: the scan does not show what those before it did (people, glass, a jump)."};
  Measurement features_{"features per scan", "",
                        "Of the detector. Without features the estimator follows the odometry."};
  Measurement deviation_{"uncertainty of the position", "m",
                         "Standard deviation that the estimator states, along its longer axis."};
};

}  // namespace ramscout_bringup
