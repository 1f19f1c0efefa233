// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/loop_search.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "ram_parameters/require.hpp"
#include "ram_slam/scan_matching/correlative_search.hpp"

namespace ram_slam {
namespace {

constexpr double kResolutionM = 0.1;
constexpr double kDeviationM = 0.1;
constexpr int kLevels = 5;
constexpr double kUsedRangeM = 12.0;  // farther readings turn too many cells per angle step
constexpr std::size_t kQueryPoints = 250;
constexpr double kFreeMarginM =
    0.25;  // so far in front of what was seen there, a point is in free space
constexpr double kAngleStepRad = 0.015;
constexpr double kPositionReserveM = 0.5;  // searched even without drift
constexpr double kAngleReserveRad = 0.1;
constexpr float kTellingCrossing =
    0.5F;  // sine of the angle between a wall and a direction it tells about
constexpr std::size_t kMinTellingPoints = 20;
constexpr double kLeastAmbiguousShiftM = 0.4;  // nearer, the peak itself is still high
constexpr double kMaxRivalScore = 0.75;        // of the best score
constexpr double kWeakInformation = 100.0;     // 0.1 m, 0.1 rad

using ram_parameters::require;

Eigen::Vector2d viewCentre(const KeyScan& key) {
  return key.map_from_laser * key.view_centre_in_laser_m;
}

/// Indices of the key scans about one, [first, last).
std::pair<std::size_t, std::size_t> neighbours(std::size_t centre, std::size_t end, int count) {
  const auto reach = static_cast<std::size_t>(count);
  return {centre - std::min(centre, reach), std::min(end, centre + reach + 1)};
}

void appendPoints(const KeyScan& key,
                  const Pose2& frame_from_map,
                  std::size_t stride,
                  std::vector<Eigen::Vector2f>& points) {
  const Pose2 frame_from_laser = frame_from_map * key.map_from_laser;
  const Eigen::Matrix2f rotation = frame_from_laser.rotation().cast<float>();
  const Eigen::Vector2f shift = frame_from_laser.translation().cast<float>();
  for (std::size_t i = 0; i < key.surfaces.points.size(); i += stride) {
    const Eigen::Vector2f point(key.surfaces.points[i].x_m, key.surfaces.points[i].y_m);
    if (point.squaredNorm() < kUsedRangeM * kUsedRangeM) points.push_back(rotation * point + shift);
  }
}

/// Key scans [first, last) as points in the laser's frame of one of them, at most about
/// kQueryPoints.
std::vector<Eigen::Vector2f> queryPoints(const std::vector<KeyScan>& key_scans,
                                         std::size_t first,
                                         std::size_t last,
                                         std::size_t origin) {
  std::size_t total = 0;
  for (std::size_t i = first; i < last; ++i) total += key_scans[i].surfaces.points.size();
  const Pose2 laser_from_map = key_scans[origin].map_from_laser.inverse();
  std::vector<Eigen::Vector2f> points;
  for (std::size_t i = first; i < last; ++i) {
    appendPoints(key_scans[i], laser_from_map, std::max<std::size_t>(1, total / kQueryPoints),
                 points);
  }
  return points;
}

std::vector<ReferenceScan> referenceScans(const std::vector<KeyScan>& key_scans,
                                          std::size_t first,
                                          std::size_t last) {
  std::vector<ReferenceScan> references;
  for (std::size_t i = first; i < last; ++i)
    references.push_back({&key_scans[i].surfaces, key_scans[i].map_from_laser});
  return references;
}

/// Share of the points of one scan that lie well in front of what another one saw in their
/// direction.
double freeSpaceRatio(const SurfaceScan& target,
                      const SurfaceScan& source,
                      const Pose2& target_from_source) {
  std::size_t visible = 0;
  std::size_t in_free_space = 0;
  for (const SurfacePoint& point : source.points) {
    const Eigen::Vector2d place = target_from_source * Eigen::Vector2d(point.x_m, point.y_m);
    const double beam = wrapAngle(std::atan2(place.y(), place.x()) - target.angle_min_rad) /
                        target.angle_increment_rad;
    const auto index = static_cast<std::ptrdiff_t>(std::lround(beam));
    if (index < 1 || index + 1 >= static_cast<std::ptrdiff_t>(target.point_of_beam.size()))
      continue;
    double seen_m = 1e9;  // the nearest of three beams: edges are not evidence
    for (std::ptrdiff_t i = index - 1; i <= index + 1; ++i) {
      const auto here = static_cast<std::size_t>(target.point_of_beam[static_cast<std::size_t>(i)]);
      const std::size_t next =
          static_cast<std::size_t>(i) + 1 < target.point_of_beam.size()
              ? static_cast<std::size_t>(target.point_of_beam[static_cast<std::size_t>(i) + 1])
              : target.points.size();
      if (here == next) {  // nothing came back: no evidence
        seen_m = 0.0;
        continue;
      }
      seen_m = std::min(seen_m, static_cast<double>(
                                    std::hypot(target.points[here].x_m, target.points[here].y_m)));
    }
    if (seen_m <= 0.0) continue;
    ++visible;
    if (place.norm() < seen_m - kFreeMarginM) ++in_free_space;
  }
  return visible == 0 ? 1.0 : static_cast<double>(in_free_space) / static_cast<double>(visible);
}

/// The direction in the map in which a match holds the least, whatever the yaw.
Eigen::Vector2d weakestDirection(const Eigen::Matrix3d& information) {
  const Eigen::Vector2d with_yaw = information.topRightCorner<2, 1>();
  const Eigen::Matrix2d translation =
      information.topLeftCorner<2, 2>() -
      with_yaw * with_yaw.transpose() / std::max(information(2, 2), 1e-9);
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(translation).eigenvectors().col(0);
}

/// Points of key scans [first, last), seen from one of them, that tell where along a direction they
/// are: not those on walls that run along it.
std::vector<Eigen::Vector2f> tellingPoints(const std::vector<KeyScan>& key_scans,
                                           std::size_t first,
                                           std::size_t last,
                                           std::size_t origin,
                                           const Eigen::Vector2d& direction_in_origin) {
  const Pose2 origin_from_map = key_scans[origin].map_from_laser.inverse();
  std::vector<Eigen::Vector2f> points;
  for (std::size_t i = first; i < last; ++i) {
    const Pose2 origin_from_laser = origin_from_map * key_scans[i].map_from_laser;
    const Eigen::Vector2f direction =
        (origin_from_laser.rotation().transpose() * direction_in_origin).cast<float>();
    for (const SurfacePoint& point : key_scans[i].surfaces.points) {
      const float crossing =
          std::abs(point.normal_x * direction.x() + point.normal_y * direction.y());
      if (point.hasNormal() && crossing < kTellingCrossing) continue;
      if (std::hypot(point.x_m, point.y_m) > kUsedRangeM) continue;
      points.push_back((origin_from_laser * Eigen::Vector2d(point.x_m, point.y_m)).cast<float>());
    }
  }
  return points;
}

/// Whether the place would look (nearly) as familiar from elsewhere along a direction, up to a
/// distance to each side: a corridor between two doors, a row of doors.
bool isAmbiguous(const LikelihoodPyramid& place,
                 const std::vector<Eigen::Vector2f>& telling_points,
                 const Pose2& map_from_laser,
                 const Eigen::Vector2d& direction,
                 double distance_m) {
  if (telling_points.size() < kMinTellingPoints) return true;
  const auto scoreAt = [&](double shift_m) {
    const Pose2 shifted{map_from_laser.x_m + shift_m * direction.x(),
                        map_from_laser.y_m + shift_m * direction.y(), map_from_laser.yaw_rad};
    return scorePose(place, telling_points, shifted);
  };
  const double best = scoreAt(0.0);
  for (double shift_m = kLeastAmbiguousShiftM; shift_m <= distance_m; shift_m += kResolutionM) {
    if (std::max(scoreAt(shift_m), scoreAt(-shift_m)) > kMaxRivalScore * best) return true;
  }
  return false;
}

}  // namespace

void LoopSearchParameters::validate() const {
  require(min_path_m > 0.0, "min_path_m", min_path_m, "> 0");
  require(max_view_distance_m > 0.0, "max_view_distance_m", max_view_distance_m, "> 0");
  require(drift_m_per_m >= 0.0, "drift_m_per_m", drift_m_per_m, ">= 0");
  require(drift_rad_per_m >= 0.0, "drift_rad_per_m", drift_rad_per_m, ">= 0");
  require(max_distance_m > 0.0, "max_distance_m", max_distance_m, "> 0");
  require(max_angle_rad > 0.0, "max_angle_rad", max_angle_rad, "> 0");
  require(neighbour_count >= 0, "neighbour_count", neighbour_count, ">= 0");
  require(min_score >= 0.0 && min_score <= 1.0, "min_score", min_score, "in [0, 1]");
  require(min_inlier_ratio >= 0.0 && min_inlier_ratio <= 1.0, "min_inlier_ratio", min_inlier_ratio,
          "in [0, 1]");
  require(max_free_space_ratio >= 0.0 && max_free_space_ratio <= 1.0, "max_free_space_ratio",
          max_free_space_ratio, "in [0, 1]");
  require(max_round_trip_m > 0.0, "max_round_trip_m", max_round_trip_m, "> 0");
  require(max_round_trip_rad > 0.0, "max_round_trip_rad", max_round_trip_rad, "> 0");
}

std::vector<std::size_t> findLoopCandidates(const std::vector<KeyScan>& key_scans,
                                            std::size_t newest,
                                            const std::vector<double>& path_to_m,
                                            const LoopSearchParameters& parameters) {
  struct Candidate {
    std::size_t index;
    double distance_m;  // beyond what drift explains
  };
  const Eigen::Vector2d centre = viewCentre(key_scans[newest]);
  std::vector<Candidate> best_of_passage;
  bool in_passage = false;
  for (std::size_t i = 0; i < newest; ++i) {
    const double allowed_m =
        parameters.max_view_distance_m +
        std::min(parameters.max_distance_m, parameters.drift_m_per_m * path_to_m[i]);
    const double distance_m = (viewCentre(key_scans[i]) - centre).norm();
    if (path_to_m[i] < parameters.min_path_m || distance_m > allowed_m) {
      in_passage = false;
      continue;
    }
    if (!in_passage) {
      best_of_passage.push_back({i, distance_m});
    } else if (distance_m < best_of_passage.back().distance_m) {
      best_of_passage.back() = {i, distance_m};
    }
    in_passage = true;
  }
  std::stable_sort(
      best_of_passage.begin(), best_of_passage.end(),
      [](const Candidate& a, const Candidate& b) { return a.distance_m < b.distance_m; });
  std::vector<std::size_t> indices;
  for (const Candidate& candidate : best_of_passage) indices.push_back(candidate.index);
  return indices;
}

SearchWindow searchWindow(double path_m, const LoopSearchParameters& parameters) {
  SearchWindow window;
  window.distance_m =
      std::min(parameters.max_distance_m, kPositionReserveM + parameters.drift_m_per_m * path_m);
  window.angle_rad =
      std::min(parameters.max_angle_rad, kAngleReserveRad + parameters.drift_rad_per_m * path_m);
  window.angle_step_rad = kAngleStepRad;
  return window;
}

std::optional<LoopMatch> verifyLoop(const std::vector<KeyScan>& key_scans,
                                    std::size_t candidate,
                                    std::size_t newest,
                                    const Pose2& map_from_laser_guess,
                                    const SearchWindow& window,
                                    const ScanMatcherParameters& matcher,
                                    const LoopSearchParameters& parameters) {
  const auto [old_first, old_last] = neighbours(candidate, newest, parameters.neighbour_count);
  const auto [new_first, new_last] =
      neighbours(newest, key_scans.size(), parameters.neighbour_count);
  if (old_last > new_first) return std::nullopt;

  std::vector<Eigen::Vector2f> place;
  for (std::size_t i = old_first; i < old_last; ++i) appendPoints(key_scans[i], Pose2{}, 1, place);
  const std::vector<Eigen::Vector2f> query = queryPoints(key_scans, new_first, new_last, newest);
  if (place.empty() || query.empty()) return std::nullopt;
  const LikelihoodPyramid pyramid(place, kResolutionM, kDeviationM, kLevels);
  const auto found = searchPose(pyramid, query, map_from_laser_guess, window, parameters.min_score);
  if (!found) return std::nullopt;

  const KeyScan& old_key = key_scans[candidate];
  const KeyScan& new_key = key_scans[newest];
  // The prior only keeps what the walls leave open where it is.
  const PosePrior found_place{found->map_from_laser,
                              kWeakInformation * Eigen::Matrix3d::Identity()};
  const ScanMatch there =
      matchScan(new_key.surfaces, referenceScans(key_scans, old_first, old_last), found_place,
                found->map_from_laser, matcher);
  if (there.inlier_ratio < parameters.min_inlier_ratio) return std::nullopt;
  const Pose2 old_from_new = old_key.map_from_laser.inverse() * there.map_from_laser;
  if (freeSpaceRatio(old_key.surfaces, new_key.surfaces, old_from_new) >
          parameters.max_free_space_ratio ||
      freeSpaceRatio(new_key.surfaces, old_key.surfaces, old_from_new.inverse()) >
          parameters.max_free_space_ratio) {
    return std::nullopt;
  }

  // Back: the old scan in the new place.
  const Pose2 guess = new_key.map_from_laser * old_from_new.inverse();
  const PosePrior same_place{guess, kWeakInformation * Eigen::Matrix3d::Identity()};
  const ScanMatch back = matchScan(old_key.surfaces, referenceScans(key_scans, new_first, new_last),
                                   same_place, guess, matcher);
  const Pose2 round_trip = old_from_new * (new_key.map_from_laser.inverse() * back.map_from_laser);
  if (round_trip.translation().norm() > parameters.max_round_trip_m ||
      std::abs(round_trip.yaw_rad) > parameters.max_round_trip_rad) {
    return std::nullopt;
  }

  const Eigen::Vector2d weakest = weakestDirection(there.information);
  const Eigen::Vector2d weakest_in_new = there.map_from_laser.rotation().transpose() * weakest;
  const std::vector<Eigen::Vector2f> telling =
      tellingPoints(key_scans, new_first, new_last, newest, weakest_in_new);
  LoopMatch loop;
  loop.is_ambiguous =
      isAmbiguous(pyramid, telling, there.map_from_laser, weakest, window.distance_m);
  Eigen::Matrix3d information = there.information;
  if (loop.is_ambiguous) {
    // Nothing is known along the weakest direction u: information - (information u) (information
    // u)^T / u^T information u.
    const Eigen::Vector3d u(weakest.x(), weakest.y(), 0.0);
    const Eigen::Vector3d known = information * u;
    information -= known * known.transpose() / std::max(u.dot(known), 1e-9);
  }
  loop.edge.from = candidate;
  loop.edge.to = newest;
  loop.edge.from_from_to = old_from_new;
  Eigen::Matrix3d old_axes = Eigen::Matrix3d::Identity();
  old_axes.topLeftCorner<2, 2>() = old_key.map_from_laser.rotation();
  loop.edge.information = old_axes.transpose() * information * old_axes;
  loop.edge.may_be_false = true;
  loop.score = found->score;
  loop.inlier_ratio = there.inlier_ratio;
  return loop;
}

}  // namespace ram_slam
