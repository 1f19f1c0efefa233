// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/loop_verification.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Eigenvalues>

#include "ram_slam/geometry/motion_gate.hpp"

namespace ram_slam {
namespace {

/// Keeps a division by the information of a direction finite that nothing holds.
constexpr double kLeastInformation = 1e-9;

/// Some successive key scans, seen from the laser of one of them.
struct Passage {
  std::size_t first = 0;
  std::size_t last = 0;  ///< not included
  std::size_t origin = 0;
};

/// A key scan with its neighbours: so many on each side, and more where they see little.
/// \param end  no key scan from here on
Passage passageAbout(const std::vector<KeyScan>& key_scans,
                     std::size_t centre,
                     std::size_t end,
                     const LoopSearchParameters& parameters) {
  const auto most = static_cast<std::size_t>(parameters.max_neighbour_count);
  const auto wanted = static_cast<std::size_t>(parameters.dense.query_point_count);
  auto reach = static_cast<std::size_t>(parameters.neighbour_count);
  Passage passage;
  for (;; ++reach) {
    passage = {centre - std::min(centre, reach), std::min(end, centre + reach + 1), centre};
    std::size_t points = 0;
    for (std::size_t i = passage.first; i < passage.last; ++i)
      points += key_scans[i].surfaces.points.size();
    if (reach >= most || points >= wanted) return passage;
  }
}

/// How many times farther than DenseSearchParameters::max_range_m the passage has to look for half
/// of its readings, at least 1.
double scaleOf(const std::vector<KeyScan>& key_scans,
               const Passage& passage,
               const DenseSearchParameters& dense) {
  std::vector<float> ranges_m;
  for (std::size_t i = passage.first; i < passage.last; ++i) {
    for (const SurfacePoint& point : key_scans[i].surfaces.points)
      ranges_m.push_back(std::hypot(point.x_m, point.y_m));
  }
  if (ranges_m.empty()) return 1.0;
  const auto middle = ranges_m.begin() + static_cast<std::ptrdiff_t>(ranges_m.size() / 2);
  std::nth_element(ranges_m.begin(), middle, ranges_m.end());
  return std::max(1.0, static_cast<double>(*middle) / dense.max_range_m);
}

/// In the open all is searched as finely as the farther readings allow: these cross so many cells
/// per step of the angle as those at the range meant for rooms.
LoopSearchParameters scaled(LoopSearchParameters parameters, double scale) {
  parameters.dense.max_range_m *= scale;
  parameters.dense.resolution_m *= scale;
  parameters.dense.reading_deviation_m *= scale;
  parameters.corridor.min_rival_shift_m *= scale;
  return parameters;
}

ScanMatcherParameters scaled(ScanMatcherParameters matcher, double scale) {
  matcher.first_gate_m *= scale;
  return matcher;
}

void appendPoints(const KeyScan& key,
                  const Pose2& frame_from_map,
                  std::size_t stride,
                  double max_range_m,
                  std::vector<Eigen::Vector2f>& points) {
  const Pose2 frame_from_laser = frame_from_map * key.map_from_laser;
  const Eigen::Matrix2f rotation = frame_from_laser.rotation().cast<float>();
  const Eigen::Vector2f shift = frame_from_laser.translation().cast<float>();
  for (std::size_t i = 0; i < key.surfaces.points.size(); i += stride) {
    const Eigen::Vector2f point(key.surfaces.points[i].x_m, key.surfaces.points[i].y_m);
    if (point.squaredNorm() < max_range_m * max_range_m) points.push_back(rotation * point + shift);
  }
}

/// All points in the map.
std::vector<Eigen::Vector2f> mapPoints(const std::vector<KeyScan>& key_scans,
                                       const Passage& passage,
                                       const LoopSearchParameters& parameters) {
  std::vector<Eigen::Vector2f> points;
  for (std::size_t i = passage.first; i < passage.last; ++i)
    appendPoints(key_scans[i], Pose2{}, 1, parameters.dense.max_range_m, points);
  return points;
}

/// About query_point_count points in the frame of the passage.
std::vector<Eigen::Vector2f> queryPoints(const std::vector<KeyScan>& key_scans,
                                         const Passage& passage,
                                         const LoopSearchParameters& parameters) {
  std::size_t total = 0;
  for (std::size_t i = passage.first; i < passage.last; ++i)
    total += key_scans[i].surfaces.points.size();
  const auto wanted = static_cast<std::size_t>(parameters.dense.query_point_count);
  const Pose2 laser_from_map = key_scans[passage.origin].map_from_laser.inverse();
  std::vector<Eigen::Vector2f> points;
  for (std::size_t i = passage.first; i < passage.last; ++i) {
    appendPoints(key_scans[i], laser_from_map, std::max<std::size_t>(1, total / wanted),
                 parameters.dense.max_range_m, points);
  }
  return points;
}

std::vector<ReferenceScan> referenceScans(const std::vector<KeyScan>& key_scans,
                                          const Passage& passage) {
  std::vector<ReferenceScan> references;
  for (std::size_t i = passage.first; i < passage.last; ++i)
    references.push_back({&key_scans[i].surfaces, key_scans[i].map_from_laser});
  return references;
}

/// The reading of one beam [m]; 0 if it met nothing.
double readingOf(const SurfaceScan& scan, std::ptrdiff_t beam) {
  const auto at = static_cast<std::size_t>(beam);
  const auto here = static_cast<std::size_t>(scan.point_of_beam[at]);
  const std::size_t next = at + 1 < scan.point_of_beam.size()
                               ? static_cast<std::size_t>(scan.point_of_beam[at + 1])
                               : scan.points.size();
  if (here == next) return 0.0;
  return static_cast<double>(std::hypot(scan.points[here].x_m, scan.points[here].y_m));
}

/// The nearest reading of three beams towards a place, as edges are not evidence; 0 if one of them
/// met nothing or lies outside the scan.
double readingTowards(const SurfaceScan& scan, const Eigen::Vector2d& place_m) {
  const double beam = wrapAngle(std::atan2(place_m.y(), place_m.x()) - scan.angle_min_rad) /
                      scan.angle_increment_rad;
  const auto index = static_cast<std::ptrdiff_t>(std::lround(beam));
  if (index < 1 || index + 1 >= static_cast<std::ptrdiff_t>(scan.point_of_beam.size())) return 0.0;
  return std::min({readingOf(scan, index - 1), readingOf(scan, index), readingOf(scan, index + 1)});
}

/// Share of the points of one scan that lie well in front of what another one saw in their
/// direction.
double freeSpaceRatio(const SurfaceScan& target,
                      const SurfaceScan& source,
                      const Pose2& target_from_source,
                      double margin_m) {
  std::size_t visible = 0;
  std::size_t in_free_space = 0;
  for (const SurfacePoint& point : source.points) {
    const Eigen::Vector2d place = target_from_source * Eigen::Vector2d(point.x_m, point.y_m);
    const double seen_m = readingTowards(target, place);
    if (seen_m <= 0.0) continue;
    ++visible;
    if (place.norm() < seen_m - margin_m) ++in_free_space;
  }
  return visible == 0 ? 1.0 : static_cast<double>(in_free_space) / static_cast<double>(visible);
}

/// The direction in the map in which a match holds the least, whatever the yaw.
Eigen::Vector2d weakestDirection(const Eigen::Matrix3d& information) {
  const Eigen::Vector2d with_yaw = information.topRightCorner<2, 1>();
  const Eigen::Matrix2d translation =
      information.topLeftCorner<2, 2>() -
      with_yaw * with_yaw.transpose() / std::max(information(2, 2), kLeastInformation);
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(translation).eigenvectors().col(0);
}

/// The points that fix where along a direction they are: not those on walls that run along it.
/// \param direction  in the frame of the passage
std::vector<Eigen::Vector2f> crossingPoints(const std::vector<KeyScan>& key_scans,
                                            const Passage& passage,
                                            const Eigen::Vector2d& direction,
                                            const LoopSearchParameters& parameters) {
  const auto min_crossing = static_cast<float>(parameters.corridor.min_crossing_sine);
  const Pose2 origin_from_map = key_scans[passage.origin].map_from_laser.inverse();
  std::vector<Eigen::Vector2f> points;
  for (std::size_t i = passage.first; i < passage.last; ++i) {
    const Pose2 origin_from_laser = origin_from_map * key_scans[i].map_from_laser;
    const Eigen::Vector2f along =
        (origin_from_laser.rotation().transpose() * direction).cast<float>();
    for (const SurfacePoint& point : key_scans[i].surfaces.points) {
      const float crossing = std::abs(point.normal_x * along.x() + point.normal_y * along.y());
      if (point.hasNormal() && crossing < min_crossing) continue;
      if (std::hypot(point.x_m, point.y_m) > parameters.dense.max_range_m) continue;
      points.push_back((origin_from_laser * Eigen::Vector2d(point.x_m, point.y_m)).cast<float>());
    }
  }
  return points;
}

/// The information without that along a direction u: I - (I u) (I u)^T / (u^T I u).
Eigen::Matrix3d withoutDirection(const Eigen::Matrix3d& information,
                                 const Eigen::Vector2d& direction) {
  const Eigen::Vector3d u(direction.x(), direction.y(), 0.0);
  const Eigen::Vector3d known = information * u;
  return information - known * known.transpose() / std::max(u.dot(known), kLeastInformation);
}

/// The matching of two passages.
class Verification {
public:
  Verification(const std::vector<KeyScan>& key_scans,
               const LoopQuery& query,
               const ScanMatcherParameters& matcher,
               const LoopSearchParameters& parameters)
      : key_scans_(key_scans),
        query_(query),
        old_(passageAbout(key_scans, query.candidate, query.newest, parameters)),
        new_(passageAbout(key_scans, query.newest, key_scans.size(), parameters)),
        scale_(scaleOf(key_scans, new_, parameters.dense)),
        matcher_(scaled(matcher, scale_)),
        parameters_(scaled(parameters, scale_)) {}

