// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "ramscout_sim/physics_parameters.hpp"

#include "ode_objects.hpp"

namespace ramscout_sim {

/// What the chassis can run into: the solids of the world, and obstacles that come and go.
class Surroundings {
public:
  Surroundings(const World& world, const PhysicsParameters& parameters);

  /// From now on, instead of those before.
  void setObstacles(const std::vector<Solid>& solids);

  /// Whether the chassis touches anything.
  bool touch(const SpaceHandle& chassis) const;

  /// Contacts of the chassis; with the world's solids only where it can have reached them since it
  /// last looked around. \param reach_m of the chassis around `center_m`
  std::vector<dContact> contacts(const SpaceHandle& chassis,
                                 const Eigen::Vector3d& center_m,
                                 double reach_m);

  /// The robot is elsewhere: the next step searches for solids again.
  void forgetWhatIsNear();

  /// Adds where the chassis touches `other` to `contacts`.
  void collide(const SpaceHandle& chassis, dGeomID other, std::vector<dContact>& contacts);

private:
  void addStatic(const Solid& solid);
  bool mayTouchSolid(const Eigen::Vector3d& center_m, double reach_m);

  PhysicsParameters parameters_;
  std::vector<dContactGeom> touches_;  // of one pair, so that no step allocates
  std::vector<std::shared_ptr<const TriangleMesh>> meshes_;
  std::vector<MeshData> mesh_data_;
  SpaceHandle statics_;
  SpaceHandle obstacle_space_;
  std::vector<GeomHandle> obstacle_geoms_;
  std::vector<Solid> obstacles_;
  GeomHandle probe_;
  Eigen::Vector3d clear_around_m_ = Eigen::Vector3d::Zero();
  double clear_within_m_ = 0.0;
  int steps_near_solid_ = 0;
};

}  // namespace ramscout_sim
