// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/scan_matching/surface_scan.hpp"
#include "ram_slam/sensing/laser_scan.hpp"
#include "ram_slam/smoothing/constellation_memory.hpp"
#include "ram_slam/smoothing/joint_refinement.hpp"
#include "ram_slam/smoothing/key_scan.hpp"
#include "ram_slam/smoothing/loop_search.hpp"
#include "ram_slam/smoothing/pose_graph.hpp"

namespace ram_slam {

/// Settings of MapSmoother.
struct MapSmootherParameters {
  std::string map_frame = "map";  ///< what the node calls the frame of the corrected trajectory
  std::string base_frame = "base_link";  ///< and of the robot's base
  double optimize_period_s = 5.0;        ///< least time between two optimizations, by stamps
  SurfaceParameters surfaces;
  ScanMatcherParameters matcher;
  LoopSearchParameters loops;
  PoseGraphParameters graph;
  RefinementParameters refinement;
  double key_scan_distance_m = 0.3;     ///< a new key scan after so much motion
  double key_scan_angle_rad = 0.3;      ///< or so much turning
  double loop_search_distance_m = 1.0;  ///< path between two searches for loops
  /// After so much path without a closure places are recognised by their features, too, wherever
  /// drift has brought them; 0: never.
  double loop_constellation_path_m = 100.0;
  /// Standard deviation of the given motion between two key scans, where scans do not tell better.
  double motion_rest_deviation_m = 0.01;
  double motion_rest_deviation_rad = 0.01;
  double motion_deviation_m_per_m = 0.05;
  double motion_deviation_rad_per_m = 0.03;
  double motion_deviation_rad_per_rad = 0.05;
  /// Standard deviation of what two scans tell about the pose between them beyond what their noise
  /// explains (moving things, scans out of the plane): of successive key scans, and of a closed
  /// loop, where the views differ more.
  double match_deviation_m = 0.005;
  double match_deviation_rad = 0.003;
  double closure_deviation_m = 0.03;
  double closure_deviation_rad = 0.01;

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// \throws std::invalid_argument for an unknown key, a wrong type or a value out of bounds
MapSmootherParameters readMapSmootherParameters(ram_parameters::ParameterReader& reader);

/// What became of a loop closure.
enum class ClosureState {
  kAccepted,
  kOutvoted,  ///< the rest of the graph contradicts it
  kRefused,   ///< taken back by MapSmoother::refuseClosure()
};

/// A place that was recognised; the log of the smoother.
struct LoopClosure {
  std::int64_t old_stamp_ns = 0;
  std::int64_t new_stamp_ns = 0;
  PoseEdge edge;              ///< between laser poses of key scans
  double score = 0.0;         ///< of the dense search
  double inlier_ratio = 0.0;  ///< of the alignment
  double correction_m = 0.0;  ///< how far it moved the newest pose when it was found
  bool is_ambiguous = false;  ///< along a corridor; the edge then holds the other directions only
  ClosureState state = ClosureState::kAccepted;
};

/// Makes a trajectory agree with all scans that were taken along it.
///
/// Scans are given with the pose that some odometry or estimator has for them, whose frame may
/// drift. While they come, places are recognised and the trajectory is corrected roughly;
/// optimize() does the rest.
class MapSmoother {
public:
  /// \param matchers  of the features given by addFeatures(), by type; a type without one is
  /// compared by geometry alone
  /// \throws std::invalid_argument as MapSmootherParameters::validate()
  explicit MapSmoother(const MapSmootherParameters& parameters,
                       const FeatureMatchers& matchers = {});

  /// \param odom_from_base  the given trajectory at the scan's stamp; the first one stays where it
  /// is \throws std::invalid_argument, the state untouched, if the scan cannot be used, a pose is
  /// not finite or the stamp
  ///         is not later than that of the scan before
  void addScan(const LaserScan& scan, const Pose2& base_from_laser, const Pose2& odom_from_base);

  /// Features of a scan, given before it or soon after, in the base frame at the scan's stamp;
  /// those of scans that are no key scans are left out.
  void addFeatures(const FeatureList& list);

  /// Solves the graph of all accepted closures and aligns all key scans with each other.
  void optimize();
  /// Once per optimize_period_s of the scans' stamps: the same if places were recognised since.
  void optimizeIfDue();

  /// The corrected pose of the base at each scan's stamp.
  std::vector<StampedPose2> trajectory() const;