  std::optional<LoopMatch> run() const {
    if (old_.last > new_.first) return std::nullopt;
    const std::vector<Eigen::Vector2f> place = mapPoints(key_scans_, old_, parameters_);
    const std::vector<Eigen::Vector2f> points = queryPoints(key_scans_, new_, parameters_);
    if (std::min(place.size(), points.size()) < static_cast<std::size_t>(parameters_.min_points))
      return std::nullopt;
    const LikelihoodPyramid pyramid(place, parameters_.dense.resolution_m,
                                    parameters_.dense.reading_deviation_m,
                                    parameters_.dense.levels);
    const auto found = searchPose(pyramid, points, query_.map_from_laser_guess, query_.window,
                                  parameters_.min_score);
    if (!found) return std::nullopt;
    const ScanMatch there = align(newKey(), old_, found->map_from_laser);
    if (there.inlier_ratio < parameters_.min_inlier_ratio) return std::nullopt;
    const Pose2 old_from_new = oldKey().map_from_laser.inverse() * there.map_from_laser;
    if (isInFreeSpace(old_from_new) || !returns(old_from_new)) return std::nullopt;
    LoopMatch match = describe(there, old_from_new, isAmbiguousAt(pyramid, there));
    match.score = found->score;
    return match;
  }

private:
  const KeyScan& oldKey() const { return key_scans_[query_.candidate]; }
  const KeyScan& newKey() const { return key_scans_[query_.newest]; }

