// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/motion/motion_noise.hpp"
#include "ram_slam/pose_graph/pose_graph.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/scan_matching/surface_scan.hpp"
#include "ram_slam/sensing/laser_scan.hpp"
#include "ram_slam/sensing/placed_scan.hpp"
#include "ram_slam/smoothing/key_scan.hpp"
#include "ram_slam/smoothing/near_views.hpp"

namespace ram_slam {

/// Settings of KeyScans. Keys are those of config/map_smoother.yaml.
struct KeyScanParameters {
  double distance_m = 0.3;  ///< a new key scan after so much motion
  double angle_rad = 0.3;   ///< or so much turning
  /// Of the given motion between two key scans, where the scans do not measure it better.
  MotionNoise motion_noise;
  /// Standard deviation of the alignment of successive key scans beyond what the noise of their
  /// readings explains: moving things, scans out of the plane.
  double match_deviation_m = 0.005;
  double match_deviation_rad = 0.003;

  /// The robot may have been carried to a key scan if scans are missing before it for so long, or
  /// if fewer points of it, and of so many after it, meet a surface of those before. Two unrelated
  /// rooms share less, by chance.
  double jump_gap_s = 10.0;
  double jump_inlier_ratio = 0.3;
  int jump_key_scans = 3;
  /// Standard deviation of the motion if it was.
  double jump_deviation_m = 100.0;
  double jump_deviation_rad = 3.0;

  /// Standard deviation of the place where a lost robot was found, and the path that drifts as
  /// much.
  double start_deviation_m = 0.3;
  double start_deviation_rad = 0.1;
  double start_path_m = 10.0;

  double view_range_m = 8.0;    ///< points farther away do not count for the view centre
  double path_m_per_rad = 0.5;  ///< turning counts as path: odometry drifts by it, too
  int farthest_reference = 4;   ///< a new key scan is aligned with those 1, 2, 4, .. this back
  /// Weight of this alignment against the one with earlier passages: the key scans before are not
  /// exactly in their places, either.
  double motion_weight = 0.2;
  /// Of the scans between two key scans those are aligned, too, that are so far from each other.
  double between_distance_m = 0.05;
  double between_angle_rad = 0.05;
  int between_reference_count = 3;  ///< newest key scans that those are aligned with
  double rest_s = 1.0;              ///< the end of a longer rest is in the trajectory, too
  bool pose_per_scan = false;       ///< trajectory() has a pose for each scan

  static const ram_parameters::ParameterTable<KeyScanParameters>& table();
};

/// The scans of a run: which of them are kept as key scans, how these are aligned with each other,
/// and where all other scans are, relative to the key scans before and after them.
class KeyScans {
public:
  /// \param min_inlier_ratio  share of a scan's points that must find a partner in a key scan for
  ///   the alignment of a scan between two key scans, or with an earlier passage, to count
  /// \param near_views  key scans of earlier passages that a new one is aligned with
  KeyScans(const KeyScanParameters& parameters,
           const SurfaceParameters& surfaces,
           const ScanMatcherParameters& matcher,
           double min_inlier_ratio,
           const NearViewParameters& near_views = {});

  /// Begins with the scans of a map made before: those that are key scans stay where they are.
  /// Call it once, first, and startSession() before the first add().
  /// \throws std::invalid_argument as LaserScan::validate()
  void load(const std::vector<PlacedScan>& scans);
  /// The robot was lost and has been found: from the next scan on the given trajectory is that of
  /// the base in the frame of the corrected one.
  void startSession() { starts_session_ = true; }

  /// The robot may have been carried between these stamps: to the key scan there, or the next one
  /// after them, that meets those before it the least.
  void addPossibleJump(std::int64_t from_ns, std::int64_t until_ns);

  /// \param odom_from_base  the given trajectory at the scan's stamp
  /// \return whether it is a key scan; it is then the last of keys()
  /// \throws std::invalid_argument, the state untouched, if the scan cannot be used, a pose is not
  ///   finite or the stamp is not later than that of the scan before
  bool add(const LaserScan& scan, const Pose2& base_from_laser, const Pose2& odom_from_base);

  bool empty() const { return scans_.empty(); }
  std::int64_t newestStampNs() const { return scans_.back().stamp_ns; }
  const std::vector<KeyScan>& keys() const { return keys_; }