  /// Whether the trajectory has changed enough to be taken again: since takeCorrection() a closure
  /// has moved the newest pose by more than 3 cm or 0.01 rad, or optimize() was called.
  bool hasCorrection() const { return has_correction_; }
  /// trajectory(), after which there is no correction until the next change.
  std::vector<StampedPose2> takeCorrection();

  const std::vector<LoopClosure>& closures() const { return closures_; }

  /// Takes a closure back, or a refusal; takes effect with the next optimize(). A refused closure
  /// is not found again. \throws std::out_of_range if there is no such closure
  void refuseClosure(std::size_t index);
  void acceptClosure(std::size_t index);

  /// Poses of the base at the key scans, with the edges of motion and accepted closures.
  PoseGraph graph() const;

  const std::vector<KeyScan>& keyScans() const { return key_scans_; }

private:
  struct ScanRecord {
    std::int64_t stamp_ns = 0;
    std::size_t key = 0;  ///< the key scan at or before it
    Pose2 odom_from_base;
    /// What its own alignment adds to the pose that the key scans before and after give it.
    Pose2 shift = {};
  };

  /// A scan since the newest key scan that is aligned with it and the next one.
  struct BetweenScan {
    std::size_t record = 0;  ///< index into scans_
    SurfaceScan surfaces;
    Pose2 base_from_laser;
  };

  struct FailedSearch {
    std::size_t from = 0;
    std::size_t to = 0;
    Pose2 from_from_to;  ///< the centre of the window
    SearchWindow window;
  };

  bool isKeyScan(const Pose2& odom_from_base) const;
  bool isBetweenScan(const Pose2& odom_from_base) const;
  void addKeyScan(std::int64_t stamp_ns,
                  SurfaceScan surfaces,
                  const Pose2& base_from_laser,
                  const Pose2& odom_from_base);
  PoseEdge motionEdge(std::size_t to) const;
  /// Aligns the scans between the two newest key scans.
  void alignBetweenScans();
  /// Gives the scans between those aligned their shares of the shifts; there is none at either key
  /// scan.
  void shareShifts(std::int64_t from_ns, std::int64_t to_ns);
  /// Where the key scans before and after a scan put the base.
  Pose2 poseByKeyScans(const ScanRecord& scan) const;
  /// Some key scans before one, seen from the last of them.
  std::vector<ReferenceScan> scansBefore(std::size_t key) const;
  /// Looks for places that key scan `newest` shares with earlier ones, as if drifted by at most so
  /// much path.
  bool searchLoops(std::size_t newest, double max_path_m);
  /// The same for the place that the features of late recognise, if there is one.
  bool searchConstellation(std::size_t newest);
  /// Verifies a candidate and closes the loop.
  bool tryClosing(std::size_t candidate,
                  std::size_t newest,
                  const Pose2& map_from_laser_guess,
                  const SearchWindow& window);
  /// Gives the newest key scan its features if they are known.
  void useFeatures();
  /// Whether a closure between two key scans, or beside them, was accepted or refused already.
  bool isSettled(std::size_t from, std::size_t to) const;
  /// Whether a search that failed covers this one.
  bool wasSearched(std::size_t from, std::size_t to, double path_m) const;
  Pose2 relativePose(std::size_t from, std::size_t to) const;
  void sweepLoops();
  std::vector<double> pathsTo(std::size_t key) const;
  PoseGraph laserGraph() const;
  void solveGraph();

  MapSmootherParameters parameters_;
  std::vector<ScanRecord> scans_;
  std::vector<BetweenScan> between_scans_;
  std::vector<KeyScan> key_scans_;
  std::vector<Pose2> odom_from_laser_;  // as given, of key scans
  std::vector<PoseEdge> motion_;        // between successive key scans, with what their scans tell
  std::vector<LoopClosure> closures_;
  std::vector<FailedSearch> failed_searches_;
  double searched_path_m_ = 0.0;
  double closed_path_m_ = 0.0;  // of the newest key scan with a closure, or constellation search
  ConstellationMemory constellations_;
  std::deque<FeatureList> features_;  // of scans of late, in the order of their stamps
  bool has_correction_ = false;
  std::size_t optimized_closures_ = 0;  ///< known when it was optimized last
  std::int64_t optimized_ns_ = 0;       ///< when that was done or found needless last
};

}  // namespace ram_slam