  /// The prior only keeps what the walls leave open where it is.
  ScanMatch align(const KeyScan& key, const Passage& passage, const Pose2& map_from_laser) const {
    const PosePrior prior{map_from_laser,
                          parameters_.prior_information * Eigen::Matrix3d::Identity()};
    return matchScan(key.surfaces, referenceScans(key_scans_, passage), prior, map_from_laser,
                     matcher_);
  }

  bool isInFreeSpace(const Pose2& old_from_new) const {
    const double margin_m = parameters_.free_space_margin_m;
    const double most = parameters_.max_free_space_ratio;
    return freeSpaceRatio(oldKey().surfaces, newKey().surfaces, old_from_new, margin_m) > most ||
           freeSpaceRatio(newKey().surfaces, oldKey().surfaces, old_from_new.inverse(), margin_m) >
               most;
  }

  /// Whether the old scan, aligned in the new place, ends where it is.
  bool returns(const Pose2& old_from_new) const {
    const Pose2 guess = newKey().map_from_laser * old_from_new.inverse();
    const ScanMatch back = align(oldKey(), new_, guess);
    const Pose2 round_trip =
        old_from_new * (newKey().map_from_laser.inverse() * back.map_from_laser);
    const MotionGate most{parameters_.max_round_trip_m, parameters_.max_round_trip_rad};
    return !most.isExceededBy(round_trip);
  }

