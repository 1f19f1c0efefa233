// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/pose_graph/pose_graph.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/smoothing/constellation_memory.hpp"
#include "ram_slam/smoothing/jump_search.hpp"
#include "ram_slam/smoothing/key_scan.hpp"
#include "ram_slam/smoothing/loop_closure.hpp"
#include "ram_slam/smoothing/loop_search.hpp"
#include "ram_slam/smoothing/loop_verification.hpp"

namespace ram_slam {

/// Settings of LoopCloser. Keys are those of config/map_smoother.yaml.
struct LoopCloserParameters {
  double search_distance_m = 1.0;  ///< path between two searches
  /// After so much path without a closure places are recognised by their features, too, wherever
  /// drift has brought them; 0: never.
  double constellation_path_m = 100.0;
  /// Standard deviation of a closure beyond what the noise of the readings explains.
  double closure_deviation_m = 0.03;
  double closure_deviation_rad = 0.01;
  LoopSearchParameters search;
  JumpSearchParameters jumps;

  double closure_path_m = 0.5;            ///< path that a closure is as good as
  int verified_candidates = 3;            ///< of a key scan, at most
  double constellation_step_m = 5.0;      ///< path between two searches by features
  double constellation_stretch_m = 20.0;  ///< path whose features are compared at once
  int kept_feature_lists = 100;           ///< of which the scan has not come yet
  int refused_reach = 10;  ///< key scans beside a refused closure where it is not searched again
  int accepted_reach = 4;  ///< the same of an accepted closure
  int failed_reach = 2;    ///< the same of a search that failed in a window that covers the new one
  double failed_margin_m = 0.25;  ///< by which the new window may be larger
  double failed_margin_rad = 0.05;
  double sweep_path_m = 30.0;  ///< once all loops are closed, no pose has drifted by more path

  static const ram_parameters::ParameterTable<LoopCloserParameters>& table();
};

/// Decides when and where loops are searched, and keeps the closures that were found.
class LoopCloser {
public:
  /// Called with each new closure's later key scan and how the closure moves it, in its own axes;
  /// may change the poses of the key scans.
  using ClosureHandler = std::function<void(std::size_t key, const Pose2& correction)>;

  /// \param matchers  of features, by type; a type without one is compared by geometry alone
  LoopCloser(const LoopCloserParameters& parameters,
             const ScanMatcherParameters& matcher,
             const FeatureMatchers& matchers);

  /// Features in the base frame at a scan's stamp, before the scan or soon after.
  void addFeatures(const FeatureList& list);
  /// As JumpSearch::addFoundPlace().
  void addFoundPlace(std::int64_t stamp_ns, const Pose2& map_from_odom) {
    jumps_.addFoundPlace(stamp_ns, map_from_odom);
  }
  /// Gives the newest key scan its features if they are known.
  void useFeatures(const std::vector<KeyScan>& key_scans);

  /// Searches places that the newest key scan shares with earlier ones if the last search is far
  /// enough back.
  void searchIfDue(const std::vector<KeyScan>& key_scans, const ClosureHandler& on_closure);
  /// Searches along the whole path, as if no pose had drifted far, but not again where a search
  /// failed. \return whether a loop was closed
  bool sweep(const std::vector<KeyScan>& key_scans, const ClosureHandler& on_closure);

  const std::vector<LoopClosure>& closures() const { return closures_; }
  /// A refused closure is not found again. \throws std::out_of_range if there is no such closure
  void refuse(std::size_t index);
  void accept(std::size_t index);

  /// The edges of accepted closures, in the order in which they were found.
  std::vector<PoseEdge> acceptedEdges() const;
  /// The same with those of outvoted closures, which are marked.
  std::vector<PoseEdge> candidateEdges() const;
  /// Accepts or outvotes closures that are not refused.
  /// \param trust  weight of each of candidateEdges() in the graph, 0 .. 1
  void judge(const std::vector<double>& trust, double min_trust);

private:
  struct FailedSearch {
    PoseEdge centre;  ///< of the window; its information is not used
    SearchWindow window;
  };

  /// \param max_path_m  no pose has drifted along more path
  bool searchByPoses(const std::vector<KeyScan>& key_scans,
                     std::size_t newest,
                     double max_path_m,
                     bool is_sweep,
                     const ClosureHandler& on_closure);
  /// Searches places that look like the newest key scan's before a possible jump, wherever poses
  /// put them. If two agree with each other and not with the poses, the robot was carried.
  bool searchByShape(const std::vector<KeyScan>& key_scans, const ClosureHandler& on_closure);
  /// Whether the poses put the key scans of a match where it does, as far as drift allows.
  bool agreesWithPoses(const std::vector<KeyScan>& key_scans, const LoopMatch& match) const;
  void addClosure(const std::vector<KeyScan>& key_scans,
                  const LoopMatch& match,
                  const std::optional<std::size_t>& jump,
                  const ClosureHandler& on_closure);
  /// Searches the place that the recent features recognise, if there is one.
  void searchByFeatures(const std::vector<KeyScan>& key_scans, const ClosureHandler& on_closure);
  bool tryClosing(const std::vector<KeyScan>& key_scans,
                  const LoopQuery& query,
                  const ClosureHandler& on_closure);
  /// Whether a closure between two key scans, or beside them, was accepted or refused already.
  bool isSettled(std::size_t from, std::size_t to) const;
  /// Whether a closure between nearly the same poses was outvoted before.
  bool wasOutvoted(const std::vector<KeyScan>& key_scans, const PoseEdge& edge) const;
  /// Whether a search that failed covers this one.
  bool wasSearched(const std::vector<KeyScan>& key_scans,
                   std::size_t from,
                   std::size_t to,
                   const SearchWindow& window) const;
  std::vector<double> pathsTo(std::size_t key, const std::vector<KeyScan>& key_scans) const;

  LoopCloserParameters parameters_;
  ScanMatcherParameters matcher_;
  JumpSearch jumps_;
  ConstellationMemory constellations_;
  std::deque<FeatureList> features_;  // of recent scans, in the order of their stamps
  std::vector<LoopClosure> closures_;
  std::vector<FailedSearch> failed_searches_;
  double searched_path_m_ = 0.0;
  double closed_path_m_ = 0.0;  // of the newest key scan with a closure, or constellation search
};

}  // namespace ram_slam
