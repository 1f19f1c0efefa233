// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "ramscout_sim/physics_parameters.hpp"
#include "ramscout_sim/pose2.hpp"
#include "ramscout_sim/robot_description.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// What the motors shall do.
struct WheelMotion {
  WheelValues speeds_radps = {};
  WheelValues steering_rad = {};  ///< about the vertical, counter-clockwise; 0 where none steers
};

/// The robot as a rigid body with spinning wheels on the floor, among the solids of a world (ODE).
///
/// Each wheel touches the floor in one point, friction acts along and across its rolling direction
/// (omni wheels: only along), and its limit follows the load of the step before (ODE by itself
/// takes the load without friction, so that weight transfer would not reach the traction limit).
/// Casters do not rub. The ground is the floor and those solids that can be
/// driven on. The chassis collides with the solids. Results depend on the inputs only;
/// there are no random numbers.
///
/// The spin of a wheel is no body of its own. A motor that has torque enough makes the floor's
/// point of contact pass at the wheel's speed; one at its limit gives a contact whose speed yields
/// to the force as the wheel's inertia does. Either is one row of ODE's equations, exact for the
/// step; which of the two holds is found by trying the one of the step before.
class Physics {
public:
  /// \throws std::invalid_argument if the robot starts inside a solid
  Physics(const RobotDescription& robot,
          const World& world,
          const Pose2& world_from_base,
          const PhysicsParameters& parameters = {});
  ~Physics();
  Physics(Physics&&) noexcept;
  Physics& operator=(Physics&&) noexcept;

  /// Advances by `duration_s`; the motors try to turn the wheels like that, within their torque;
  /// steering follows at once. \throws std::runtime_error if the result is absurd; the
  /// simulation must not continue then
  void step(double duration_s, const WheelMotion& motion);

  Eigen::Isometry3d worldFromBase() const;
  /// Of the base frame's origin, in world axes.
  Eigen::Vector3d linearVelocity_mps() const;
  Eigen::Vector3d angularVelocity_radps() const;

  /// Turned so far; not wrapped.
  WheelValues wheelAngles_rad() const;
  WheelValues wheelSpeeds_radps() const;
  /// Upward force of the floor on each wheel in the last step.
  WheelValues wheelLoads_n() const;

  /// Whether the chassis touched a solid in the last step.
  bool touchesSolid() const;

  /// Coulomb friction between wheels and floor from now on. \throws std::invalid_argument if it is
  /// negative or not finite
  void setFloorFriction(double friction);

  /// A force on the chassis, at its centre of mass, in world axes, from now on.
  void setPush(const Eigen::Vector3d& force_n);

  /// Something fixed to the chassis from now on, instead of what was before; mass 0: nothing. Its
  /// shape neither is seen nor touches anything. \throws std::invalid_argument if its mass is
  /// negative or not finite
  void setPayload(const MassProperties& payload);

  /// Solids besides the world's that the chassis collides with from now on (boxes, cylinders,
  /// spheres). They stand still as far as a contact is concerned, and do not push.
  void setObstacles(const std::vector<Solid>& solids);

  /// Puts the robot there, at rest; wheel angles stay.
  /// \throws std::invalid_argument if it is not finite or inside a solid; nothing changes then
  void setPose(const Pose2& world_from_base);

private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace ramscout_sim
