// SPDX-License-Identifier: BSD-3-Clause
// Repeatability of features and recognition by classifiers on recorded scans with corrected poses.
//
// recorded_scans LOG [corner|edge|both [FEATURES.csv [CORNER.yaml [EDGE.yaml]]]]
//
// LOG: lines ROBOTLASER1 or FLASER of a CARMEN log whose laser poses are corrected. Writes
// FEATURES.csv: scan index, x, y in the laser's frame.
//
// Repeatability: pairs of scans 0.1 to 1 m and less than 30 degrees apart, at most 4 later scans
// (of the next 40) for each. A feature counts if the other scan sees its place: range there more
// than (distance - 0.3 m). It is repeated if the other scan has a feature within 0.20 m. Chance:
// the same for the features' places moved by 1 m in a random direction.
//
// Recognition: pairs of features of scans more than 40 scans and less than 2 m apart. True: less
// than 0.15 m apart in the world; false: more than 0.5 m. Share of true pairs above the likelihood
// ratio that 1 % of the false pairs exceed.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>

#include "ram_slam/geometry/random.hpp"
#include "ramscout_feature_detector/corner_matcher.hpp"
#include "ramscout_feature_detector/edge_detector.hpp"
#include "ramscout_feature_detector/edge_matcher.hpp"
#include "ramscout_feature_detector/feature_detector.hpp"

#include "corrected_log.hpp"

namespace {

using namespace ramscout_feature_detector;
using Descriptor = std::shared_ptr<const ram_slam::FeatureMatcher::Descriptor>;

struct Recorded {
  ram_slam::Pose2 pose;
  ram_slam::LaserScan scan;
  std::vector<ram_slam::Feature> features;  ///< in the laser's frame
  std::vector<Descriptor> descriptors;
};

std::vector<Recorded> readLog(const char* path) {
  std::vector<Recorded> log;
  for (auto& [pose, scan] : readCorrectedLog(path)) log.push_back({pose, std::move(scan), {}, {}});
  return log;
}

bool sees(const Recorded& recorded, const Eigen::Vector2d& place_m) {
  const ram_slam::LaserScan& scan = recorded.scan;
  const double bearing_rad = std::atan2(place_m.y(), place_m.x());
  const double beam = std::round((bearing_rad - scan.angle_min_rad) / scan.angle_increment_rad);
  if (!(beam >= 1.0 && beam < static_cast<double>(scan.ranges_m.size()) - 1.0)) return false;
  const float* range_m = scan.ranges_m.data() + static_cast<std::size_t>(beam);
  return std::max({range_m[-1], range_m[0], range_m[1]}) > place_m.norm() - 0.3;
}

struct Repeatability {
  int visible = 0, repeated = 0, chance_visible = 0, chance_repeated = 0;
};

void repeat(const Recorded& from,
            const Recorded& to,
            ram_slam::Random& random,
            Repeatability& result) {
  const ram_slam::Pose2 to_from = to.pose.inverse() * from.pose;
  const auto count = [&](const Eigen::Vector2d& place_m, int& visible, int& repeated) {
    if (!sees(to, place_m)) return;
    ++visible;
    repeated += std::any_of(to.features.begin(), to.features.end(), [&](const auto& feature) {
      return (feature.position_m - place_m).norm() < 0.2;
    });
  };
  for (const auto& feature : from.features) {
    const Eigen::Vector2d place_m = to_from * feature.position_m;
    const double angle_rad = 2.0 * M_PI * random.uniform();
    count(place_m, result.visible, result.repeated);
    count(place_m + Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)),
          result.chance_visible, result.chance_repeated);
  }
}

Repeatability repeatability(const std::vector<Recorded>& log) {
  Repeatability result;
  ram_slam::Random random(1);
  for (std::size_t i = 0; i < log.size(); ++i) {
    int pairs = 0;
    for (std::size_t j = i + 1; j < std::min(i + 40, log.size()) && pairs < 4; ++j) {
      const ram_slam::Pose2 motion = log[i].pose.inverse() * log[j].pose;
      const double distance_m = motion.translation().norm();
      if (distance_m < 0.1 || distance_m > 1.0 || std::abs(motion.yaw_rad) >= M_PI / 6.0) continue;
      ++pairs;
      repeat(log[i], log[j], random, result);
    }
  }
  return result;
}

