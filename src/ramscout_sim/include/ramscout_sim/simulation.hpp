// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "ramscout_sim/actors.hpp"
#include "ramscout_sim/drive.hpp"
#include "ramscout_sim/faults.hpp"
#include "ramscout_sim/lidar.hpp"
#include "ramscout_sim/physics.hpp"
#include "ramscout_sim/ray_caster.hpp"
#include "ramscout_sim/robot_description.hpp"
#include "ramscout_sim/simulation_parameters.hpp"
#include "ramscout_sim/tour.hpp"
#include "ramscout_sim/wheel_odometry.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// The robot as it really is.
struct GroundTruth {
  std::int64_t stamp_ns = 0;
  Eigen::Isometry3d world_from_base = Eigen::Isometry3d::Identity();
  Eigen::Vector3d linear_velocity_mps = Eigen::Vector3d::Zero();     ///< base axes
  Eigen::Vector3d angular_velocity_radps = Eigen::Vector3d::Zero();  ///< base axes
};

/// A fault that was due but impossible, such as a kidnapping into a wall; nothing has changed then.
struct RefusedFault {
  Fault fault;
  std::string reason;
};

/// What became due in one step.
struct Outputs {
  std::optional<OdometryReading> odometry;
  std::optional<GroundTruth> ground_truth;  ///< together with the odometry
  std::optional<Scan> scan;
  std::vector<Fault> started_faults;
  std::vector<RefusedFault> refused_faults;
};

/// Robot, lidar and world, advanced step by step. Same parameters, commands and seed: same outputs,
/// bit by bit.
class Simulation {
public:
  /// Stamp of the start: not 0, which ROS takes for "no time".
  static constexpr std::int64_t kStart_ns = 1'000'000'000;

  /// \param tour  drives the robot; without one it obeys command()
  /// \throws std::invalid_argument if a parameter is out of bounds or the robot starts inside a
  /// solid
  Simulation(const SimulationParameters& parameters,
             const RobotDescription& robot,
             const World& world,
             const std::optional<Tour>& tour);

  /// Clamped to the drive's limits; holds for DriveParameters::command_timeout_s. Ignored during a
  /// tour. \throws std::invalid_argument if it is not finite; the robot stops then
  void command(const Twist2& twist);

  /// Advances by one physics step. \throws std::runtime_error if the physics diverge
  Outputs step();

  /// Teleports the robot; odometry does not notice. \throws std::invalid_argument as
  /// Physics::setPose
  void setPose(const Pose2& world_from_base);

  /// Lets something go wrong, now (start_s in the past) or later.
  /// \throws std::invalid_argument from Fault::validate; or because it is due and impossible
  void inject(const Fault& fault);

  /// Other robots: shapes that this one sees and meets, and what people stop for.
  void setOthers(std::vector<Solid> shapes, std::vector<Footprint> footprints);

  std::int64_t now_ns() const { return now_ns_; }
  /// Shapes of the chassis, where they are now.
  std::vector<Solid> chassis() const;
  Footprint footprint() const;
  GroundTruth groundTruth() const;
  /// Share of the tour that is driven; 0 without a tour.
  double tourProgress() const { return driver_ ? driver_->progress() : 0.0; }
  bool inCollision() const { return physics_.touchesSolid(); }

private:
  Twist2 wantedTwist();
  double now_s() const { return static_cast<double>(now_ns_ - kStart_ns) * 1e-9; }
  void moveActors();
  void startFaults(Outputs& outputs);
  void begin(const Fault& fault);
  void beginLift(const Fault& fault);
  void endLift(Outputs& outputs);
  void addPerson(const Fault& fault);
  void applyForces();
  Eigen::Isometry3d worldFromLaser() const;
  void push(double left_m);
  MassProperties payload() const;
  const Fault* activeFault(FaultKind kind) const;
  WheelValues encoderAngles_rad();
  OdometryReading readOdometry();
  void maskSector(Scan& scan) const;
  void rememberPose();
  std::optional<Scan> scanIfDue();

  SimulationParameters parameters_;
  RobotDescription robot_;  // nominal
  RayCaster ray_caster_;
  Physics physics_;
  Actors actors_;
  std::vector<Footprint> others_;
  double radius_m_ = 0.0;  // of the chassis, about the base
  WheelOdometry odometry_;
  Drive drive_;
  WheelMotion wheel_motion_;
  Lidar lidar_;
  std::optional<TourDriver> driver_;
  std::int64_t now_ns_ = kStart_ns;
  std::int64_t steps_ = 0;
  std::uint64_t odometry_count_ = 0;
  std::uint64_t scan_count_ = 0;
  Twist2 commanded_;
  std::int64_t commanded_at_ns_ = 0;
  Twist2 driven_;  // what the tour's driver last wanted
  std::int64_t next_drive_ns_ = 0;
  std::vector<Fault> waiting_faults_;
  std::vector<Fault> started_faults_;
  std::vector<Fault> begun_at_once_;  // not reported yet
  std::optional<Fault> lift_;
  bool forced_ = false;  // friction or push are not the world's
  double floor_friction_ = 0.0;
  MassProperties payload_;
  WheelValues true_angles_rad_ = {};
  WheelValues encoder_error_rad_ = {};  // what faults have made the encoders count too much
  SensorPath recent_path_;              // back to the start of the scan that is under way
};

}  // namespace ramscout_sim
