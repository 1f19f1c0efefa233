// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/pose_graph/pose_graph.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/scan_matching/surface_scan.hpp"
#include "ram_slam/sensing/laser_scan.hpp"
#include "ram_slam/smoothing/joint_refinement.hpp"
#include "ram_slam/smoothing/key_scans.hpp"
#include "ram_slam/smoothing/loop_closer.hpp"
#include "ram_slam/smoothing/map_optimizer.hpp"

namespace ram_slam {

/// Settings of MapSmoother. Keys are those of config/map_smoother.yaml.
struct MapSmootherParameters {
  std::string map_frame = "map";  ///< what the node calls the frame of the corrected trajectory
  std::string base_frame = "base_link";  ///< and of the robot's base
  std::string initial_map;               ///< folder or file of a saved map to continue; empty: none
  double optimize_period_s = 5.0;  ///< least time between two optimizations, by stamps; 0: only
                                   ///< optimize() does it
  SurfaceParameters surfaces;
  ScanMatcherParameters matcher;
  KeyScanParameters key_scans;
  LoopCloserParameters loops;
  PoseGraphParameters graph;
  RefinementParameters refinement;

  /// A closure that moves the newest pose by more is solved for at once.
  double solve_distance_m = 0.1;
  double solve_angle_rad = 0.03;
  /// A smaller motion of the newest pose is no correction.
  double correction_distance_m = 0.03;
  double correction_angle_rad = 0.01;
  int max_sweeps = 2;               ///< of the search along the whole path, per optimization
  int max_published_poses = 20000;  ///< of smoothed_trajectory

  static const ram_parameters::ParameterTable<MapSmootherParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// \throws std::invalid_argument for an unknown key, a wrong type or a value out of bounds
MapSmootherParameters readMapSmootherParameters(ram_parameters::ParameterReader& reader);

/// Makes a trajectory agree with all scans that were taken along it.
///
/// Scans are given with the pose that some odometry or estimator has for them, whose frame may
/// drift. While they come, places are recognised and the trajectory is corrected roughly;
/// optimize() does the rest.
class MapSmoother {
public:
  /// \param matchers  of the features given by addFeatures(), by type; a type without one is
  ///   compared by geometry alone
  /// \throws std::invalid_argument as MapSmootherParameters::validate()
  explicit MapSmoother(const MapSmootherParameters& parameters,
                       const FeatureMatchers& matchers = {});

  /// \param odom_from_base  the given trajectory at the scan's stamp; the first one stays where it
  ///   is
  /// \return whether it is a key scan, the last of keyScans()
  /// \throws std::invalid_argument, the state untouched, if the scan cannot be used, a pose is not
  ///   finite or the stamp is not later than that of the scan before
  bool addScan(const LaserScan& scan, const Pose2& base_from_laser, const Pose2& odom_from_base);

  /// Before the first scan: continues a map made before. Its scans stay where they are; the robot
  /// is lost in it until startSession(). \throws as KeyScans::load()
  void load(const std::vector<PlacedScan>& scans) { key_scans_.load(scans); }
  /// As KeyScans::startSession().
  void startSession() { key_scans_.startSession(); }
  /// As KeyScans::addPossibleJump().
  void addPossibleJump(std::int64_t from_ns, std::int64_t until_ns) {
    key_scans_.addPossibleJump(from_ns, until_ns);
  }

  /// As JumpSearch::addFoundPlace().
  void addFoundPlace(std::int64_t stamp_ns, const Pose2& map_from_odom) {
    loops_.addFoundPlace(stamp_ns, map_from_odom);
  }

  /// Features of a scan, given before it or soon after, in the base frame at the scan's stamp;
  /// those of scans that are no key scans are left out.
  void addFeatures(const FeatureList& list);

  /// Solves the graph of all accepted closures and aligns all key scans with each other.
  void optimize();
  /// Once per optimize_period_s of the scans' stamps, unless that is 0: the same if places were
  /// recognised since.
  void optimizeIfDue();

  /// As KeyScans::trajectory().
  std::vector<StampedPose2> trajectory() const { return key_scans_.trajectory(); }

  /// Whether the trajectory has changed enough to be taken again: since takeCorrection() a closure
  /// has moved the newest pose beyond correction_distance_m or correction_angle_rad, or optimize()
  /// was called.
  bool hasCorrection() const { return has_correction_; }
  /// trajectory(), after which there is no correction until the next change.
  std::vector<StampedPose2> takeCorrection();

  const std::vector<LoopClosure>& closures() const { return loops_.closures(); }

  /// Takes a closure back, or a refusal; takes effect with the next optimize(). A refused closure
  /// is not found again. \throws std::out_of_range if there is no such closure
  void refuseClosure(std::size_t index) { loops_.refuse(index); }
  void acceptClosure(std::size_t index) { loops_.accept(index); }

  /// Poses of the base at the key scans, with the edges of motion and accepted closures.
  PoseGraph graph() const { return baseGraph(key_scans_, loops_); }

  const std::vector<KeyScan>& keyScans() const { return key_scans_.keys(); }

private:
  /// Solves for a new closure at once if it moves its later key scan far.
  void onClosure(std::size_t key, const Pose2& correction);
  /// Searches the whole path for loops that were missed.
  void sweepLoops();
  LoopCloser::ClosureHandler closureHandler();

  MapSmootherParameters parameters_;
  KeyScans key_scans_;
  LoopCloser loops_;
  MapOptimizer optimizer_;
  bool has_correction_ = false;
  std::size_t optimized_closures_ = 0;  ///< known when it was optimized last
  std::int64_t optimized_ns_ = 0;       ///< when that was done or found needless last
};

}  // namespace ram_slam
