// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/motion/motion_model.hpp"

namespace ram_slam {

/// Noise of motions over interruptions of the odometry.
struct GapBridgeParameters {
  double drift_mps = 0.3;        ///< of an unobserved robot: standard deviation per second
  double maximum_drift_m = 3.0;  ///< and at most
  double turn_radps = 0.3;
  double maximum_turn_rad = 1.0;
  double rest_sigma_m = 0.02;  ///< of a motion known from elsewhere: at rest
  double sigma_m_per_m = 0.05;
  double rest_sigma_rad = 0.01;
  double sigma_rad_per_rad = 0.05;
  double late_s = 1.0;

  static const ram_parameters::ParameterTable<GapBridgeParameters>& table();
};

/// A motion model that continues after an interruption: over an interval that the model behind it
/// cannot answer for, the robot is assumed to have moved as another source states, or to have stood
/// still with large noise, up to the interruption's end.
class GapBridge : public MotionModel {
public:
  /// \param model  outlives this
  explicit GapBridge(const MotionModel& model, const GapBridgeParameters& parameters = {})
      : model_(model), parameters_(parameters) {}

  /// From this stamp on the model may answer again.
  /// \param moved  from the start of the next interval asked about up to this stamp, if known; a
  /// source that knew it recently (late_s) is waited for
  void interruptedUntil(std::int64_t stamp_ns, const std::optional<Pose2>& moved = std::nullopt);
  void forget();

  PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const override;
  std::vector<Pose2> predictEach(const std::vector<Pose2>& map_from_base,
                                 std::int64_t from_ns,
                                 std::int64_t to_ns) const override;
  std::vector<Pose2> sample(const std::vector<Pose2>& map_from_base,
                            std::int64_t from_ns,
                            std::int64_t to_ns,
                            std::uint64_t seed) const override;

private:
  /// Up to the interruption's end.
  PoseWithCovariance2 bridge(std::int64_t from_ns) const;

  /// Standing still, with the uncertainty of not knowing so.
  PoseWithCovariance2 unobserved(double duration_s) const;
  /// A motion that another source states.
  PoseWithCovariance2 withNoise(const Pose2& moved) const;

  const MotionModel& model_;
  GapBridgeParameters parameters_;
  std::int64_t resume_ns_ = 0;  ///< 0: no interruption
  std::optional<Pose2> moved_;
};

}  // namespace ram_slam