  /// Whether the scans would fit nearly as well elsewhere along the direction that they hold the
  /// least, up to the side of the window: a corridor between two doors, a row of doors.
  bool isAmbiguousAt(const LikelihoodPyramid& place, const ScanMatch& there) const {
    const Eigen::Vector2d weakest = weakestDirection(there.information);
    const Eigen::Vector2d weakest_in_new = there.map_from_laser.rotation().transpose() * weakest;
    const std::vector<Eigen::Vector2f> points =
        crossingPoints(key_scans_, new_, weakest_in_new, parameters_);
    if (points.size() < static_cast<std::size_t>(parameters_.corridor.min_crossing_points))
      return true;
    const auto scoreAt = [&](double shift_m) {
      const Pose2& pose = there.map_from_laser;
      const Pose2 shifted{pose.x_m + shift_m * weakest.x(), pose.y_m + shift_m * weakest.y(),
                          pose.yaw_rad};
      return scorePose(place, points, shifted);
    };
    const double most = parameters_.corridor.max_rival_score * scoreAt(0.0);
    for (double shift_m = parameters_.corridor.min_rival_shift_m;
         shift_m <= query_.window.distance_m; shift_m += parameters_.dense.resolution_m) {
      if (std::max(scoreAt(shift_m), scoreAt(-shift_m)) > most) return true;
    }
    return false;
  }

  LoopMatch describe(const ScanMatch& there, const Pose2& old_from_new, bool is_ambiguous) const {
    const Eigen::Matrix3d information =
        is_ambiguous ? withoutDirection(there.information, weakestDirection(there.information))
                     : there.information;
    LoopMatch match;
    match.is_ambiguous = is_ambiguous;
    match.inlier_ratio = there.inlier_ratio;
    match.edge.from = query_.candidate;
    match.edge.to = query_.newest;
    match.edge.from_from_to = old_from_new;
    const Eigen::Matrix3d turn = oldKey().map_from_laser.axesRotation();
    match.edge.information = turn.transpose() * information * turn;
    match.edge.may_be_false = true;
    return match;
  }

  const std::vector<KeyScan>& key_scans_;
  const LoopQuery& query_;
  Passage old_;
  Passage new_;
  double scale_;
  ScanMatcherParameters matcher_;
  LoopSearchParameters parameters_;
};

}  // namespace

std::optional<LoopMatch> verifyLoop(const std::vector<KeyScan>& key_scans,
                                    const LoopQuery& query,
                                    const ScanMatcherParameters& matcher,
                                    const LoopSearchParameters& parameters) {
  return Verification(key_scans, query, matcher, parameters).run();
}

}  // namespace ram_slam
