// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/parameters.hpp"

#include <limits>
#include <stdexcept>
#include <string>

#include "ram_parameters/require.hpp"

namespace ram_slam {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using ram_parameters::require;
using ram_parameters::requirePositive;

void requireWithin(const char* name, double value, double lowest, double highest) {
  std::string bound = ">= " + std::to_string(lowest);
  if (highest < kInfinity)
    bound = "in [" + std::to_string(lowest) + ", " + std::to_string(highest) + "]";
  require(lowest <= value && value <= highest, name, value, bound);
}

FastSlamMode toMode(const std::string& name) {
  if (name == "fast_slam_1") return FastSlamMode::kFastSlam1;
  if (name == "fast_slam_2") return FastSlamMode::kFastSlam2;
  throw std::invalid_argument("mode must be fast_slam_1 or fast_slam_2, got '" + name + "'");
}

void readSeparation(ram_parameters::ParameterReader& reader, double& separation_m) {
  constexpr const char* kKey = "minimum_feature_separation";
  constexpr const char* kOldKey = "minimum_feature_seperation";
  double other_m = separation_m;
  reader.read(kKey, separation_m);
  reader.read(kOldKey, other_m);
  if (!reader.has(kOldKey)) return;
  if (reader.has(kKey) && other_m != separation_m) {
    throw std::invalid_argument(std::string(kKey) + " = " + std::to_string(separation_m) + " and " +
                                kOldKey + " = " + std::to_string(other_m) +
                                " contradict each other: keep the first");
  }
  separation_m = other_m;
}

}  // namespace

void FastSlamParameters::validate() const {
  requireWithin("particle_amount", particle_amount, 1, 100000);
  requirePositive("feature_match_distance", feature_match_distance);
  requireWithin("minimum_feature_separation", minimum_feature_separation, 0.0, kInfinity);
  if (mode == FastSlamMode::kFastSlam1) {
    requireWithin("minimum_feature_separation", minimum_feature_separation, feature_match_distance,
                  kInfinity);
  }
  requireWithin("future_interpol", future_interpol, 0.0, 10.0);
  requireWithin("seed", seed, 0, std::numeric_limits<int>::max());
  requirePositive("association_gate", association_gate);
  requireWithin("creation_gate", creation_gate, association_gate, kInfinity);
  requireWithin("duplicate_gate", duplicate_gate, 0.0, kInfinity);
  requireWithin("ambiguity_margin", ambiguity_margin, 0.0, kInfinity);
  requirePositive("unknown_feature_density", unknown_feature_density);
  requireWithin("feature_noise_floor", feature_noise_floor, 0.0, kInfinity);
  requireWithin("drift_inflation", drift_inflation, 1.0, kInfinity);
  requireWithin("pose_noise_floor", pose_noise_floor, 0.0, kInfinity);
  require(0.0 < evidence_exponent && evidence_exponent <= 1.0, "evidence_exponent",
          evidence_exponent, "in (0, 1]");
  requireWithin("resample_threshold", resample_threshold, 0.0, 1.0);
  require(0.0 < detection_probability && detection_probability < 1.0, "detection_probability",
          detection_probability, "in (0, 1)");
  require(0.0 < false_detection_probability && false_detection_probability < detection_probability,
          "false_detection_probability", false_detection_probability,
          "in (0, detection_probability)");
  requireWithin("maximum_log_odds", maximum_log_odds, confirm_log_odds, kInfinity);
  require(delete_log_odds < 0.0, "delete_log_odds", delete_log_odds, "< 0");
  require(delete_log_odds < confirm_log_odds, "confirm_log_odds", confirm_log_odds,
          "> delete_log_odds");
  requireWithin("update_distance", update_distance, 0.0, kInfinity);
  requireWithin("update_angle", update_angle, 0.0, kInfinity);
}

FastSlamParameters readFastSlamParameters(ram_parameters::ParameterReader& reader) {
  FastSlamParameters parameters;
  std::string mode = "fast_slam_2";
  reader.read("particle_amount", parameters.particle_amount);
  reader.read("feature_match_distance", parameters.feature_match_distance);
  readSeparation(reader, parameters.minimum_feature_separation);
  reader.read("future_interpol", parameters.future_interpol);
  reader.read("mode", mode);
  reader.read("seed", parameters.seed);
  reader.read("association_gate", parameters.association_gate);
  reader.read("creation_gate", parameters.creation_gate);
  reader.read("duplicate_gate", parameters.duplicate_gate);
  reader.read("ambiguity_margin", parameters.ambiguity_margin);
  reader.read("draw_jointly", parameters.draw_jointly);
  reader.read("unknown_feature_density", parameters.unknown_feature_density);
  reader.read("feature_noise_floor", parameters.feature_noise_floor);
  reader.read("evidence_exponent", parameters.evidence_exponent);
  reader.read("resample_threshold", parameters.resample_threshold);
  reader.read("drift_inflation", parameters.drift_inflation);
  reader.read("pose_noise_floor", parameters.pose_noise_floor);
  reader.read("detection_probability", parameters.detection_probability);
  reader.read("false_detection_probability", parameters.false_detection_probability);
  reader.read("confirm_log_odds", parameters.confirm_log_odds);
  reader.read("delete_log_odds", parameters.delete_log_odds);
  reader.read("maximum_log_odds", parameters.maximum_log_odds);
  reader.read("update_distance", parameters.update_distance);
  reader.read("update_angle", parameters.update_angle);
  reader.has("node");
  reader.has("relocalisation");
  reader.rejectUnknown();
  parameters.mode = toMode(mode);
  parameters.validate();
  return parameters;
}

}  // namespace ram_slam