  /// \param map_from_laser  the pose of each key scan
  void setPoses(const std::vector<Pose2>& map_from_laser);
  /// The robot was carried to one key scan: the motion to it is unknown, and all key scans from it
  /// on are moved so that a later one takes a pose.
  void setJump(std::size_t jump, std::size_t key, const Pose2& map_from_laser);

  /// Edges between the laser poses of successive key scans, as they were given.
  std::vector<PoseEdge> givenMotion() const;
  /// The same after the alignment of their scans.
  const std::vector<PoseEdge>& alignedMotion() const { return aligned_motion_; }

  /// The corrected pose of the base at the stamps of the scans: of each one with pose_per_scan,
  /// else of the key scans, of those that are aligned between them, and of the newest one. Between
  /// two of them the robot moves by less than between_distance_m or between_angle_rad.
  std::vector<StampedPose2> trajectory() const;

private:
  struct ScanRecord {
    std::int64_t stamp_ns = 0;
    std::size_t key = 0;  ///< the key scan at or before it
    Pose2 odom_from_base;
    /// What its own alignment adds to the pose that the key scans before and after give it.
    Pose2 shift = {};
    bool is_kept = true;  ///< when the next scan comes
  };

  /// A scan since the newest key scan that is aligned with it and the next one.
  struct BetweenScan {
    std::size_t record = 0;  ///< index into scans_
    SurfaceScan surfaces;
    Pose2 base_from_laser;
  };

  struct StampInterval {
    std::int64_t from_ns = 0;
    std::int64_t until_ns = 0;
  };

  /// Whether the last scan stays in the trajectory when the next one comes.
  bool keepsLast(std::int64_t next_ns, bool next_is_kept) const;
  bool isKeyScan(const Pose2& odom_from_base) const;
  /// If there is a key scan after the interval of a possible jump.
  void placePossibleJump();
  bool isBetweenScan(const Pose2& odom_from_base) const;
  SurfaceScan surfacesOf(const LaserScan& scan,
                         const Pose2& base_from_laser,
                         const Pose2& odom_from_base) const;
  void addKeyScan(std::int64_t stamp_ns,
                  SurfaceScan surfaces,
                  const Pose2& base_from_laser,
                  const Pose2& odom_from_base);
  /// Aligns the newest key scan with those before it.
  /// \return the share of its points that meet them
  double alignNewest();
  /// Moves the newest key scan to where those of earlier passages see the same, whatever their age:
  /// its pose does not drift where the robot has been before. The motion to it stays as measured.
  void alignNewestWithMap();
  /// The share of the newest key scan's points that meet the key scans before another one.
  double inlierRatioBefore(std::size_t key) const;
  /// Decides whether the robot may have been carried to one of the last key scans.
  /// \param inlier_ratio  of the newest one
  void reviewJumps(double inlier_ratio);
  PoseEdge givenEdge(std::size_t to) const;
  /// The edge to the newest key scan, the first one after the robot was found.
  PoseEdge startEdge() const;
  /// Some key scans of the session before one, seen from the last of them.
  std::vector<ReferenceScan> scansBefore(std::size_t key) const;
  /// Aligns the scans between the two newest key scans.
  void alignBetweenScans();
  /// Gives the scans between those aligned their shares of the shifts; there is none at either key
  /// scan.
  void shareShifts(std::int64_t from_ns, std::int64_t to_ns);
  /// Where the key scans before and after a scan put the base.
  Pose2 poseByKeyScans(const ScanRecord& scan) const;

  KeyScanParameters parameters_;
  SurfaceParameters surfaces_;
  ScanMatcherParameters matcher_;
  double min_inlier_ratio_;
  NearViewParameters near_views_;
  bool starts_session_ = false;
  std::optional<StampInterval> possible_jump_;  ///< until the next key scan after it comes
  std::size_t session_begin_ = 0;               ///< its first key scan
  std::optional<std::size_t> unmet_key_;  ///< the first in a row that does not meet those before
  std::vector<ScanRecord> scans_;
  std::vector<BetweenScan> between_scans_;
  std::vector<KeyScan> keys_;
  std::vector<PoseEdge> aligned_motion_;
};

}  // namespace ram_slam