const ram_slam::FeatureMatcher& matcherOf(const std::string& type) {
  static const CornerMatcher corner_matcher;
  static const EdgeMatcher edge_matcher;
  if (type == kCornerType) return corner_matcher;
  return edge_matcher;
}

void recognition(const std::vector<Recorded>& log) {
  std::vector<double> same, different;
  for (std::size_t i = 0; i < log.size(); ++i) {
    for (std::size_t j = i + 41; j < log.size(); ++j) {
      if ((log[i].pose.translation() - log[j].pose.translation()).norm() > 2.0) continue;
      const ram_slam::Pose2 i_from_j = log[i].pose.inverse() * log[j].pose;
      for (std::size_t a = 0; a < log[i].features.size(); ++a) {
        for (std::size_t b = 0; b < log[j].features.size(); ++b) {
          const double distance_m =
              (log[i].features[a].position_m - i_from_j * log[j].features[b].position_m).norm();
          if (distance_m >= 0.15 && distance_m <= 0.5) continue;
          if (log[i].features[a].type != log[j].features[b].type) continue;
          if (!log[i].descriptors[a] || !log[j].descriptors[b]) continue;
          (distance_m < 0.15 ? same : different)
              .push_back(matcherOf(log[i].features[a].type)
                             .logLikelihoodRatio(*log[i].descriptors[a], *log[j].descriptors[b]));
        }
      }
    }
  }
  if (same.empty() || different.empty()) return;
  std::sort(different.begin(), different.end());
  const double threshold =
      different[static_cast<std::size_t>(0.99 * static_cast<double>(different.size()))];
  const auto matched =
      std::count_if(same.begin(), same.end(), [&](double ratio) { return ratio > threshold; });
  std::printf(
      "recognition: %zu true and %zu false pairs; %.3f of the true ones above the ratio %.2f of 1 "
      "%% false ones\n",
      same.size(), different.size(),
      static_cast<double>(matched) / static_cast<double>(same.size()), threshold);
}

}  // namespace

template <typename Read>
auto parametersFrom(const char* path, const Read& read) {
  ram_parameters::ParameterReader reader(
      path != nullptr ? ram_parameters::readYamlFile(path) : YAML::Node(),
      path ? path : "defaults");
  return read(reader);
}

int main(int argc, char** argv) {
  const std::string which = argc > 2 ? argv[2] : "corner";
  if (argc < 2 || (which != "corner" && which != "edge" && which != "both")) {
    std::cerr << "usage: recorded_scans LOG [corner|edge|both [FEATURES.csv [CORNER.yaml "
                 "[EDGE.yaml]]]]\n";
    return EXIT_FAILURE;
  }
  const FeatureDetector corners(
      parametersFrom(argc > 4 ? argv[4] : nullptr, readFeatureDetectorParameters));
  const EdgeDetector edges(
      parametersFrom(argc > 5 ? argv[5] : nullptr, readEdgeDetectorParameters));
  std::vector<Recorded> log = readLog(argv[1]);
  std::vector<double> times_us;
  std::size_t features = 0;
  std::ofstream csv;
  if (argc > 3) csv.open(argv[3]);
  for (std::size_t i = 0; i < log.size(); ++i) {
    const auto start = std::chrono::steady_clock::now();
    if (which != "edge") log[i].features = corners.detect(log[i].scan, {}).features;
    if (which != "corner") {
      for (auto& feature : edges.detect(log[i].scan, {}).features)
        log[i].features.push_back(feature);
    }
    times_us.push_back(
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
            .count());
    features += log[i].features.size();
    for (const auto& feature : log[i].features) {
      log[i].descriptors.push_back(matcherOf(feature.type).parse(feature.classifier));
      csv << i << ',' << feature.position_m.x() << ',' << feature.position_m.y() << ','
          << feature.classifier << '\n';
    }
  }
  std::sort(times_us.begin(), times_us.end());
  std::printf("%zu scans, %.2f features a scan; median %.0f us, p99 %.0f us a scan\n", log.size(),
              static_cast<double>(features) / static_cast<double>(log.size()),
              times_us[times_us.size() / 2], times_us[times_us.size() * 99 / 100]);
  const Repeatability r = repeatability(log);
  std::printf("repeatability %.3f (%d of %d visible), by chance %.3f\n",
              1.0 * r.repeated / r.visible, r.repeated, r.visible,
              1.0 * r.chance_repeated / r.chance_visible);
  recognition(log);
}
